// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/monitors.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace capstan {
namespace {

/// A motor that stands while its reference goes from one angle to another in a second.
auto faults_of_a_standing_motor(double from_rad, double to_rad) -> FaultSet {
  Monitors monitors;
  LimitConfig limits;
  limits.following_error_rad = Q24::from_double(1.0);
  limits.following_time_s = Q24::from_double(10.0);
  MotorState motor;
  JointReference reference;
  reference.mode = ControlMode::kMotor;
  FaultSet faults = 0;
  constexpr int kCycles = 1000;
  for (int i = 0; i <= kCycles; ++i) {
    reference.q1_rad = Q24::from_double(from_rad + ((to_rad - from_rad) * i / kCycles));
    faults |= monitors.rt_watch_motion(limits, motor, {}, reference, false);
  }
  return faults;
}

TEST(Monitors, AMotorThatStandsWhileItsReferenceGoesAwayHasADeadEncoder) {
  EXPECT_EQ(faults_of_a_standing_motor(0.0, 0.9), bit(Fault::kEncoderFrozen));
  EXPECT_EQ(faults_of_a_standing_motor(0.0, -0.9), bit(Fault::kEncoderFrozen));
}

TEST(Monitors, AMotorThatPressesMayStandWhileItsReferenceReturns) {
  EXPECT_EQ(faults_of_a_standing_motor(0.9, 0.0), FaultSet{0});
  EXPECT_EQ(faults_of_a_standing_motor(-0.9, 0.0), FaultSet{0});
}

/// A motor at rest for a tenth of a second and then at a steady speed for 20 ms. @returns after how many of those that
/// was a fault, ms; -1: never. @param pushed_ms  until then something else moves the motor
auto overspeed_ms(double motor_rad_s, double beta, int pushed_ms = 0) -> int {
  Monitors monitors;
  LimitConfig limits;
  limits.joint_speed_rad_s = Q24::from_double(2.0);
  limits.fault_travel_rad = Q24::from_double(0.05);
  constexpr int kRestMs = 100;
  for (int ms = 0; ms < kRestMs + 20; ++ms) {
    const auto q1_rad = Q24::from_double(motor_rad_s * std::max(0, ms - kRestMs) * 1e-3);
    if (monitors.rt_watch_speed(limits, q1_rad, Q24::from_double(beta), ms >= pushed_ms) == bit(Fault::kOverspeed)) {
      return ms - kRestMs;
    }
  }
  return -1;
}

// 0.05 rad and 16 ms of 2 rad/s are 0.082 rad, which 8 ms of 10.25 rad/s are.
TEST(Monitors, AMotorThatRunsAwayIsStoppedWithin9Ms) {
  EXPECT_EQ(overspeed_ms(10.3, 1.0), 8);
  EXPECT_EQ(overspeed_ms(-10.3, 1.0), 8);
  EXPECT_EQ(overspeed_ms(10.2, 1.0), -1);
}

TEST(Monitors, AMotorMayRunAwayFromItsFirstCycleWithTorqueOn) {
  Monitors monitors;
  monitors.rt_rest();
  LimitConfig limits;
  int found_ms = -1;
  for (int ms = 0; ms < 20 && found_ms < 0; ++ms) {
    const FaultSet faults = monitors.rt_watch_speed(limits, Q24::from_double(1.0 + 0.02 * ms), Q24::from_int(1), true);
    found_ms = faults == bit(Fault::kOverspeed) ? ms : -1;
  }
  EXPECT_EQ(found_ms, 8) << "before, the ring has places that nothing was written to";
}

TEST(Monitors, WhatCountsIsTheSpeedAtTheJoint) {
  EXPECT_EQ(overspeed_ms(20.4, 0.5), -1);
  EXPECT_EQ(overspeed_ms(5.2, -2.0), 8);
}

TEST(Monitors, AMotorThatSomethingElseMovesMayBeFast) {
  EXPECT_EQ(overspeed_ms(10.3, 1.0, 120), -1);
  EXPECT_EQ(overspeed_ms(10.3, 1.0, 60), -1) << "and springs back for 64 ms after";
  EXPECT_EQ(overspeed_ms(10.3, 1.0, 40), 8);
}

TEST(Monitors, AReferenceThatReturnsAndGoesBeyondIsAnsweredAgain) {
  EXPECT_EQ(faults_of_a_standing_motor(0.2, -0.9), bit(Fault::kEncoderFrozen));
}

}  // namespace
}  // namespace capstan
