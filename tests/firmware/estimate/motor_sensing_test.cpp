// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/estimate/motor_sensing.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/firmware/loop/axis_bench.hpp"

namespace capstan {
namespace {

using namespace test;

TEST(MotorSensing, AnglesHaveTheConfiguredScaleAndSign) {
  AxisConfig config;
  config.motor.encoder_counts_per_turn = 1000;
  config.motor.encoder_sign = -1;
  AxisBench axis(config);
  AxisSensed sensed = sensed_at(0.0, 0.0);
  sensed.encoder_counts = 250;
  axis.estimate(sensed);
  EXPECT_NEAR(axis.telemetry().q1_rad.to_double(), -1.5707963267948966, 1e-7);
}

TEST(MotorSensing, JustBelowTheSpeedLimitIsNoJumpAndJustAboveIs) {
  AxisConfig config;
  config.motor.speed_limit_rad_s = q(60.0);
  for (const double sign : {1.0, -1.0}) {
    AxisBench axis(config);
    axis.estimate(sensed_at(0.0, 0.0));
    axis.estimate(sensed_at(sign * 0.0599, 0.0));
    EXPECT_EQ(axis.faults(false) & bit(Fault::kEncoderJump), 0U);
    axis.estimate(sensed_at(sign * (0.0599 + 0.0602), 0.0));
    EXPECT_NE(axis.faults(false) & bit(Fault::kEncoderJump), 0U);
  }
}

TEST(MotorSensing, TheCountersWrapIsNeitherAJumpNorALossOfPosition) {
  AxisBench axis(AxisConfig{});
  axis.axis().rt_zero(Q24{});
  AxisSensed sensed = sensed_at(0.0, 0.0);
  std::uint32_t counts = 0x7FFFFC00U;
  for (int i = 0; i <= 20; ++i) {
    sensed.encoder_counts = static_cast<std::int32_t>(counts + 100U * static_cast<unsigned>(i));
    axis.estimate(sensed);
    ASSERT_EQ(axis.faults(false) & bit(Fault::kEncoderJump), 0U) << sensed.encoder_counts;
  }
  EXPECT_LT(sensed.encoder_counts, 0) << "the counter has wrapped";
  EXPECT_NEAR(axis.telemetry().q1_rad.to_double(), 2000.0 / kCountsPerRad, 1e-6) << "and the angle has not";
}

TEST(MotorSensing, AfterAZeroTheMotorStandsWhereItWasSaidToStandWithAnyScaleAndSign) {
  for (const std::int32_t sign : {1, -1}) {
    for (const std::int32_t counts_per_turn : {16, 1000, 40960, 1 << 24}) {
      for (const double angle : {0.0, 1.5, -3.25, 100.0}) {
        AxisConfig config;
        config.motor.encoder_sign = sign;
        config.motor.encoder_counts_per_turn = counts_per_turn;
        AxisBench axis(config);
        axis.estimate(sensed_at(0.7, 0.0));
        axis.axis().rt_zero(q(angle));
        axis.estimate(sensed_at(0.7, 0.0));
        EXPECT_NEAR(axis.telemetry().q1_rad.to_double(), angle, 3.1416 / counts_per_turn + 1e-7);
        EXPECT_EQ(axis.faults(false), 0U);
      }
    }
  }
}

TEST(MotorSensing, AZeroWithoutAnEncoderAsksForAnotherOne) {
  AxisBench axis(AxisConfig{});
  axis.estimate(sensed_at(0.2, 0.0));
  AxisSensed blind = sensed_at(0.2, 0.0);
  blind.encoder = Quality::kMissing;
  axis.estimate(blind);
  axis.axis().rt_zero(q(0.5));
  axis.estimate(blind);
  axis.estimate(sensed_at(2.2, 0.0));  // it turned before the encoder came back
  EXPECT_NE(axis.faults(false) & bit(Fault::kEncoderJump), 0U);
  axis.axis().rt_zero(q(0.5));
  axis.estimate(sensed_at(2.2, 0.0));
  EXPECT_EQ(axis.faults(false), 0U);
  EXPECT_NEAR(axis.telemetry().q1_rad.to_double(), 0.5, 1e-3);
}

TEST(MotorSensing, AnEncoderThatIsMissingForAWhileLosesNothing) {
  AxisBench axis(AxisConfig{});
  axis.estimate(sensed_at(0.2, 0.0));
  axis.axis().rt_zero(q(0.5));
  axis.estimate(sensed_at(0.2, 0.0));
  AxisSensed blind = sensed_at(0.2, 0.0);
  blind.encoder = Quality::kMissing;
  axis.estimate(blind);
  axis.estimate(sensed_at(0.21, 0.0));
  EXPECT_EQ(axis.faults(false), 0U);
  EXPECT_NEAR(axis.telemetry().q1_rad.to_double(), 0.51, 1e-3);
}

TEST(MotorSensing, AJointThatWasNotFittedForAWhileIsToBeZeroedAgainIfItWasBefore) {
  for (const bool zeroed : {false, true}) {
    AxisConfig config;
    AxisBench axis(config);
    axis.estimate(sensed_at(0.2, 0.0));
    if (zeroed) {
      axis.axis().rt_zero(q(0.5));
      axis.estimate(sensed_at(0.2, 0.0));
    }
    config.motor.fitted = 0;
    axis.axis().rt_configure(config);
    axis.estimate(sensed_at(0.2, 0.0));
    EXPECT_EQ(axis.faults(false), 0U) << "nobody misses it";
    config.motor.fitted = 1;
    axis.axis().rt_configure(config);
    axis.estimate(sensed_at(2.2, 0.0));  // turned by hand
    EXPECT_EQ((axis.faults(false) & bit(Fault::kEncoderJump)) != 0, zeroed);
    if (!zeroed) {
      EXPECT_NEAR(axis.telemetry().q1_rad.to_double(), 2.2, 1e-3) << "its own counts, as at the start";
    }
  }
}

TEST(MotorSensing, AnAngleBeyondTheFormatIsAnEstimatorFaultAndNotAWrongAngle) {
  AxisBench axis(AxisConfig{});
  axis.estimate(sensed_at(200.0, 0.0));
  EXPECT_NE(axis.faults(false) & bit(Fault::kEstimatorRange), 0U);
  EXPECT_FALSE(axis.telemetry().estimate_valid);
}

}  // namespace
}  // namespace capstan
