// SPDX-License-Identifier: Apache-2.0
#include "firmware/axis.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "tests/firmware/support.hpp"

namespace capstan {
namespace {

constexpr double kCountsPerRad = 40960.0 / 6.283185307179586;

auto q(double value) -> Q24 {
  return Q24::from_double(value);
}
auto has(std::uint8_t limits, Limit limit) -> bool {
  return (limits & static_cast<std::uint8_t>(limit)) != 0;
}

auto sensed_at(double q1_rad, double current_a) -> AxisSensed {
  return {.encoder_counts = static_cast<std::int32_t>(std::lround(q1_rad * kCountsPerRad)),
          .current_a = q(current_a),
          .encoder = Quality::kOk,
          .current = Quality::kOk};
}

void estimate(Axis& axis, const AxisSensed& sensed) {
  axis.rt_sense(sensed);
  axis.rt_estimate(nullptr);
}

/// One cycle at an angle with a measured current, in which a torque is asked for. The default torque constant is 0.1
/// Nm/A.
auto gated(Axis& axis, double q1_rad, double current_a, double wanted_a, bool energised = true) -> double {
  estimate(axis, sensed_at(q1_rad, current_a));
  const AxisDrive drive = axis.rt_limit(q(0.1 * wanted_a), energised);
  EXPECT_EQ(drive.enabled, energised);
  EXPECT_EQ(drive.current_a, axis.telemetry().drive_a);
  return drive.current_a.to_double();
}

auto config_without_rate_limit() -> AxisConfig {
  AxisConfig config;
  config.limits.current_rate_a_per_cycle = Q24::from_int(100);
  return config;
}

TEST(AxisGate, WithoutPermissionThereIsNoTorqueWhateverIsAskedFor) {
  Axis axis(AxisConfig{});
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(gated(axis, 0.0, 0.0, 1.0, false), 0.0);
  }
}

TEST(AxisGate, PermissionGoneTheTorqueIsGoneAtOnceAndComesBackFromZero) {
  Axis axis(AxisConfig{});
  for (int i = 0; i < 10; ++i) {
    static_cast<void>(gated(axis, 0.0, 0.0, 2.0));
  }
  EXPECT_EQ(gated(axis, 0.0, 0.0, 2.0, false), 0.0);
  EXPECT_NEAR(gated(axis, 0.0, 0.0, 2.0), 0.5, 1e-5);
}

TEST(AxisGate, CurrentStopsAtItsPeakInBothDirectionsAndNamesTheLimit) {
  Axis axis(config_without_rate_limit());
  EXPECT_NEAR(gated(axis, 0.0, 0.0, 2.9), 2.9, 1e-5);
  EXPECT_FALSE(has(axis.telemetry().limits, Limit::kCurrent));
  EXPECT_EQ(gated(axis, 0.0, 0.0, 50.0), 3.0);
  EXPECT_TRUE(has(axis.telemetry().limits, Limit::kCurrent));
  EXPECT_EQ(gated(axis, 0.0, 0.0, -1000.0), -3.0);
}

TEST(AxisGate, CurrentRisesNoFasterThanItsRate) {
  Axis axis(AxisConfig{});
  for (int i = 1; i <= 5; ++i) {
    EXPECT_NEAR(gated(axis, 0.0, 0.0, 2.2), std::min(0.5 * i, 2.2), 1e-5);
    EXPECT_EQ(has(axis.telemetry().limits, Limit::kRate), i < 5);
  }
  EXPECT_NEAR(gated(axis, 0.0, 0.0, -2.2), 1.7, 1e-5);
}

TEST(AxisGate, AtTheEndOfTheTendonsTravelThereIsOnlyTorqueInwards) {
  for (const double side : {1.0, -1.0}) {
    Axis axis(config_without_rate_limit());
    EXPECT_EQ(gated(axis, side * 6.001, 0.0, side * 2.0), 0.0);
    EXPECT_TRUE(has(axis.telemetry().limits, Limit::kMotorTravel));
    EXPECT_NEAR(gated(axis, side * 6.001, 0.0, side * -2.0), side * -2.0, 1e-5);
    EXPECT_FALSE(has(axis.telemetry().limits, Limit::kMotorTravel));
    EXPECT_NEAR(gated(axis, side * 5.99, 0.0, side * 2.0), side * 2.0, 1e-5);
  }
}

TEST(AxisGate, ASlowRateNeverDelaysTheEndOfTravel) {
  AxisConfig config;
  config.limits.current_rate_a_per_cycle = q(0.01);
  Axis axis(config);
  for (int i = 0; i < 200; ++i) {
    static_cast<void>(gated(axis, 5.9, 0.0, 2.0));
  }
  EXPECT_NEAR(axis.telemetry().drive_a.to_double(), 2.0, 1e-4);
  EXPECT_EQ(gated(axis, 6.01, 0.0, 2.0), 0.0) << "it still pulled outwards";
  EXPECT_LE(gated(axis, 6.01, 0.0, -2.0), 0.0);
}

RC_GTEST_PROP(AxisGate, NeverPullsOutwardsBeyondTheTravel, ()) {
  AxisConfig config;
  config.limits.current_rate_a_per_cycle = Q24::from_raw(*rc::gen::inRange(2000, 1 << 26));
  Axis axis(config);
  for (int i = 0; i < 200; ++i) {
    const double q1 = 6.0 + (*rc::gen::inRange(-100, 101)) * 1e-3;
    const double current = gated(axis, q1, 0.0, (*rc::gen::inRange(-500, 501)) * 0.01);
    RC_ASSERT(axis.telemetry().q1_rad < config.limits.motor_max_rad || current <= 0.0);
    RC_ASSERT(std::fabs(current) <= 3.0);
  }
}

/// Cycles until the gate gives less than the peak, with a measured current; -1 if it does not within `most`.
auto cycles_to_heat(Axis& axis, double measured_a, int most) -> int {
  for (int i = 0; i < most; ++i) {
    static_cast<void>(gated(axis, 0.0, measured_a, 3.0));
    if (has(axis.telemetry().limits, Limit::kThermal)) {
      return i;
    }
  }
  return -1;
}

TEST(AxisThermal, TwiceTheContinuousCurrentIsAllowedForAsLongAsTheWindingStandsIt) {
  Axis axis(config_without_rate_limit());
  // heat = 4 (1 - exp(-t / 10 s)) reaches 1 after 10 s ln(4/3).
  EXPECT_NEAR(cycles_to_heat(axis, 3.0, 10'000), 10'000.0 * std::log(4.0 / 3.0), 10.0);
  EXPECT_EQ(axis.telemetry().drive_a, q(1.5));
}

TEST(AxisThermal, TheContinuousCurrentIsAllowedForEver) {
  Axis axis(config_without_rate_limit());
  EXPECT_EQ(cycles_to_heat(axis, 1.49, 200'000), -1);
}

TEST(AxisThermal, TheReductionIsNotDelayedByTheRateLimit) {
  AxisConfig config;
  config.limits.current_rate_a_per_cycle = q(0.001);
  Axis axis(config);
  for (int i = 0; i < 2860; ++i) {
    static_cast<void>(gated(axis, 0.0, 3.0, 3.0));
  }
  ASSERT_GT(axis.telemetry().drive_a, q(2.8));
  ASSERT_GE(cycles_to_heat(axis, 3.0, 100), 0);
  EXPECT_EQ(axis.telemetry().drive_a, q(1.5));
}

TEST(AxisThermal, AHotWindingStaysLimitedAtItsContinuousCurrentWithoutChatter) {
  Axis axis(config_without_rate_limit());
  ASSERT_GE(cycles_to_heat(axis, 3.0, 10'000), 0);
  for (int i = 0; i < 60'000; ++i) {
    const double noise = i % 2 == 0 ? 0.02 : -0.03;
    ASSERT_EQ(gated(axis, 0.0, 1.5 + noise, 3.0), 1.5) << "cycle " << i;
  }
}

TEST(AxisThermal, APauseBringsThePeakCurrentBackAndDisarmingDoesNotForgetTheHeat) {
  Axis axis(config_without_rate_limit());
  ASSERT_GE(cycles_to_heat(axis, 3.0, 10'000), 0);
  for (int i = 0; i < 900; ++i) {
    static_cast<void>(gated(axis, 0.0, 0.0, 0.0, false));
  }
  EXPECT_EQ(gated(axis, 0.0, 0.0, 3.0), 1.5) << "still hot after 0.9 s";
  // From 1 to 0.9 in 10 s ln(1/0.9) = 1.05 s.
  for (int i = 0; i < 200; ++i) {
    static_cast<void>(gated(axis, 0.0, 0.0, 0.0, false));
  }
  EXPECT_NEAR(gated(axis, 0.0, 0.0, 2.9), 2.9, 1e-5);
}

TEST(AxisEncoder, AnglesHaveTheConfiguredScaleAndSign) {
  AxisConfig config;
  config.motor.encoder_counts_per_turn = 1000;
  config.motor.encoder_sign = -1;
  Axis axis(config);
  AxisSensed sensed = sensed_at(0.0, 0.0);
  sensed.encoder_counts = 250;
  estimate(axis, sensed);
  EXPECT_NEAR(axis.telemetry().q1_rad.to_double(), -1.5707963267948966, 1e-7);
}

TEST(AxisEncoder, JustBelowTheSpeedLimitIsNoJumpAndJustAboveIs) {
  AxisConfig config;
  config.motor.speed_limit_rad_s = q(60.0);
  for (const double sign : {1.0, -1.0}) {
    Axis axis(config);
    estimate(axis, sensed_at(0.0, 0.0));
    estimate(axis, sensed_at(sign * 0.0599, 0.0));
    EXPECT_EQ(axis.rt_faults(false) & bit(Fault::kEncoderJump), 0U);
    estimate(axis, sensed_at(sign * (0.0599 + 0.0602), 0.0));
    EXPECT_NE(axis.rt_faults(false) & bit(Fault::kEncoderJump), 0U);
  }
}

TEST(AxisEncoder, TheCountersWrapIsNeitherAJumpNorALossOfPosition) {
  Axis axis(AxisConfig{});
  axis.rt_zero(Q24{});
  AxisSensed sensed = sensed_at(0.0, 0.0);
  std::uint32_t counts = 0x7FFFFC00U;
  for (int i = 0; i <= 20; ++i) {
    sensed.encoder_counts = static_cast<std::int32_t>(counts + 100U * static_cast<unsigned>(i));
    estimate(axis, sensed);
    ASSERT_EQ(axis.rt_faults(false) & bit(Fault::kEncoderJump), 0U) << sensed.encoder_counts;
  }
  EXPECT_LT(sensed.encoder_counts, 0) << "the counter has wrapped";
  EXPECT_NEAR(axis.telemetry().q1_rad.to_double(), 2000.0 / kCountsPerRad, 1e-6) << "and the angle has not";
}

TEST(AxisEncoder, AfterAZeroTheMotorStandsWhereItWasSaidToStandWithAnyScaleAndSign) {
  for (const std::int32_t sign : {1, -1}) {
    for (const std::int32_t counts_per_turn : {16, 1000, 40960, 1 << 24}) {
      for (const double angle : {0.0, 1.5, -3.25, 100.0}) {
        AxisConfig config;
        config.motor.encoder_sign = sign;
        config.motor.encoder_counts_per_turn = counts_per_turn;
        Axis axis(config);
        estimate(axis, sensed_at(0.7, 0.0));
        axis.rt_zero(q(angle));
        estimate(axis, sensed_at(0.7, 0.0));
        EXPECT_NEAR(axis.telemetry().q1_rad.to_double(), angle, 3.1416 / counts_per_turn + 1e-7);
        EXPECT_EQ(axis.rt_faults(false), 0U);
      }
    }
  }
}

TEST(AxisEncoder, AnAngleBeyondTheFormatIsAnEstimatorFaultAndNotAWrongAngle) {
  Axis axis(AxisConfig{});
  estimate(axis, sensed_at(200.0, 0.0));
  EXPECT_NE(axis.rt_faults(false) & bit(Fault::kEstimatorRange), 0U);
  EXPECT_FALSE(axis.telemetry().estimate_valid);
}

TEST(AxisConfiguration, ANewEncoderScaleOrSignStartsTheLawAfresh) {
  AxisConfig config = test::lossy_config();
  Axis axis(config);
  for (int i = 0; i < 100; ++i) {
    estimate(axis, sensed_at(2.0 + 0.0001 * i, 0.0));
  }
  config.motor.encoder_sign = -1;
  axis.rt_configure(config);
  estimate(axis, sensed_at(2.01, 0.0));
  EXPECT_EQ(axis.rt_faults(false), 0U) << "the jump from +2 to -2 rad is no motion";
  // A fresh law at rest: beta q1 + offset, since play starts where the motor is.
  EXPECT_NEAR(axis.telemetry().q2_rad.to_double(), -1.08 * 2.01 + 0.05, 1e-3);
}

TEST(AxisConfiguration, NewGainsLeaveTheLawsMemoryAlone) {
  AxisConfig config = test::lossy_config();
  Axis changed(config);
  Axis untouched(config);
  for (int i = 0; i < 400; ++i) {
    if (i == 200) {
      config.control.kp = q(3.0);
      config.limits.following_error_rad = q(1.0);
      changed.rt_configure(config);
    }
    const AxisSensed sensed = sensed_at(0.5 * std::sin(0.02 * i), 0.3);
    estimate(changed, sensed);
    estimate(untouched, sensed);
    ASSERT_EQ(changed.telemetry().q2_rad, untouched.telemetry().q2_rad) << "cycle " << i;
  }
}

/// An axis at rest with torque.
void arm(Axis& axis) {
  estimate(axis, sensed_at(0.0, 0.0));
  axis.rt_arm();
}

TEST(AxisCommands, AMoveOutsideTheLimitsOrWithoutSpeedChangesNothing) {
  Axis axis(AxisConfig{});
  arm(axis);
  using Kind = AxisCommand::Kind;
  EXPECT_FALSE(axis.rt_command({Kind::kMove, q(2.0001), q(1.0)}));
  EXPECT_FALSE(axis.rt_command({Kind::kMove, q(-2.0001), q(1.0)}));
  EXPECT_FALSE(axis.rt_command({Kind::kMove, Q24::max(), q(1.0)}));
  EXPECT_FALSE(axis.rt_command({Kind::kMove, q(1.0), Q24{}}));
  EXPECT_FALSE(axis.rt_command({Kind::kMove, q(1.0), q(-1.0)}));
  EXPECT_FALSE(axis.in_motion());
  EXPECT_TRUE(axis.rt_command({Kind::kMove, q(2.0), q(1.0)}));
  EXPECT_TRUE(axis.in_motion());
}

TEST(AxisCommands, AMoveIsNoFasterThanTheJointsLimitWhateverIsAskedFor) {
  Axis axis(AxisConfig{});
  arm(axis);
  ASSERT_TRUE(axis.rt_command({AxisCommand::Kind::kMove, q(2.0), q(100.0)}));
  Q24 last;
  for (int i = 0; i < 2000; ++i) {
    estimate(axis, sensed_at(0.0, 0.0));
    static_cast<void>(axis.rt_control());
    ASSERT_LE(axis.telemetry().q2_reference_rad - last, q(0.002) + Q24::from_raw(1));
    last = axis.telemetry().q2_reference_rad;
  }
  EXPECT_EQ(last, q(2.0));
}

TEST(AxisCommands, AWildStreamIsFollowedNoFasterAndNoFurtherThanTheLimits) {
  for (const double wild : {100.0, -127.0}) {
    Axis axis(AxisConfig{});
    arm(axis);
    Q24 last;
    for (int i = 0; i < 1500; ++i) {
      estimate(axis, sensed_at(0.0, 0.0));
      EXPECT_FALSE(axis.rt_command({AxisCommand::Kind::kFollow, q(wild), {}}));
      static_cast<void>(axis.rt_control());
      const Q24 now = axis.telemetry().q2_reference_rad;
      ASSERT_LE(abs(now - last), q(0.002) + Q24::from_raw(1));
      ASSERT_TRUE(has(axis.telemetry().limits, Limit::kReference));
      last = now;
    }
    EXPECT_EQ(last, wild > 0.0 ? q(2.0) : q(-2.0));
  }
}

TEST(AxisCommands, AMoveTakesOverFromAStreamWhereItWas) {
  Axis axis(AxisConfig{});
  arm(axis);
  for (int i = 0; i < 100; ++i) {
    estimate(axis, sensed_at(0.0, 0.0));
    static_cast<void>(axis.rt_command({AxisCommand::Kind::kFollow, q(0.001 * i), {}}));
    static_cast<void>(axis.rt_control());
  }
  const Q24 before = axis.telemetry().q2_reference_rad;
  estimate(axis, sensed_at(0.0, 0.0));
  ASSERT_TRUE(axis.rt_command({AxisCommand::Kind::kMove, q(-1.0), q(1.0)}));
  static_cast<void>(axis.rt_control());
  // The stream ran at 1 rad/s, and a cycle at 10 rad/s2 takes 0.01 rad/s of it.
  EXPECT_NEAR((axis.telemetry().q2_reference_rad - before).to_double(), 0.00099, 1e-6);
}

TEST(AxisCommands, AHoldDuringAStreamBrakesWithTheJointsAccelerationAndNotAtOnce) {
  for (const double speed : {1.0, -1.5, 0.3}) {
    Axis axis(AxisConfig{});
    arm(axis);
    Q24 last;
    for (int i = 1; i <= 500; ++i) {
      estimate(axis, sensed_at(0.0, 0.0));
      static_cast<void>(axis.rt_command({AxisCommand::Kind::kFollow, q(0.001 * speed * i), {}}));
      static_cast<void>(axis.rt_control());
      last = axis.telemetry().q2_reference_rad;
    }
    const double began = last.to_double();
    estimate(axis, sensed_at(0.0, 0.0));
    ASSERT_TRUE(axis.rt_command({AxisCommand::Kind::kStop, {}, {}}));
    double before = 0.001 * speed;
    int cycles = 0;
    for (; axis.in_motion() && cycles < 1000; ++cycles) {
      static_cast<void>(axis.rt_control());
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
  Axis axis(config);
  const auto low_after = [&axis](double volts, int cycles) {
    FaultSet faults = 0;
    for (int i = 0; i < cycles; ++i) {
      AxisSensed sensed = sensed_at(0.0, 0.0);
      sensed.supply = Quality::kOk;
      sensed.supply_v = q(volts);
      estimate(axis, sensed);
      faults = axis.rt_faults(false);
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
  Axis axis(config);
  for (const Quality quality : {Quality::kMissing, Quality::kInvalid, Quality::kOk}) {
    for (int i = 0; i < 200; ++i) {
      axis.rt_sense({.encoder_counts = i * 100'000, .current_a = q(90.0), .encoder = quality, .current = quality});
      axis.rt_estimate(nullptr);
      ASSERT_EQ(axis.rt_faults(true), 0U);
      ASSERT_FALSE(axis.rt_command({.kind = AxisCommand::Kind::kFollow, .position_rad = q(0.5)}));
      const AxisDrive drive = axis.rt_limit(axis.rt_control(), true);
      ASSERT_FALSE(drive.enabled);
      ASSERT_EQ(drive.current_a, Q24{});
    }
    EXPECT_FALSE(axis.in_motion());
    EXPECT_FALSE(axis.telemetry().estimate_valid);
  }
  axis.rt_configure(AxisConfig{});
  estimate(axis, sensed_at(0.3, 0.0));
  EXPECT_EQ(axis.rt_faults(false), 0U);  // where the counter went before was nobody's jump
  EXPECT_TRUE(axis.telemetry().estimate_valid);
  EXPECT_NEAR(axis.telemetry().q2_rad.to_double(), 0.3, 1e-3);
}

}  // namespace
}  // namespace capstan
