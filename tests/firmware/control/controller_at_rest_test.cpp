// SPDX-License-Identifier: Apache-2.0
// What the integral does while the reference stands: friction and lost motion make of it what hunts.
#include <gtest/gtest.h>

#include "capstan/firmware/control/controller.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

constexpr SamplePeriod<Q24> kPeriod{kCycleRateHz};

auto q(double value) -> Q24 {
  return Q24::from_double(value);
}

/// A controller whose integral alone corrects; the joint is wherever a test says.
struct Rig {
  explicit Rig(double error_bar_rad) {
    config.control.kp = Q24{};
    config.error_bar.steady_rad = q(error_bar_rad / 2.0);
    config.error_bar.turning_rad = q(error_bar_rad);
    controller.rt_expect_lost_motion(
        law.lost_motion(config.control.torque_backward_nm, config.control.torque_forward_nm));
    controller.rt_start(config.control, law, Q24{});
  }
  /// The reference goes on at a steady speed, and the joint with it.
  void go(double by_rad, int cycles) {
    for (int i = 1; i <= cycles; ++i) {
      reference_rad += by_rad / cycles;
      update(0.0);
    }
  }
  void update(double error_rad) {
    static_cast<void>(controller.rt_update(config, law, q(reference_rad), q(reference_rad) - q(error_rad)));
  }
  [[nodiscard]] auto motor_rad() const -> double { return controller.motor_reference().to_double(); }

  AxisConfig config = test::lossy_config();
  MotionLaw<Q24> law{kPeriod, config.law};
  Controller controller{config.control};
  double reference_rad = 0.0;
};

TEST(ControllerAtRest, AnErrorWithinTheLawsErrorBarIsLeft) {
  for (const double error_rad : {0.0039, -0.0039}) {
    Rig rig(0.004);
    const double before = rig.motor_rad();
    for (int i = 0; i < 60'000; ++i) {
      rig.update(error_rad);
    }
    EXPECT_EQ(rig.motor_rad(), before);
  }
}

TEST(ControllerAtRest, ALargerErrorIsTakenBack) {
  for (const double error_rad : {0.0041, -0.0041}) {
    Rig rig(0.004);
    const double before = rig.motor_rad();
    for (int i = 0; i < 1000; ++i) {
      rig.update(error_rad);
    }
    EXPECT_NEAR(rig.motor_rad() - before, 4.0 * error_rad, 1e-4) << "control.ki of 4 1/s";
  }
}

TEST(ControllerAtRest, AnyErrorIsIntegratedWhileTheReferenceMoves) {
  Rig rig(0.004);
  rig.go(0.5, 1000);
  const double before = rig.motor_rad();
  for (int i = 0; i < 1000; ++i) {
    rig.reference_rad += 0.0005;
    rig.update(0.002);
  }
  EXPECT_NEAR(rig.motor_rad() - before, 0.5 / 1.08 + 4.0 * 0.002, 1e-4);
}

// Gap and stretch of the law are 0.113 rad of the motor between its directions.
TEST(ControllerAtRest, AMotorThatWasTurnedRoundIsNotTakenAcrossTheLostMotionAgain) {
  Rig rig(0.004);
  rig.go(0.5, 1000);
  rig.go(0.0, 100);
  const double forward = rig.motor_rad();
  const double lost = (0.9 * 0.06 + 0.7 * 0.04 + 2.0 * 0.02) / 1.08;
  while (rig.motor_rad() > forward - lost) {
    rig.update(-0.01);
  }
  const double turned = rig.motor_rad();
  rig.go(-0.3, 1000);
  EXPECT_NEAR(rig.motor_rad() - turned, -0.3 / 1.08, 1e-3) << "and not by the lost motion more";
}

TEST(ControllerAtRest, WhatIsLeftOfTheWayAcrossIsTheIntegrals) {
  Rig rig(0.004);
  rig.go(0.5, 1000);
  rig.go(0.0, 100);
  const double forward = rig.motor_rad();
  for (int i = 0; i < 5000; ++i) {
    rig.update(-0.01);
  }
  EXPECT_NEAR(rig.motor_rad() - forward, -0.2, 2e-3);
}

}  // namespace
}  // namespace capstan
