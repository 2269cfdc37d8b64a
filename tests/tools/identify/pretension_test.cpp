// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/pretension.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "capstan/tools/identify/tendon_fit.hpp"

namespace capstan::tools {
namespace {

using Place = PretensionNumbers::Place;

/// A law whose tendons have eta 0.4 and 0.6, a pretension of 0.05 Nm and the motor a friction of 0.01 Nm.
auto tendons() -> JointFile {
  JointFile joint;
  joint.terms = {"motor_angle", "joint_offset", kTendonModel};
  const std::size_t first = joint.catalogue->term(kTendonModel).first_shape;
  const double shapes[] = {0.4, 0.6, 0.05, 0.5, 0.01};
  std::copy(std::begin(shapes), std::end(shapes), joint.parameters.shapes.begin() + static_cast<std::ptrdiff_t>(first));
  joint.parameters.coefficients[joint.catalogue->term("motor_angle").first_coefficient] = 0.5;
  joint.parameters.coefficients[joint.catalogue->term(kTendonModel).first_coefficient] = -2.0;
  joint.fit.emplace();
  return joint;
}

auto has(const std::string& sentence, const std::string& words) -> bool {
  return sentence.find(words) != std::string::npos;
}

TEST(Held, IsAJointThatHardlyFollowsItsMotor) {
  AxisLog log;
  log.q1_rad = Eigen::VectorXd::LinSpaced(100, 0.0, 2.0);
  EXPECT_FALSE(is_held(log, 0.5));  // nobody measured the joint
  log.q2_rad = 0.5 * log.q1_rad;
  EXPECT_FALSE(is_held(log, 0.5));
  EXPECT_FALSE(is_held(log, -0.5));
  log.q2_rad = 0.5 * 0.24 * log.q1_rad;
  EXPECT_TRUE(is_held(log, 0.5));
  EXPECT_TRUE(is_held(log, -0.5));
}

TEST(Held, IsAJointThatANoisyCameraSeesMoveAsFarAsItsMotor) {
  AxisLog log;
  log.q1_rad = Eigen::VectorXd::LinSpaced(3000, 0.0, 0.005);
  std::mt19937 engine(3);
  std::normal_distribution<double> noise(0.0, 0.001);
  log.q2_rad = Eigen::VectorXd::NullaryExpr(3000, [&] { return noise(engine); });
  ASSERT_GT(log.q2_rad.maxCoeff() - log.q2_rad.minCoeff(), 0.005);
  EXPECT_TRUE(is_held(log, 1.0));
  log.q2_rad += log.q1_rad;
  EXPECT_FALSE(is_held(log, 1.0));
}

TEST(Pretension, OfALogWithTheTipHeldTellsItsParts) {
  const auto told = pretension_of(tendons(), true);
  ASSERT_TRUE(told);
  EXPECT_NEAR(told->eta(), 0.5, 1e-12);
  EXPECT_NEAR(told->torque_nm(), 0.05, 1e-12);
  EXPECT_NEAR(told->friction_nm(), 0.025, 1e-12);
  // Without intervals of a fit each counts twice: the share that is known of it, and the same for the fit.
  EXPECT_NEAR(told->eta_95(), 0.5 * 0.025 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(told->torque_95_nm(), 0.05 * 0.015 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(told->friction_95_nm(), 0.025 * std::sqrt(2.0 * (0.025 * 0.025 + 0.015 * 0.015)), 1e-12);
}

TEST(Pretension, ItsIntervalIsThatOfTheFitBesideWhatIsKnownAtBest) {
  JointFile joint = tendons();
  joint.shape_ci95[joint.catalogue->term(kTendonModel).first_shape + 2] = Interval{0.046, 0.054};
  EXPECT_NEAR(pretension_of(joint, true)->torque_95_nm(), std::hypot(0.015 * 0.05, 0.004), 1e-12);
}

TEST(Pretension, LargeFrictionNumbersAreKnownLessWell) {
  JointFile joint = tendons();
  for (std::size_t tendon = 0; tendon < 2; ++tendon) {
    joint.parameters.shapes[joint.catalogue->term(kTendonModel).first_shape + tendon] = 1.2;
  }
  EXPECT_NEAR(pretension_of(joint, true)->eta_95(), 1.2 * 0.06 * std::sqrt(2.0), 1e-12);
}

TEST(Pretension, OfAFreeTipTellsTheProductOnly) {
  const auto told = pretension_of(tendons(), false);
  ASSERT_TRUE(told);
  EXPECT_NEAR(told->friction_nm(), 0.025, 1e-12);
  EXPECT_NEAR(told->friction_95_nm(), 0.3 * 0.01 + 0.1 * 0.025, 1e-12);
  EXPECT_EQ(told->torque_nm(), 0.0);
  EXPECT_EQ(told->eta(), 0.0);
}

TEST(Pretension, IsToldOfNoLawWithoutTendonsOrFriction) {
  JointFile joint = tendons();
  joint.parameters.shapes[joint.catalogue->term(kTendonModel).first_shape + 2] = 0.0;
  EXPECT_FALSE(pretension_of(joint, true));
  joint.terms = {"motor_angle"};
  EXPECT_FALSE(pretension_of(joint, true));
}

TEST(Newtons, TakeTheRadius) {
  JointFile joint = tendons();
  joint.fit->pretension = pretension_of(joint, true);
  put_into_newtons({.radius_m = 0.005}, joint);
  EXPECT_NEAR(joint.fit->pretension->force_n(), 0.05 / 0.005, 1e-9);
  EXPECT_NEAR(joint.fit->pretension->force_95_n() / joint.fit->pretension->force_n(), 0.015 * std::sqrt(2.0), 1e-9);
  EXPECT_TRUE(has(pretension_sentence(*joint.fit->pretension), "pretension is 10 "));
}

TEST(Newtons, TakeTheStiffnessWhereTheRadiusIsNotKnown) {
  // r1^2 = 2 / (K (c_t + c_b)), and c_t + c_b = 2 / 0.5 rad/Nm: with 2000 N/m it is 1 / 4000 m2.
  JointFile joint = tendons();
  joint.fit->pretension = pretension_of(joint, true);
  put_into_newtons({.stiffness_n_per_m = 2000.0}, joint);
  const double radius = std::sqrt(1.0 / 4000.0);
  EXPECT_NEAR(joint.fit->pretension->radius_m(), radius, 1e-12);
  EXPECT_NEAR(joint.fit->pretension->force_n(), 0.05 / radius, 1e-9);
  // A free tip does not know the compliance apart from the rest.
  JointFile free = tendons();
  free.fit->pretension = pretension_of(free, false);
  put_into_newtons({.stiffness_n_per_m = 2000.0}, free);
  EXPECT_EQ(free.fit->pretension->radius_m(), 0.0);
  put_into_newtons({.radius_m = 0.005}, free);  // the radius is kept for a later log
  EXPECT_EQ(free.fit->pretension->radius_m(), 0.005);
  EXPECT_EQ(free.fit->pretension->force_n(), 0.0);
}

TEST(Newtons, StayOutWithoutADrawingOrAPretension) {
  JointFile joint = tendons();
  put_into_newtons({.radius_m = 0.005}, joint);
  EXPECT_FALSE(joint.fit->pretension);
  joint.fit->pretension = pretension_of(joint, true);
  put_into_newtons({}, joint);
  EXPECT_EQ(joint.fit->pretension->force_n(), 0.0);
}

TEST(PretensionSentence, SaysWhatIsLacking) {
  JointFile joint = tendons();
  EXPECT_TRUE(
      has(pretension_sentence(*pretension_of(joint, false)), "pulls each tendon slack in turn, and give the radius"));
  EXPECT_TRUE(has(pretension_sentence(*pretension_of(joint, true)), "--stiffness N/m)"));
}

/// The joint with its loop, 0.1 rad to either side.
auto with_loop(JointFile joint, double torque_nm, bool held) -> JointFile {
  joint.steady_torque = SteadyTorque{torque_nm, -torque_nm};
  joint.fit->loop_half_width = 0.1;
  joint.fit->loop_torque = torque_nm;
  joint.fit->pretension = pretension_of(joint, held);
  return joint;
}

/// The healthy joint: 0.04 Nm, of which 0.025 are the tendons' and 0.005 the joint's own.
auto healthy(bool held) -> JointFile {
  return with_loop(tendons(), 0.04, held);
}

/// The loop of another pretension: torque c + F + L, width k (F + 2 L).
auto loop_at(double times) -> Loop {
  return {0.1 * (0.025 * times + 2.0 * 0.005) / (0.025 + 2.0 * 0.005), 0.04 + 0.025 * (times - 1.0)};
}

TEST(PretensionDrift, IsTheChangeOfTheTendonsFriction) {
  for (const double times : {0.6, 1.0, 1.5}) {
    const auto drift = pretension_drift(healthy(true), loop_at(times), std::nullopt);
    ASSERT_TRUE(drift) << times;
    EXPECT_NEAR(drift->times.value, times, 1e-9);
    EXPECT_EQ(drift->unit, "Nm");
    EXPECT_NEAR(drift->pretension.value, 0.05 * times, 1e-9);
    EXPECT_NEAR(drift->change.value, 0.05 * (times - 1.0), 1e-9);
    EXPECT_GT(drift->times.half, 0.0);
  }
}

TEST(PretensionDrift, IsInNewtonsWhereTheRadiusIsKnownAndARatioWhereTheTipWasFree) {
  JointFile joint = healthy(true);
  put_into_newtons({.radius_m = 0.005}, joint);
  const auto newtons = pretension_drift(joint, loop_at(0.8), std::nullopt);
  ASSERT_TRUE(newtons);
  EXPECT_EQ(newtons->unit, "N");
  EXPECT_NEAR(newtons->pretension.value, 8.0, 1e-9);
  EXPECT_TRUE(has(drift_sentence(*newtons), "2 ["));
  EXPECT_TRUE(has(drift_sentence(*newtons), "N less than the healthy joint's"));
  const auto ratio = pretension_drift(healthy(false), loop_at(1.2), std::nullopt);
  ASSERT_TRUE(ratio);
  EXPECT_EQ(ratio->unit, "1");
  EXPECT_NEAR(ratio->pretension.value, 1.2, 1e-9);
  EXPECT_TRUE(has(drift_sentence(*ratio), "120 ["));
}

TEST(PretensionDrift, IsNoneWhereWidthAndTorqueDoNotGoTogether) {
  const JointFile joint = healthy(true);
  Loop gap = loop_at(1.0);
  gap.half_width_rad *= 1.2;  // a gap takes no torque
  EXPECT_FALSE(pretension_drift(joint, gap, std::nullopt));
  Loop drag = loop_at(1.0);
  drag.torque_nm += 0.02;  // which the tendons do not carry
  EXPECT_FALSE(pretension_drift(joint, drag, std::nullopt));
  EXPECT_FALSE(pretension_drift(joint, {0.1, 0.01}, std::nullopt));  // less than nothing would be left
}

/// A joint whose tendons have friction numbers of 1.2: 60 mNm of 75, 5 of them the joint's own.
auto rubbing(bool held) -> JointFile {
  JointFile joint = tendons();
  for (std::size_t tendon = 0; tendon < 2; ++tendon) {
    joint.parameters.shapes[joint.catalogue->term(kTendonModel).first_shape + tendon] = 1.2;
  }
  return with_loop(joint, 0.075, held);
}

/// Its loop with 1.7 times the tendons' friction: by pretension, or by the friction number, whose stretch per torque is
/// tanh(eta / 2) / eta.
auto rubbing_loop(bool by_number) -> Loop {
  const double stretch = by_number ? (std::tanh(0.6 * 1.7) / (1.2 * 1.7)) / (std::tanh(0.6) / 1.2) : 1.0;
  return {0.1 * stretch * (0.06 * 1.7 + 2.0 * 0.005) / (0.06 + 2.0 * 0.005), 0.075 + 0.06 * 0.7};
}

TEST(FrictionNumberDrift, IsToldFromThePretensionByTheWidthThatItDoesNotBring) {
  const JointFile joint = rubbing(true);
  const auto eta = friction_number_drift(joint, rubbing_loop(true));
  ASSERT_TRUE(eta);
  EXPECT_NEAR(eta->value, 1.7, 1e-9);
  EXPECT_GT(eta->half, 0.0);
  EXPECT_FALSE(pretension_drift(joint, rubbing_loop(true), std::nullopt));
  EXPECT_TRUE(has(friction_number_sentence(*joint.fit->pretension, *eta), "friction number is 2.04 ["));
  EXPECT_FALSE(friction_number_drift(joint, rubbing_loop(false)));
  EXPECT_TRUE(pretension_drift(joint, rubbing_loop(false), std::nullopt));
}

TEST(FrictionNumberDrift, IsNoneWhereTheTipWasFreeOrNothingRubsOtherwise) {
  EXPECT_FALSE(friction_number_drift(rubbing(false), rubbing_loop(true)));
  EXPECT_FALSE(friction_number_drift(rubbing(true), {0.1, 0.075}));
  EXPECT_FALSE(friction_number_drift(rubbing(true), {0.15, 0.075})) << "a gap";
}

TEST(PretensionDrift, OfALawWithoutALoopIsNone) {
  JointFile joint = healthy(true);
  joint.steady_torque.reset();
  EXPECT_FALSE(pretension_drift(joint, loop_at(1.2), std::nullopt));
}

TEST(PretensionDrift, TwoWaysToMeasureTheTorqueThatDisagreeWidenItsInterval) {
  JointFile joint = healthy(true);
  joint.fit->torque = TorqueParts{{0.04}};
  const auto agree = pretension_drift(joint, loop_at(1.2), TorqueParts{{0.045}});
  const auto differ = pretension_drift(joint, loop_at(1.2), TorqueParts{{0.055}});
  ASSERT_TRUE(agree && differ);
  EXPECT_NEAR(differ->times.half, std::hypot(agree->times.half, 0.01 / 0.025), 1e-9);
}

}  // namespace
}  // namespace capstan::tools
