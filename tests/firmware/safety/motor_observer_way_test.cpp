// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/tests/firmware/safety/motor_observer_rig.hpp"

namespace capstan {
namespace {

using observer_rig::commissioned_config;
using observer_rig::Rig;

/// As commissioned_config(), on tendons of 1.3 Nm/rad: 2 mA a count. A healthy motor went 0.3 A beyond.
auto stretching_config() -> AxisConfig {
  AxisConfig config = commissioned_config();
  config.observer.stiffness_nm_per_rad = Q24::from_double(1.3);
  config.observer.excess_nm = Q24::from_double(0.03);
  return config;
}
/// From 0.9 A to -0.9 A by 10 mA a cycle, with `moved` counts a cycle once the motor is on its way back; the first
/// fault.
auto turned_round(double moved, const AxisConfig& config = stretching_config()) -> FaultSet {
  Rig rig(config);
  for (int i = 0; i <= 90; ++i) {
    EXPECT_EQ(rig.step(std::min(1 + i / 11, 5), 0.01 * i), 0U) << i;
  }
  EXPECT_EQ(rig.slow_down(5, 1, 0.9) | rig.steps(100, 1, 0.9), 0U);
  FaultSet faults = 0;
  double shown = 0.0;
  for (int i = 0; i < 180 && faults == 0; ++i) {
    const double before = shown;
    shown += moved * std::min(1.0, i / 20.0);
    faults = rig.step(static_cast<int>(std::floor(shown) - std::floor(before)), 0.9 - 0.01 * i);
  }
  return faults;
}

TEST(MotorObserver, AMotorThatTurnsRoundStretchesItsTendonsByCountsThatAnswerForItsTorque) {
  EXPECT_EQ(turned_round(-5.0), 0U);
  EXPECT_EQ(turned_round(-4.5), 0U) << "a tenth less is no fault";
  EXPECT_EQ(turned_round(-2.5), bit(Fault::kEncoderMotion)) << "half of them";
  EXPECT_EQ(turned_round(1.0), bit(Fault::kEncoderMotion)) << "an encoder that goes on by itself";
}

// A contact that pushes the joint the way it goes: the tendons relax, and the motor goes on.
TEST(MotorObserver, AMotorThatItsLoadHasHelpedOnTurnsRoundFromTheTorqueThatWasLeft) {
  for (const bool helped : {true, false}) {
    Rig rig(stretching_config());
    for (int i = 0; i <= 90; ++i) {
      static_cast<void>(rig.step(std::min(1 + i / 11, 5), 0.01 * i));
    }
    ASSERT_EQ(rig.steps(100, 2, 0.9), 0U);
    FaultSet faults = 0;
    for (int i = 1; i <= 300; ++i) {
      const int way = helped ? 2 : i % 4 == 0 ? 1 : 0;
      faults |= rig.step(way, 0.9 - 0.001 * i);
    }
    ASSERT_EQ(faults, 0U);
    for (int i = 1; i <= 25; ++i) {
      faults |= rig.step(i % 4 == 0 ? -1 : 0, 0.6 - 0.01 * i);
    }
    EXPECT_EQ(faults, helped ? 0U : bit(Fault::kEncoderMotion));
  }
}

TEST(MotorObserver, WhatAMotorPressedWithCountsUntilItHasTurnedRound) {
  Rig rig(stretching_config());
  for (int i = 0; i <= 400; ++i) {
    ASSERT_EQ(rig.step(std::min(1 + i / 11, 4), 0.005 * i), 0U) << i;
  }
  ASSERT_EQ(rig.slow_down(4, 1, 2.0) | rig.steps(100, 1, 2.0), 0U);
  // A count a cycle answers for a fifth of 10 mA, and then five for all of it: 0.64 A stay, a third of what it pressed
  // with.
  FaultSet faults = 0;
  for (int i = 1; i <= 200; ++i) {
    faults |= rig.step(i <= 80 ? -1 : -5, 2.0 - 0.01 * i);
  }
  EXPECT_EQ(faults, 0U);
}

// Friction along a tendon is a share of its tension: exp(-2 eta) of what it pressed with is left where it has turned
// round, 0.39 A of 1 A with eta = 0.25, and the motor's own friction is passed twice beside.
TEST(MotorObserver, HalfOfWhatAMotorPressedWithMayGoBeforeItTurns) {
  for (const double left_a : {0.9, 1.2}) {
    Rig rig(stretching_config());
    for (int i = 0; i <= 400; ++i) {
      ASSERT_EQ(rig.step(std::min(1 + i / 11, 4), 0.005 * i), 0U) << i;
    }
    ASSERT_EQ(rig.slow_down(4, 1, 2.0) | rig.steps(100, 1, 2.0), 0U);
    FaultSet faults = 0;
    for (int i = 1; i <= static_cast<int>(100.0 * left_a); ++i) {
      faults |= rig.step(i % 10 == 0 ? -1 : 0, 2.0 - 0.01 * i);
    }
    EXPECT_EQ(faults & bit(Fault::kEncoderMotion), left_a < 1.0 ? 0U : bit(Fault::kEncoderMotion)) << left_a;
  }
}

// The current limit falls in one cycle where the winding is hot.
/// Pressed with `load_a`, shows one last count in the direction in which its torque then goes by `by_a` in 150 cycles.
auto without_a_count(double load_a, double by_a) -> FaultSet {
  Rig rig;
  FaultSet faults = 0;
  for (int i = 0; i <= 90; ++i) {
    EXPECT_EQ(rig.step(load_a > 0.0 ? 1 : -1, load_a * i / 90.0), 0U) << i;
  }
  EXPECT_EQ(rig.step(0, load_a), 0U);
  EXPECT_EQ(rig.step(by_a > 0.0 ? 1 : -1, load_a), 0U);
  for (int i = 0; i <= 150; ++i) {
    static_cast<void>(rig.observer.rt_look());  // its torque is left out, its cycles pass
    faults |= rig.step(0, load_a + (by_a * i / 150.0));
  }
  return faults;
}

TEST(MotorObserver, AnEighthOfALoadMayGoWithoutACountAndMayNotCome) {
  EXPECT_EQ(without_a_count(0.9, -0.1), 0U);
  EXPECT_EQ(without_a_count(-0.9, 0.1), 0U);
  EXPECT_EQ(without_a_count(0.9, 0.1), bit(Fault::kEncoderFrozen));
  EXPECT_EQ(without_a_count(-0.9, -0.1), bit(Fault::kEncoderFrozen));
  EXPECT_EQ(without_a_count(0.2, -0.1), bit(Fault::kEncoderFrozen)) << "half of it may not";
  EXPECT_EQ(without_a_count(0.9, -0.2), bit(Fault::kEncoderFrozen)) << "more than friction and an eighth";
}

TEST(MotorObserver, AStepOfTorqueMayBeAnsweredAtTheRateOfTorque) {
  for (const bool answered : {true, false}) {
    Rig rig(stretching_config());
    for (int i = 0; i <= 200; ++i) {
      ASSERT_EQ(rig.step(std::min(1 + i / 11, 4), 0.005 * i), 0U) << i;
    }
    ASSERT_EQ(rig.slow_down(4, 1, 1.0) | rig.steps(100, 1, 1.0), 0U);
    const FaultSet faults = rig.steps(20, answered ? -20 : -1, 0.3);
    EXPECT_EQ(faults, answered ? 0U : bit(Fault::kEncoderMotion));
  }
}

TEST(MotorObserver, WithoutItsStiffnessOrWhatAHealthyMotorExceedsTheWayIsNotJudged) {
  EXPECT_EQ(turned_round(-2.5, commissioned_config()), 0U);
  AxisConfig no_excess = stretching_config();
  no_excess.observer.excess_nm = Q24{};
  EXPECT_EQ(turned_round(-2.5, no_excess), 0U);
}

TEST(MotorObserver, WhatTheWayDidNotAnswerForIsNotJudgedDuringALook) {
  Rig rig(stretching_config());
  const auto excursion = [&rig] {
    FaultSet faults = 0;
    for (int i = 1; i <= 12; ++i) {
      faults |= rig.step(-1, -0.05 * i);
    }
    return faults;
  };
  static_cast<void>(rig.step(-1, 0.0));
  rig.observer.rt_arm();
  for (int i = 0; i < 12; ++i) {
    static_cast<void>(rig.observer.rt_look());
  }
  EXPECT_EQ(excursion(), 0U);
  EXPECT_EQ(rig.steps(40, 0, 0.0) & bit(Fault::kEncoderMotion), 0U);
  EXPECT_EQ(excursion(), bit(Fault::kEncoderMotion));
}

}  // namespace
}  // namespace capstan
