// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <initializer_list>

#include "capstan/tests/firmware/safety/motor_observer_rig.hpp"

namespace capstan {
namespace {

using observer_rig::Rig;

/// A motor at 5 counts a cycle, 0.77 rad/s, that winds its tendons up by 10 mA a cycle.
struct Winding {
  explicit Winding(int direction) : way(direction) {
    for (int v = 0; v < 5; ++v) {
      EXPECT_EQ(step(v, 0.01), 0U);
    }
    for (int i = 0; i < 60; ++i) {
      EXPECT_EQ(step(5, 0.01), 0U) << i;
    }
  }
  auto step(int moved, double rise_a) -> FaultSet {
    torque_a += rise_a;
    return rig.step(way * moved, way * torque_a);
  }
  auto steps(std::initializer_list<int> counts, double rise_a) -> FaultSet {
    FaultSet faults = 0;
    for (const int moved : counts) {
      faults |= step(moved, rise_a);
    }
    return faults;
  }
  int way;
  Rig rig;
  double torque_a = 0.0;
};

// 0.3 A within the last 32 cycles would explain 9 counts in one cycle.
TEST(MotorObserver, HalfOfTheCountsShowsInThreeCyclesWhileTheMotorWindsItsTendonsUp) {
  for (const int way : {1, -1}) {
    Winding healthy(way);
    EXPECT_EQ(healthy.steps({5, 5, 4, 5, 5, 6, 5, 5}, 0.01), 0U) << "a steady speed is quantised";
    Winding half(way);
    EXPECT_EQ(half.step(2, 0.01), 0U) << "one cycle alone is not enough";
    EXPECT_EQ(half.steps({3, 2}, 0.015), bit(Fault::kEncoderMotion)) << "the servo pushes";
    Winding stuck(way);
    EXPECT_NE(stuck.steps({0, 0}, 0.015), 0U);
  }
}

TEST(MotorObserver, AMotorWhoseTorqueMeetsItsLimitIsStoppedByItsTendons) {
  Winding limited(1);
  EXPECT_EQ(limited.steps({5, 4, 3, 2, 1, 0}, 0.0), 0U);
  Winding helped(1);
  EXPECT_EQ(helped.steps({5, 4, 2, 2, 1}, -0.01), 0U) << "torque that falls is no winding up";
}

TEST(MotorObserver, TorqueThatFellJustBeforeExplainsASlowingDownWhileItRisesAgain) {
  for (const bool fell : {true, false}) {
    Winding winding(1);
    ASSERT_EQ(winding.steps({5, 5, 5, 5}, fell ? -0.005 : 0.01), 0U);
    EXPECT_EQ(winding.steps({5, 2, 3, 2}, 0.015), fell ? 0U : bit(Fault::kEncoderMotion));
  }
}

TEST(MotorObserver, AMotorThatSlowsDownBitByBitGoesOnSlowingDownWhileItWinds) {
  Winding winding(1);
  EXPECT_EQ(winding.steps({5, 4, 5, 4, 4, 4, 3, 4, 3, 3, 2, 3, 2, 2, 1, 2, 1, 1, 0}, 0.01), 0U);
}

TEST(MotorObserver, AJointThatSwingsWhileItWindsMaySlowDownAsItDidOfLate) {
  Winding winding(1);
  for (int i = 0; i < 6; ++i) {
    // its speed goes up and down by ever more counts
    EXPECT_EQ(winding.steps({5, 6, 6, 6, 5, 4, 4, 4}, 0.01), 0U) << i;
  }
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(winding.steps({5, 6, 7, 7, 6, 5, 4, 3, 3, 4}, 0.01), 0U) << i;
  }
}

TEST(MotorObserver, AMotorThatItsTendonsSpringBackWhenTorqueComesMayStopWhileItWindsThemUp) {
  for (const bool later : {false, true}) {
    MotorObserver observer(observer_rig::commissioned_config());
    MotorState motor;
    Q24 wanted;
    const auto step = [&](int moved, bool energised) {
      motor.counts += moved;
      wanted = motor.current_a = wanted + Q24::from_double(0.01);
      return observer.rt_step(motor, wanted, energised);
    };
    for (int i = 0; i < 5; ++i) {
      static_cast<void>(step(5, false));
    }
    observer.rt_arm();
    for (int i = 0; i < (later ? 60 : 40); ++i) {
      ASSERT_EQ(step(5, true), 0U) << i;
    }
    EXPECT_EQ((step(0, true) | step(0, true) | step(0, true)) == 0U, !later);
  }
}

}  // namespace
}  // namespace capstan
