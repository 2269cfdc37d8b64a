// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/loop/axis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/tests/firmware/loop/axis_bench.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using namespace test;

TEST(AxisConfiguration, ANewEncoderScaleOrSignStartsTheLawAfresh) {
  AxisConfig config = test::lossy_config();
  AxisBench axis(config);
  for (int i = 0; i < 100; ++i) {
    axis.estimate(sensed_at(2.0 + 0.0001 * i, 0.0));
  }
  config.motor.encoder_sign = -1;
  axis.axis().rt_configure(config);
  axis.estimate(sensed_at(2.01, 0.0));
  EXPECT_EQ(axis.faults(false), 0U) << "the jump from +2 to -2 rad is no motion";
  // A fresh law at rest: beta q1 + offset, since play starts where the motor is.
  EXPECT_NEAR(axis.telemetry().q2_rad.to_double(), -1.08 * 2.01 + 0.05, 1e-3);
}

TEST(AxisConfiguration, NewGainsLeaveTheLawsMemoryAlone) {
  AxisConfig config = test::lossy_config();
  AxisBench changed(config);
  AxisBench untouched(config);
  for (int i = 0; i < 400; ++i) {
    if (i == 200) {
      config.control.kp = q(3.0);
      config.limits.following_error_rad = q(1.0);
      changed.axis().rt_configure(config);
    }
    const AxisSensed sensed = sensed_at(0.5 * std::sin(0.02 * i), 0.3);
    changed.estimate(sensed);
    untouched.estimate(sensed);
    ASSERT_EQ(changed.telemetry().q2_rad, untouched.telemetry().q2_rad) << "cycle " << i;
  }
}

TEST(AxisArming, AnAmplifierOnItsWayToTorqueGetsNoneAndIsNotJudged) {
  AxisConfig config;
  config.observer = {.inertia_gm2 = q(0.01), .coulomb_nm = q(0.004), .noise_a = q(0.004)};
  AxisBench axis(config);
  arm_at_rest(axis);
  AxisSensed sensed;
  for (int i = 0; i < 200; ++i) {
    sensed = sensed_at(0.0015 * std::min(i, 100), 0.0);  // it is pushed meanwhile
    sensed.follows = false;
    axis.estimate(sensed);
    ASSERT_EQ(axis.faults(true), 0U) << "cycle " << i;
    static_cast<void>(axis.control());
    const AxisDrive drive = axis.drive(q(0.05), true);
    EXPECT_TRUE(drive.enabled) << "or it would never come to torque";
    EXPECT_EQ(drive.current_a, Q24{});
  }
  sensed.follows = true;
  axis.estimate(sensed);
  EXPECT_EQ(axis.faults(true), 0U);
  EXPECT_NEAR(axis.control().to_double(), 0.0, 1e-6) << "it stands where it is now, not where it was armed";
  EXPECT_NE(axis.drive(Q24{}, true).current_a, Q24{}) << "the observer's first look begins with the torque";
}

TEST(AxisCommands, AMoveOutsideTheLimitsOrWithoutSpeedChangesNothing) {
  AxisBench axis(AxisConfig{});
  arm_at_rest(axis);
  const auto move = [&axis](Q24 to, Q24 speed) {
    return axis.command({.kind = Request::Kind::kMove, .position_rad = to, .speed_rad_s = speed});
  };
  EXPECT_FALSE(move(q(2.0001), q(1.0)));
  EXPECT_FALSE(move(q(-2.0001), q(1.0)));
  EXPECT_FALSE(move(Q24::max(), q(1.0)));
  EXPECT_FALSE(move(q(1.0), Q24{}));
  EXPECT_FALSE(move(q(1.0), q(-1.0)));
  EXPECT_FALSE(axis.in_motion());
  EXPECT_TRUE(move(q(2.0), q(1.0)));
  EXPECT_TRUE(axis.in_motion());
}

TEST(AxisCommands, WhatIsAskedOfTheMachineIsNothingToAJoint) {
  AxisBench axis(AxisConfig{});
  arm_at_rest(axis);
  ASSERT_TRUE(axis.command({.kind = Request::Kind::kMove, .position_rad = q(1.0), .speed_rad_s = q(1.0)}));
  for (const Request::Kind kind : {Request::Kind::kArm, Request::Kind::kDisarm}) {
    EXPECT_FALSE(axis.command({.kind = kind}));
    EXPECT_TRUE(axis.in_motion());
  }
}

TEST(AxisCommands, AMoveIsNoFasterThanTheJointsLimitWhateverIsAskedFor) {
  AxisBench axis(AxisConfig{});
  arm_at_rest(axis);
  ASSERT_TRUE(axis.command({.kind = Request::Kind::kMove, .position_rad = q(2.0), .speed_rad_s = q(100.0)}));
  Q24 last;
  for (int i = 0; i < 2000; ++i) {
    axis.estimate(sensed_at(0.0, 0.0));
    static_cast<void>(axis.control());
    ASSERT_LE(axis.telemetry().q2_reference_rad - last, q(0.002) + Q24::from_raw(1));
    last = axis.telemetry().q2_reference_rad;
  }
  EXPECT_EQ(last, q(2.0));
}

TEST(AxisCommands, AWildStreamIsFollowedNoFasterAndNoFurtherThanTheLimits) {
  for (const double wild : {100.0, -127.0}) {
    AxisBench axis(AxisConfig{});
    arm_at_rest(axis);
    Q24 last;
    for (int i = 0; i < 1500; ++i) {
      axis.estimate(sensed_at(0.0, 0.0));
      EXPECT_FALSE(axis.command({.kind = Request::Kind::kFollow, .position_rad = q(wild)}));
      static_cast<void>(axis.control());
      const Q24 now = axis.telemetry().q2_reference_rad;
      ASSERT_LE(abs(now - last), q(0.002) + Q24::from_raw(1));
      ASSERT_TRUE(has(axis.telemetry().limits, Limit::kReference));
      last = now;
    }
    EXPECT_EQ(last, wild > 0.0 ? q(2.0) : q(-2.0));
  }
}

/// After i cycles of a stream that gets to `speed` at 10 rad/s2.
auto ramped(double speed, int i) -> double {
  const double time = 0.001 * i;
  const double rise = std::fabs(speed) / 10.0;
  return speed * (time < rise ? time * time / (2.0 * rise) : time - rise / 2.0);
}

TEST(AxisCommands, AMoveTakesOverFromAStreamWhereItWas) {
  AxisBench axis(AxisConfig{});
  arm_at_rest(axis);
  for (int i = 0; i < 200; ++i) {
    axis.estimate(sensed_at(0.0, 0.0));
    static_cast<void>(axis.command({.kind = Request::Kind::kFollow, .position_rad = q(ramped(1.0, i))}));
    static_cast<void>(axis.control());
  }
  const Q24 before = axis.telemetry().q2_reference_rad;
  axis.estimate(sensed_at(0.0, 0.0));
  ASSERT_TRUE(axis.command({.kind = Request::Kind::kMove, .position_rad = q(-1.0), .speed_rad_s = q(1.0)}));
  static_cast<void>(axis.control());
  // The stream ran at 1 rad/s, and a cycle at 10 rad/s2 takes 0.01 rad/s of it.
  EXPECT_NEAR((axis.telemetry().q2_reference_rad - before).to_double(), 0.00099, 1e-6);
}

TEST(AxisCommands, AHoldDuringAStreamBrakesWithTheJointsAccelerationAndNotAtOnce) {
  for (const double speed : {1.0, -1.5, 0.3}) {
    AxisBench axis(AxisConfig{});
    arm_at_rest(axis);
    Q24 last;
    for (int i = 1; i <= 500; ++i) {
      axis.estimate(sensed_at(0.0, 0.0));
      static_cast<void>(axis.command({.kind = Request::Kind::kFollow, .position_rad = q(ramped(speed, i))}));
      static_cast<void>(axis.control());
      last = axis.telemetry().q2_reference_rad;
    }
    const double began = last.to_double();
    axis.estimate(sensed_at(0.0, 0.0));
    ASSERT_TRUE(axis.command({.kind = Request::Kind::kStop}));
    double before = 0.001 * speed;
    int cycles = 0;
    for (; axis.in_motion() && cycles < 1000; ++cycles) {
      static_cast<void>(axis.control());
      const double step = (axis.telemetry().q2_reference_rad - last).to_double();
      ASSERT_NEAR(step, before, 1e-5 + 2e-7) << "10 rad/s2 is 1e-5 rad per cycle and cycle, at " << cycles;
      before = step;
      last = axis.telemetry().q2_reference_rad;
    }
    // v / a, and v^2 / 2a, by mechanics.
    EXPECT_NEAR(cycles, 1000.0 * std::fabs(speed) / 10.0, 2.0);
    EXPECT_NEAR(last.to_double() - began, speed * std::fabs(speed) / 20.0, 2e-3 * std::fabs(speed));
  }
}

TEST(AxisSupply, ADipIsNoFaultAndAFlickerStaysOneUntilTheSupplyIsGoodForAsLong) {
  AxisConfig config;
  config.limits.supply_min_v = q(18.0);
  AxisBench axis(config);
  const auto low_after = [&axis](double volts, int cycles) {
    FaultSet faults = 0;
    for (int i = 0; i < cycles; ++i) {
      AxisSensed sensed = sensed_at(0.0, 0.0);
      sensed.supply = Quality::kOk;
      sensed.supply_v = q(volts);
      axis.estimate(sensed);
      faults = axis.faults(false);
    }
    return (faults & bit(Fault::kSupplyLow)) != 0;
  };
  EXPECT_FALSE(low_after(24.0, 100));
  EXPECT_FALSE(low_after(17.9, 9)) << "a dip";
  EXPECT_FALSE(low_after(18.0, 20));
  EXPECT_TRUE(low_after(17.9, 10));
  EXPECT_TRUE(low_after(24.0, 9));
  EXPECT_TRUE(low_after(0.0, 1));
  EXPECT_FALSE(low_after(24.0, 11));
}

TEST(AxisNotFitted, NothingOfItIsAFaultMovesOrHasTorqueAndFittedAgainItIsAnother) {
  AxisConfig config;
  config.motor.fitted = 0;
  AxisBench axis(config);
  for (const Quality quality : {Quality::kMissing, Quality::kInvalid, Quality::kOk}) {
    for (int i = 0; i < 200; ++i) {
      axis.estimate({.encoder_counts = i * 100'000, .current_a = q(90.0), .encoder = quality, .current = quality});
      ASSERT_EQ(axis.faults(true), 0U);
      ASSERT_FALSE(axis.command({.kind = Request::Kind::kFollow, .position_rad = q(0.5)}));
      const AxisDrive drive = axis.drive(axis.control(), true);
      ASSERT_FALSE(drive.enabled);
      ASSERT_EQ(drive.current_a, Q24{});
    }
    EXPECT_FALSE(axis.in_motion());
    EXPECT_FALSE(axis.telemetry().estimate_valid);
  }
  axis.axis().rt_configure(AxisConfig{});
  axis.estimate(sensed_at(0.3, 0.0));
  EXPECT_EQ(axis.faults(false), 0U);  // where the counter went before was nobody's jump
  EXPECT_TRUE(axis.telemetry().estimate_valid);
  EXPECT_NEAR(axis.telemetry().q2_rad.to_double(), 0.3, 1e-3);
}

}  // namespace
}  // namespace capstan
