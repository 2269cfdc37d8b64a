// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/monitors.hpp"

#include <gtest/gtest.h>

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

TEST(Monitors, AReferenceThatReturnsAndGoesBeyondIsAnsweredAgain) {
  EXPECT_EQ(faults_of_a_standing_motor(0.2, -0.9), bit(Fault::kEncoderFrozen));
}

}  // namespace
}  // namespace capstan
