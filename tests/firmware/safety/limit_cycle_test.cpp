// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/limit_cycle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace capstan {
namespace {

constexpr double kPi = std::numbers::pi;

/// A motor that swings about a way, with a torque that leads its motion by an angle: 90 deg feed it most, -90 damp it.
struct Swing {
  double hz = 60.0;
  double amplitude_rad = 0.002;
  double lead_deg = 45.0;
  double way_rad_s = 0.5;
  double asked_hz = 0.0;  ///< the wanted angle swings too
  bool shaken = false;
  double inertia_gm2 = 0.0;  ///< as commissioned
};

struct Seen {
  int warned_ms = -1, faulted_ms = -1;
};

auto watch(const Swing& swing, int duration_ms = 10000) -> Seen {
  AxisConfig config;
  config.observer.inertia_gm2 = Q24::from_double(swing.inertia_gm2);
  LimitCycleWatch watch(config);
  MotorState motor;
  JointReference reference;
  Seen seen;
  for (int t = 0; t < duration_ms; ++t) {
    const double phase = 2.0 * kPi * swing.hz * 1e-3 * t;
    const double way = swing.way_rad_s * 1e-3 * t;
    const double asked = swing.asked_hz > 0.0 ? 0.01 * std::sin(2.0 * kPi * swing.asked_hz * 1e-3 * t) : 0.0;
    motor.q1_rad = Q24::from_double(way + swing.amplitude_rad * std::sin(phase));
    motor.tau_nm = Q24::from_double(0.02 + 0.01 * std::sin(phase + swing.lead_deg * kPi / 180.0));
    reference.q1_rad = Q24::from_double(way);
    reference.q2_rad = Q24::from_double(way + asked);
    const FaultSet faults = watch.rt_step(motor, reference, swing.shaken);
    if (watch.warnings() == bit(Warning::kLimitCycle) && seen.warned_ms < 0) {
      seen.warned_ms = t;
    }
    if (faults != 0 && seen.faulted_ms < 0) {
      EXPECT_EQ(faults, bit(Fault::kLimitCycle));
      seen.faulted_ms = t;
    }
  }
  return seen;
}

TEST(LimitCycleWatch, ASwingThatTheMotorFeedsIsWarnedOfWithinASecondAndStoppedWithinFive) {
  for (const double hz : {60.0, 97.0, 140.0}) {
    for (const double way : {0.0, 0.5, -2.0}) {
      const Seen seen = watch({.hz = hz, .way_rad_s = way, .inertia_gm2 = 0.02});
      EXPECT_GT(seen.warned_ms, 0) << hz << ' ' << way;
      EXPECT_LE(seen.warned_ms, 1100) << hz << ' ' << way;
      EXPECT_GT(seen.faulted_ms, 3500) << hz << ' ' << way;
      EXPECT_LE(seen.faulted_ms, 5000) << hz << ' ' << way;
    }
  }
}

TEST(LimitCycleWatch, AJointWhoseInertiaNobodyKnowsIsWarnedOfOnly) {
  const Seen seen = watch({.hz = 97.0});
  EXPECT_GT(seen.warned_ms, 0);
  EXPECT_EQ(seen.faulted_ms, -1);
  EXPECT_EQ(watch({.hz = 40.0}).warned_ms, -1);
}

TEST(LimitCycleWatch, ASwingThatComesFromOutsideIsDampedAndNoneOfItsBusiness) {
  for (const double hz : {8.0, 60.0, 97.0}) {
    EXPECT_EQ(watch({.hz = hz, .lead_deg = -45.0}).warned_ms, -1) << hz;
    EXPECT_EQ(watch({.hz = hz, .lead_deg = -135.0}).warned_ms, -1) << hz;
  }
}

TEST(LimitCycleWatch, SlowMotionsAndThoseThatAreAskedForAreNoSwing) {
  EXPECT_EQ(watch({.hz = 5.0, .amplitude_rad = 0.1}).warned_ms, -1);
  EXPECT_EQ(watch({.asked_hz = 10.0}).warned_ms, -1);
  EXPECT_EQ(watch({.shaken = true}).warned_ms, -1);
  EXPECT_GT(watch({.asked_hz = 1.0}).warned_ms, 0) << "a joint that is moved may swing";
}

TEST(LimitCycleWatch, HowFastASwingIsFollowsFromTheJointsOwnInertiaAndStiffness) {
  // Stiffness 1 N m/rad: 2e-4 kg m2 swing on it at 11.3 Hz, 2e-5 at 35.6.
  EXPECT_GT(watch({.hz = 20.0, .inertia_gm2 = 0.2}).warned_ms, 0);
  EXPECT_EQ(watch({.hz = 20.0, .inertia_gm2 = 0.02}).warned_ms, -1);
  EXPECT_EQ(watch({.hz = 40.0, .inertia_gm2 = 0.02}).warned_ms, -1);
  EXPECT_GT(watch({.hz = 55.0, .inertia_gm2 = 0.02}).warned_ms, 0);
  EXPECT_EQ(watch({.hz = 12.0, .inertia_gm2 = 2.0}).warned_ms, -1) << "a hand may tremble as fast";
}

TEST(LimitCycleWatch, WhatTheEncoderCanNotTellIsNoSwing) {
  const double count = 2.0 * kPi / MotorConfig{}.encoder_counts_per_turn;
  EXPECT_EQ(watch({.amplitude_rad = 1.9 * count}).warned_ms, -1);
  EXPECT_GT(watch({.amplitude_rad = 2.5 * count}).warned_ms, 0);
}

TEST(LimitCycleWatch, AShortSwingIsForgottenAndTheWarningStaysUntilTorqueGoes) {
  AxisConfig config;
  config.observer.inertia_gm2 = Q24::from_double(0.02);
  LimitCycleWatch watch(config);
  MotorState motor;
  const JointReference reference;
  FaultSet faults = 0;
  const auto run = [&](int from, int cycles, bool swings) {
    for (int t = from; t < from + cycles; ++t) {
      const double phase = 2.0 * kPi * 0.06 * t;
      motor.q1_rad = Q24::from_double(swings ? 0.002 * std::sin(phase) : 0.0);
      motor.tau_nm = Q24::from_double(swings ? 0.01 * std::cos(phase) : 0.0);
      faults |= watch.rt_step(motor, reference, false);
    }
  };
  for (int i = 0; i < 10; ++i) {  // 3 s of every 4
    run(4096 * i, 3072, true);
    run(4096 * i + 3072, 1024, false);
  }
  EXPECT_EQ(faults, FaultSet{0});
  EXPECT_EQ(watch.warnings(), bit(Warning::kLimitCycle));
  watch.rt_rest();
  EXPECT_EQ(watch.warnings(), WarningSet{0});
}

}  // namespace
}  // namespace capstan
