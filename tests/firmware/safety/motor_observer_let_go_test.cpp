// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <initializer_list>

#include "capstan/tests/firmware/safety/motor_observer_rig.hpp"

namespace capstan {
namespace {

using observer_rig::Rig;

// 0.9 A held by a tendon that tears give the motor 29 counts more in each cycle; limits.joint_speed is 13 counts.
TEST(MotorObserver, AMotorWhoseLoadLetsGoAtOnceIsFoundInTwoCycles) {
  for (const int way : {1, -1}) {
    Rig rig;
    rig.run_at(5);
    FaultSet faults = 0;
    for (const int moved : {9, 22}) {
      faults |= rig.step(way > 0 ? moved : -moved, 0.05);
    }
    EXPECT_NE(faults & bit(Fault::kEncoderMotion), 0U) << way;
  }
}

TEST(MotorObserver, AMotorThatItsTorqueSpeedsUpIsNot) {
  Rig rig;
  rig.run_at(5);
  EXPECT_EQ(rig.step(6, 0.05), 0U);
  EXPECT_EQ(rig.step(14, 0.45), 0U) << "0.4 A for a cycle are 13 counts";
  EXPECT_EQ(rig.step(20, 0.45), 0U);
}

TEST(MotorObserver, ALoadThatLetsGoSlowlyIsNoTornTendon) {
  Rig rig;
  rig.run_at(5);
  FaultSet faults = 0;
  for (const int moved : {7, 10, 13, 16, 18, 20}) {
    faults |= rig.step(moved, 0.05);
  }
  EXPECT_EQ(faults, 0U) << "3 counts more in each cycle, half of what a torn tendon gives in its weakest cycle";
}

}  // namespace
}  // namespace capstan
