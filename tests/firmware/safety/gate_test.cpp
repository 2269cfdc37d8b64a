// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/gate.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "capstan/tests/firmware/loop/axis_bench.hpp"

namespace capstan {
namespace {

using namespace test;

TEST(Gate, WithoutPermissionThereIsNoTorqueWhateverIsAskedFor) {
  AxisBench axis(AxisConfig{});
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(axis.gated(0.0, 0.0, 1.0, false), 0.0);
  }
}

TEST(Gate, PermissionGoneTheTorqueIsGoneAtOnceAndComesBackFromZero) {
  AxisBench axis(AxisConfig{});
  for (int i = 0; i < 10; ++i) {
    static_cast<void>(axis.gated(0.0, 0.0, 2.0));
  }
  EXPECT_EQ(axis.gated(0.0, 0.0, 2.0, false), 0.0);
  EXPECT_NEAR(axis.gated(0.0, 0.0, 2.0), 0.5, 1e-5);
}

TEST(Gate, CurrentStopsAtItsPeakInBothDirectionsAndNamesTheLimit) {
  AxisBench axis(config_without_rate_limit());
  EXPECT_NEAR(axis.gated(0.0, 0.0, 2.9), 2.9, 1e-5);
  EXPECT_FALSE(has(axis.telemetry().limits, Limit::kCurrent));
  EXPECT_EQ(axis.gated(0.0, 0.0, 50.0), 3.0);
  EXPECT_TRUE(has(axis.telemetry().limits, Limit::kCurrent));
  EXPECT_EQ(axis.gated(0.0, 0.0, -1000.0), -3.0);
}

TEST(Gate, CurrentRisesNoFasterThanItsRateAndArrives) {
  AxisBench axis(AxisConfig{});
  EXPECT_NEAR(axis.gated(0.0, 0.0, 2.2), 0.5, 1e-5);
  double last = 0.5;
  int cycles = 1;
  for (; cycles < 20 && last < 2.2 - 1e-5; ++cycles) {
    const double drive = axis.gated(0.0, 0.0, 2.2);
    EXPECT_LE(drive - last, 0.5 + 1e-5);
    EXPECT_GT(drive, last);
    EXPECT_EQ(has(axis.telemetry().limits, Limit::kRate), drive < 2.2 - 1e-5);
    last = drive;
  }
  EXPECT_NEAR(last, 2.2, 1e-5);
  EXPECT_LT(cycles, 10);
  EXPECT_NEAR(axis.gated(0.0, 0.0, -2.2), 1.7, 1e-5);
}

// A limiter that heads for the wish itself lags by acos(pi / 8) = 67 deg here, and takes a servo's damping away.
TEST(Gate, ASwingThatIsTooFastForTheRateKeepsItsPhase) {
  AxisConfig config;
  config.limits.current_rate_a_per_cycle = q(0.1);
  AxisBench axis(config);
  constexpr double kHz = 70.0;
  const double turn = 2.0 * 3.14159265358979 * kHz * 1e-3;  // in a cycle
  const double amplitude = 4.0 * 0.1 / turn;                // four times what the rate follows
  double in_phase = 0.0;
  double late = 0.0;
  double last = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double drive = axis.gated(0.0, 0.0, amplitude * std::sin(turn * i));
    EXPECT_LE(std::fabs(drive - last), 0.1 + 1e-6) << i;
    last = drive;
    in_phase += drive * std::sin(turn * i);
    late -= drive * std::cos(turn * i);
  }
  EXPECT_GT(in_phase, 0.0);
  EXPECT_LT(std::atan2(late, in_phase), 40.0 / 57.3);
}

TEST(Gate, AtTheEndOfTheTendonsTravelThereIsOnlyTorqueInwards) {
  for (const double side : {1.0, -1.0}) {
    AxisBench axis(config_without_rate_limit());
    EXPECT_EQ(axis.gated(side * 6.001, 0.0, side * 2.0), 0.0);
    EXPECT_TRUE(has(axis.telemetry().limits, Limit::kMotorTravel));
    EXPECT_NEAR(axis.gated(side * 6.001, 0.0, side * -2.0), side * -2.0, 1e-5);
    EXPECT_FALSE(has(axis.telemetry().limits, Limit::kMotorTravel));
    EXPECT_NEAR(axis.gated(side * 5.99, 0.0, side * 2.0), side * 2.0, 1e-5);
  }
}

TEST(Gate, ASlowRateNeverDelaysTheEndOfTravel) {
  AxisConfig config;
  config.limits.current_rate_a_per_cycle = q(0.01);
  AxisBench axis(config);
  for (int i = 0; i < 230; ++i) {
    static_cast<void>(axis.gated(5.9, 0.0, 2.0));
  }
  EXPECT_NEAR(axis.telemetry().drive_a.to_double(), 2.0, 1e-4);
  EXPECT_EQ(axis.gated(6.01, 0.0, 2.0), 0.0) << "it still pulled outwards";
  EXPECT_LE(axis.gated(6.01, 0.0, -2.0), 0.0);
}

RC_GTEST_PROP(Gate, NeverPullsOutwardsBeyondTheTravel, ()) {
  AxisConfig config;
  config.limits.current_rate_a_per_cycle = Q24::from_raw(*rc::gen::inRange(2000, 1 << 26));
  AxisBench axis(config);
  for (int i = 0; i < 200; ++i) {
    const double q1 = 6.0 + (*rc::gen::inRange(-100, 101)) * 1e-3;
    const double current = axis.gated(q1, 0.0, (*rc::gen::inRange(-500, 501)) * 0.01);
    RC_ASSERT(axis.telemetry().q1_rad < config.limits.motor_max_rad || current <= 0.0);
    RC_ASSERT(std::fabs(current) <= 3.0);
  }
}

/// Cycles until the gate gives less than the peak, with a measured current; -1 if it does not within `most`.
auto cycles_to_heat(AxisBench& axis, double measured_a, int most) -> int {
  for (int i = 0; i < most; ++i) {
    static_cast<void>(axis.gated(0.0, measured_a, 3.0));
    if (has(axis.telemetry().limits, Limit::kThermal)) {
      return i;
    }
  }
  return -1;
}

TEST(GateThermal, TwiceTheContinuousCurrentIsAllowedForAsLongAsTheWindingStandsIt) {
  AxisBench axis(config_without_rate_limit());
  // heat = 4 (1 - exp(-t / 10 s)) reaches 1 after 10 s ln(4/3).
  EXPECT_NEAR(cycles_to_heat(axis, 3.0, 10'000), 10'000.0 * std::log(4.0 / 3.0), 10.0);
  EXPECT_EQ(axis.telemetry().drive_a, q(1.5));
}

/// A motor that stands while its reference goes away by 0.9 rad, after 3 A for some time.
auto faults_of_a_held_motor(double heat_s) -> FaultSet {
  AxisConfig config = config_without_rate_limit();
  config.limits.following_error_rad = q(1.0);
  AxisBench axis(config);
  arm_at_rest(axis);
  for (int i = 0; i < 1000.0 * heat_s; ++i) {
    static_cast<void>(axis.gated(0.0, 3.0, 3.0));
  }
  FaultSet faults = 0;
  for (int i = 0; i <= 900; ++i) {
    axis.estimate(sensed_at(0.0, axis.telemetry().drive_a.to_double()));
    static_cast<void>(axis.command({.kind = Request::Kind::kFollow, .position_rad = q(0.001 * i)}));
    static_cast<void>(axis.drive(axis.control(), true));
    faults |= axis.faults(true);
  }
  return faults;
}

TEST(GateThermal, WhatTheWindingsHeatHoldsBackNeedsNoCount) {
  EXPECT_EQ(faults_of_a_held_motor(3.2), FaultSet{0});
  EXPECT_EQ(faults_of_a_held_motor(0.0), bit(Fault::kEncoderFrozen)) << "a cold one has all its torque";
}

TEST(GateThermal, TheContinuousCurrentIsAllowedForEver) {
  AxisBench axis(config_without_rate_limit());
  EXPECT_EQ(cycles_to_heat(axis, 1.49, 200'000), -1);
}

TEST(GateThermal, TheReductionIsNotDelayedByTheRateLimit) {
  AxisConfig config;
  config.limits.current_rate_a_per_cycle = q(0.001);
  AxisBench axis(config);
  for (int i = 0; i < 2860; ++i) {
    static_cast<void>(axis.gated(0.0, 3.0, 3.0));
  }
  ASSERT_GT(axis.telemetry().drive_a, q(2.8));
  ASSERT_GE(cycles_to_heat(axis, 3.0, 100), 0);
  EXPECT_EQ(axis.telemetry().drive_a, q(1.5));
}

TEST(GateThermal, AHotWindingStaysLimitedAtItsContinuousCurrentWithoutChatter) {
  AxisBench axis(config_without_rate_limit());
  ASSERT_GE(cycles_to_heat(axis, 3.0, 10'000), 0);
  for (int i = 0; i < 60'000; ++i) {
    const double noise = i % 2 == 0 ? 0.02 : -0.03;
    ASSERT_EQ(axis.gated(0.0, 1.5 + noise, 3.0), 1.5) << "cycle " << i;
  }
}

TEST(GateThermal, AWindingThatBeginsHotGetsItsPeakCurrentOnceItHasCooled) {
  AxisBench axis(config_without_rate_limit());
  axis.axis().begin_at_heat(q(1.0));
  EXPECT_NEAR(axis.gated(0.0, 0.0, 3.0), 1.5, 1e-5);
  for (int i = 0; i < 2'000; ++i) {
    static_cast<void>(axis.gated(0.0, 0.0, 0.0));
  }
  EXPECT_NEAR(axis.gated(0.0, 0.0, 3.0), 3.0, 1e-5);
}

TEST(GateThermal, APauseBringsThePeakCurrentBackAndDisarmingDoesNotForgetTheHeat) {
  AxisBench axis(config_without_rate_limit());
  ASSERT_GE(cycles_to_heat(axis, 3.0, 10'000), 0);
  for (int i = 0; i < 900; ++i) {
    static_cast<void>(axis.gated(0.0, 0.0, 0.0, false));
  }
  EXPECT_EQ(axis.gated(0.0, 0.0, 3.0), 1.5) << "still hot after 0.9 s";
  // From 1 to 0.9 in 10 s ln(1/0.9) = 1.05 s.
  for (int i = 0; i < 200; ++i) {
    static_cast<void>(axis.gated(0.0, 0.0, 0.0, false));
  }
  EXPECT_NEAR(axis.gated(0.0, 0.0, 2.9), 2.9, 1e-5);
}

}  // namespace
}  // namespace capstan
