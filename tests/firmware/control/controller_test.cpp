// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/control/controller.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

constexpr SamplePeriod<Q24> kPeriod{kCycleRateHz};

auto q(double value) -> Q24 {
  return Q24::from_double(value);
}

using test::lossy_config;

struct Rig {
  explicit Rig(const AxisConfig& axis_config) : config(axis_config), law(kPeriod, config.law) {}
  /// The motor stands at an angle for a while.
  void rest_at(Q24 q1, Q24 tau) {
    for (int i = 0; i < 50; ++i) {
      q2 = law.update(q1, tau).q2;
    }
  }
  void start() { controller.rt_start(config.control, law, q2); }
  auto torque(Q24 reference, Q24 estimate) -> Q24 { return controller.rt_update(config, law, reference, estimate); }

  AxisConfig config;
  MotionLaw<Q24> law;
  Controller controller{config.control};
  Q24 q2;
};

TEST(Controller, TakesOverWithTheMeanOfBothDirectionsTorquesWhereverTheJointStands) {
  for (const double q1 : {-3.0, -0.4, 0.0, 0.7, 4.0}) {
    for (const double tau : {-0.2, 0.0, 0.1}) {
      Rig rig(lossy_config());
      rig.rest_at(q(q1), q(tau));
      rig.start();
      EXPECT_NEAR(rig.torque(rig.q2, rig.q2).to_double(), (0.06 - 0.04) / 2.0, 2e-6) << q1 << " under " << tau;
    }
  }
}

TEST(Controller, AsksForNoTorqueWhenItTakesOverASymmetricJoint) {
  AxisConfig config = lossy_config();
  config.control.torque_backward_nm = -config.control.torque_forward_nm;
  Rig rig(config);
  rig.rest_at(q(1.0), q(0.1));
  rig.start();
  EXPECT_NEAR(rig.torque(rig.q2, rig.q2).to_double(), 0.0, 2e-6);
}

TEST(Controller, HoldsItsTorqueWhileTheReferenceStandsAtTheEstimate) {
  Rig rig(lossy_config());
  rig.rest_at(q(1.0), q(0.0));
  rig.start();
  const Q24 first = rig.torque(rig.q2, rig.q2);
  for (int i = 0; i < 5000; ++i) {
    ASSERT_EQ(rig.torque(rig.q2, rig.q2), first) << "cycle " << i;
  }
}

/// The servo's damping alone, while the motor is pushed by a sine of 5 Hz; the torque in each cycle.
auto damping_torques(double rate_time_constant_s) -> std::vector<double> {
  AxisConfig config = lossy_config();
  config.control.torque_forward_nm = config.control.torque_backward_nm = Q24{};
  config.control.kp = config.control.ki_per_s = config.control.stiffness_nm_per_rad = Q24{};
  config.control.rate_time_constant_s = q(rate_time_constant_s);
  Rig rig(config);
  rig.rest_at(q(0.5), Q24{});
  rig.start();
  std::vector<double> torques;
  for (int i = 1; i <= 400; ++i) {
    rig.law.update(q(0.5 + 0.1 * std::sin(2.0 * std::numbers::pi * 5.0 * 1e-3 * i)), Q24{});
    torques.push_back(rig.torque(rig.q2, rig.q2).to_double());
  }
  return torques;
}

TEST(Controller, TheServosRateIsFilteredByItsOwnTimeConstant) {
  const double damping = lossy_config().control.damping_nms_per_rad.to_double();
  for (const double time_s : {0.0, 0.0005, 0.002, 0.01}) {
    const std::vector<double> torques = damping_torques(time_s);
    double filtered = 0.0;
    double before = 0.5;
    for (int i = 1; i <= 400; ++i) {
      const double angle = 0.5 + 0.1 * std::sin(2.0 * std::numbers::pi * 5.0 * 1e-3 * i);
      filtered += ((angle - before) * 1e3 - filtered) * 1e-3 / (time_s + 1e-3);
      before = angle;
      ASSERT_NEAR(torques[static_cast<std::size_t>(i) - 1], -damping * filtered, 1e-5) << time_s << ", cycle " << i;
    }
  }
}

/// Only the feedforward: no servo, no loop.
auto feedforward_only() -> AxisConfig {
  AxisConfig config = lossy_config();
  config.control.stiffness_nm_per_rad = Q24{};
  config.control.damping_nms_per_rad = Q24{};
  return config;
}

TEST(Controller, FeedforwardCrossesToTheOtherBranchAtAReversalWithinItsTimeAndWithoutAKick) {
  Rig rig(feedforward_only());
  rig.config.control.reversal_time_s = q(0.02);
  rig.start();
  const double span = 0.06 + 0.04;
  const double largest_step = span / (0.02 * 1000.0 + 1.0);
  double reference = 0.0;
  double last = (0.06 - 0.04) / 2.0;
  for (int i = 0; i < 4000; ++i) {
    const bool forward = i / 1000 % 2 == 0;
    reference += forward ? 0.0005 : -0.0005;
    const double torque = rig.torque(q(reference), Q24{}).to_double();
    ASSERT_LE(torque, 0.06 + 1e-6);
    ASSERT_GE(torque, -0.04 - 1e-6);
    ASSERT_LE(std::fabs(torque - last), largest_step + 1e-6) << "cycle " << i;
    last = torque;
    if (i % 1000 == 100) {
      ASSERT_NEAR(torque, forward ? 0.06 : -0.04, 0.02 * span) << "cycle " << i;
    }
  }
}

// Dahl's friction: what is left of the other branch falls to 1/e over each reversal_angle, however fast.
TEST(Controller, FeedforwardCrossesOverAWayOfTheReferenceWhateverItsSpeed) {
  for (const double step : {0.0001, 0.0005}) {
    AxisConfig config = feedforward_only();
    config.control.reversal_time_s = q(0.02);
    config.control.reversal_angle_rad = q(0.1);
    Rig rig(config);
    rig.start();
    double reference = 0.0;
    for (; reference < 0.8; reference += step) {
      rig.torque(q(reference), Q24{});
    }
    const double turned_at = reference;
    for (; turned_at - reference < 0.1; reference -= step) {
      rig.torque(q(reference), Q24{});
    }
    const double torque = rig.torque(q(reference), Q24{}).to_double();
    // lossy_config()'s motor turns by 1 / beta of the joint; its rate is filtered by 2 ms.
    const double way = 0.1 / rig.law.beta().to_double();
    EXPECT_NEAR(torque, -0.04 + 0.1 * std::exp(-way / 0.1), 0.003) << step;
  }
}

RC_GTEST_PROP(Controller, FeedforwardStaysBetweenTheTwoDirectionsTorquesForAnyReference, ()) {
  Rig rig(feedforward_only());
  rig.start();
  double reference = 0.0;
  for (int i = 0; i < 300; ++i) {
    reference += (*rc::gen::inRange(-1000, 1001)) * 2e-6;
    const double torque = rig.torque(q(reference), Q24{}).to_double();
    RC_ASSERT(torque <= 0.06 + 1e-6);
    RC_ASSERT(torque >= -0.04 - 1e-6);
  }
}

/// Only the joint loop: a rigid joint and a servo of 1 Nm/rad, so torque is the correction of the motor angle.
auto loop_only(double kp, double ki, double kd) -> AxisConfig {
  AxisConfig config;
  config.control.kp = q(kp);
  config.control.ki_per_s = q(ki);
  config.control.kd_s = q(kd);
  config.control.damping_nms_per_rad = Q24{};
  return config;
}

TEST(Controller, TheIntegralStopsAtItsLimitAndComesBackWithoutDelay) {
  Rig rig(loop_only(0.0, 10.0, 0.0));
  rig.config.control.integral_limit_rad = q(0.3);
  rig.start();
  const Q24 error = q(0.5);
  for (int i = 0; i < 20'000; ++i) {
    ASSERT_LE(rig.torque(Q24{}, -error).to_double(), 0.3 + 1e-6);
  }
  EXPECT_NEAR(rig.torque(Q24{}, -error).to_double(), 0.3, 1e-6);
  // Wound up for 20 s, unwound in 0.3 / (10 * 0.5) = 60 ms.
  for (int i = 0; i < 61; ++i) {
    static_cast<void>(rig.torque(Q24{}, error));
  }
  EXPECT_LE(rig.torque(Q24{}, error).to_double(), 0.0);
}

TEST(Controller, AnErrorOfAnySizePullsTowardsTheReference) {
  for (const double error : {0.01, 0.5, 3.0, 60.0, 127.0}) {
    for (const double ki : {0.5, 40.0, 100.0}) {
      Rig up(loop_only(0.0, ki, 0.0));
      up.start();
      EXPECT_GT(up.torque(Q24{}, q(-error)), Q24{}) << error << " with " << ki;
      Rig down(loop_only(0.0, ki, 0.0));
      down.start();
      EXPECT_LT(down.torque(Q24{}, q(error)), Q24{}) << error << " with " << ki;
    }
  }
}

TEST(Controller, TheIntegralTreatsBothSignsOfASmallErrorAlike) {
  const Q24 error = Q24::from_raw(300);  // a tenth of a unit a cycle at ki = 0.333: rounds to nothing either way
  for (const double ki : {0.333, 4.0, 9.0}) {
    Rig up(loop_only(0.0, ki, 0.0));
    Rig down(loop_only(0.0, ki, 0.0));
    up.start();
    down.start();
    Q24 rise;
    Q24 fall;
    for (int i = 0; i < 1000; ++i) {
      rise = up.torque(Q24{}, -error);
      fall = down.torque(Q24{}, error);
    }
    EXPECT_EQ(rise.raw(), -fall.raw()) << "ki " << ki;
  }
}

TEST(Controller, AStartValueBeyondTheLimitOnlyShrinks) {
  constexpr double kLimit = 0.001;
  for (const double sign : {1.0, -1.0}) {
    AxisConfig config = lossy_config();  // without lost motion, which the branch would take first
    set_raw_value(config, *find_parameter("play.gain"), 0);
    config.control.torque_forward_nm = config.control.torque_backward_nm = Q24{};
    Rig rig(config);
    rig.config.control.kp = Q24{};
    rig.config.control.ki_per_s = q(5.0);
    rig.config.control.integral_limit_rad = q(kLimit);
    rig.rest_at(q(sign), q(0.3 * sign));
    rig.start();
    const Q24 held = rig.torque(rig.q2, rig.q2);
    const auto run = [&rig](double error) {
      Q24 last;
      for (int i = 0; i < 20'000; ++i) {
        last = rig.torque(rig.q2, rig.q2 - q(error));
      }
      return last;
    };
    // The servo has 1 Nm/rad, so the torque shows the integral. One of the two errors pushes it further out, in vain.
    const Q24 up = run(0.01);
    const Q24 down = run(-0.01);
    const bool starts_above = up == held;
    const double shrunk = std::fabs(((starts_above ? down : up) - held).to_double());
    EXPECT_GT(shrunk, 10.0 * kLimit) << "the start value is far beyond the limit";
    const Q24 inside = run(starts_above ? 0.01 : -0.01);
    EXPECT_NEAR(std::fabs(((starts_above ? down : up) - inside).to_double()), 2.0 * kLimit, 1e-6)
        << "once inside it goes from one end of the limit to the other";
  }
}

TEST(Controller, NewTorquesOfASteadyMotionReachTheInverse) {
  AxisConfig config = lossy_config();
  config.control.kp = config.control.ki_per_s = config.control.kd_s = Q24{};
  Rig rig(config);
  rig.start();
  double reference = 0.0;
  for (int i = 0; i < 2000; ++i) {  // long enough for the branch to be the forward one
    reference += 0.0005;
    static_cast<void>(rig.torque(q(reference), Q24{}));
  }
  const double before = rig.controller.motor_reference().to_double();
  rig.config.control.torque_forward_nm += q(0.02);
  rig.controller.rt_configure(rig.config.control);
  static_cast<void>(rig.torque(q(reference + 0.0005), Q24{}));
  // q1 = (q2 - a tau - rest) / beta, with a of -0.9 rad/Nm and beta of 1.08.
  EXPECT_NEAR(rig.controller.motor_reference().to_double() - before, (0.0005 + 0.9 * 0.02) / 1.08, 1e-6);
}

TEST(Controller, NewGainsBringTheirTorqueWithoutAJumpAndWithinASecond) {
  AxisConfig config = lossy_config();
  config.control.kp = config.control.ki_per_s = config.control.kd_s = Q24{};
  Rig rig(config);
  rig.rest_at(q(1.0), q(0.0));
  rig.start();
  double torque = rig.torque(rig.q2, rig.q2).to_double();
  const double before = torque;
  rig.config.control.torque_forward_nm += q(0.2);
  rig.config.control.stiffness_nm_per_rad += rig.config.control.stiffness_nm_per_rad;
  rig.controller.rt_configure(rig.config.control);
  double largest_step = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double now = rig.torque(rig.q2, rig.q2).to_double();
    largest_step = std::max(largest_step, std::abs(now - torque));
    torque = now;
  }
  EXPECT_LT(largest_step, 0.006 * std::abs(torque - before)) << "a time constant of 200 cycles";
  // Half way between the branches: half of what is new. The inverse asks for as much again of the servo, which is a
  // rad per -0.9 rad/Nm of the law; with the torque at rest it is seen alone in NewTorquesOfASteadyMotion...
  EXPECT_GT(std::abs(torque - before), 0.1);
}

TEST(Controller, TheDerivativeActsOnTheEstimateAndNotOnTheReference) {
  Rig rig(loop_only(0.0, 0.0, 0.1));
  rig.config.control.stiffness_nm_per_rad = q(1.0);
  rig.start();
  static_cast<void>(rig.torque(Q24{}, Q24{}));
  // The rigid inverse law moves the motor's reference by the same step, and nothing else may.
  EXPECT_NEAR(rig.torque(q(0.01), Q24{}).to_double(), 0.01, 1e-6);
  EXPECT_LT(rig.torque(q(0.01), q(0.001)).to_double(), -0.05) << "an estimate of 1 rad/s is braked by 0.1 s * 1 rad/s";
}

TEST(Controller, ACrossedTransmissionIsCorrectedAgainstTheJoint) {
  AxisConfig config = loop_only(0.5, 5.0, 0.0);
  config.law.coefficients[0] = Q24::from_int(-1);
  Rig rig(config);
  rig.start();
  EXPECT_LT(rig.torque(Q24{}, q(-0.1)), Q24{}) << "the joint is too low, so the motor must go down";
}

TEST(Controller, ACrossedTransmissionGetsTheTorqueOfTheMotorsOwnDirection) {
  AxisConfig config = feedforward_only();
  config.law.coefficients[0] = q(-1.08);
  Rig rig(config);
  rig.start();
  double torque = 0.0;
  for (int i = 0; i < 300; ++i) {
    torque = rig.torque(q(0.001 * i), Q24{}).to_double();
  }
  EXPECT_NEAR(torque, -0.04, 1e-3) << "the joint goes up, so the motor goes backward";
}

/// Turns of the feedforward while another axis pulls and the reference goes 0.4 rad up and down again within 8 s.
auto turns_where_another_axis_pulls(const char* effect, double size) -> int {
  AxisConfig config = feedforward_only();
  config.coupled_to[0] = 1;
  config.law = {};
  config.law.coefficients[0] = Q24::from_int(1);
  set_raw_value(config, *find_parameter(effect), q(size).raw());
  Rig rig(config);
  rig.start();
  int turns = 0;
  double last = 0.01;
  double before = 0.01;
  for (int i = 0; i < 8000; ++i) {
    const double torque = rig.torque(q(0.0001 * (i < 4000 ? i : 8000 - i)), Q24{}).to_double();
    turns += (torque - last) * (last - before) < 0.0 ? 1 : 0;
    before = torque == last ? before : last;
    last = torque;
  }
  return turns;
}

TEST(Controller, HysteresisOfEitherSignTurnsTheFeedforwardOncePerReversalWhereAnotherAxisPulls) {
  // The joint lags behind the motor, or goes ahead of it on the way.
  for (const auto& [effect, size] : {std::pair{"tendon_elongation.top", -0.9},
                                     {"pretension_offset.contrast", 0.05},
                                     {"pretension_offset.contrast", 0.005}}) {
    EXPECT_LE(turns_where_another_axis_pulls(effect, size), 2) << effect << ' ' << size;
  }
}

TEST(Controller, FollowsAFastReferenceWithTheMotorsSpeed) {
  AxisConfig config = loop_only(0.0, 0.0, 0.0);
  config.control.stiffness_nm_per_rad = Q24{};
  config.control.damping_nms_per_rad = q(0.01);
  config.law.coefficients[0] = q(0.5);
  Rig rig(config);
  rig.start();
  double torque = 0.0;
  for (int i = 0; i < 200; ++i) {
    torque = rig.torque(q(0.001 * i), Q24{}).to_double();
  }
  EXPECT_NEAR(torque, 0.01 * (1.0 / 0.5), 1e-4)
      << "1 rad/s of the joint is 2 rad/s of the motor, against a motor at rest";
}

}  // namespace
}  // namespace capstan
