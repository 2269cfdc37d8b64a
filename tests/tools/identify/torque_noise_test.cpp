// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/torque_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "capstan/tools/identify/identify.hpp"

namespace capstan::tools {
namespace {

constexpr Eigen::Index kRows = 4000;

auto white(double level, std::uint64_t seed) -> Eigen::VectorXd {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::VectorXd::NullaryExpr(kRows, [&]() { return level * normal(random); });
}

/// Torque that turns round with a motion of 0.4 Hz, at 100 Hz.
auto torque_that_jumps() -> Eigen::VectorXd {
  return Eigen::VectorXd::NullaryExpr(
      kRows, [](Eigen::Index i) { return std::copysign(0.1, std::sin(0.0251 * static_cast<double>(i) + 0.3)); });
}

TEST(TorqueNoise, IsThatOfWhiteNoiseAndNoneOfJumps) {
  EXPECT_EQ(torque_noise_level(torque_that_jumps()), 0.0);
  EXPECT_NEAR(torque_noise_level(torque_that_jumps() + white(0.004, 1)), 0.004, 0.0003);
  EXPECT_EQ(torque_noise_level(Eigen::VectorXd::Zero(3)), 0.0) << "nothing can be told of three rows";
}

/// A joint whose tendons stretch alike both ways, and a torque of which it knows only part.
auto log_with(const Eigen::VectorXd& known_nm, const Eigen::VectorXd& noise_nm) -> AxisLog {
  AxisLog log;
  log.name = "drawn";
  log.target = "axis0/q2_rad";
  log.period_s = 0.01;
  log.has_torque = true;
  log.time_s = 0.01 * Eigen::VectorXd::LinSpaced(kRows, 0.0, static_cast<double>(kRows - 1));
  log.q1_rad = log.time_s.unaryExpr([](double t) { return std::sin(1.3 * t) + 0.4 * std::sin(2.9 * t); });
  log.tau_nm = known_nm + noise_nm;
  log.q2_rad = 0.9 * log.q1_rad - 0.5 * known_nm + white(0.001, 5);
  return log;
}

auto interval_of(const JointFile& law, const char* term) -> std::optional<Interval> {
  return law.coefficient_ci95[law.catalogue->term(term).first_coefficient];
}

TEST(TorqueNoise, ATorqueThatIsHardlyMoreThanNoiseTellsNoElongation) {
  LawForm form;
  form.terms = {"motor_angle", "tendon_elongation"};
  const JointFile law = identify({log_with(Eigen::VectorXd::Zero(kRows), white(0.01, 3))}, form).joint;
  EXPECT_FALSE(interval_of(law, "tendon_elongation"));
  const auto beta = interval_of(law, "motor_angle");
  ASSERT_TRUE(beta);
  EXPECT_LE((*beta)[0], 0.9);
  EXPECT_GE((*beta)[1], 0.9);
}

TEST(TorqueNoise, ACleanTorqueWidensNothing) {
  LawForm form;
  form.terms = {"motor_angle", "tendon_elongation"};
  const Eigen::VectorXd known = Eigen::VectorXd::NullaryExpr(
      kRows, [](Eigen::Index i) { return 0.1 * std::sin(0.017 * static_cast<double>(i)); });
  const auto top =
      interval_of(identify({log_with(known, Eigen::VectorXd::Zero(kRows))}, form).joint, "tendon_elongation");
  ASSERT_TRUE(top);
  EXPECT_LE((*top)[0], -0.5);
  EXPECT_GE((*top)[1], -0.5);
  EXPECT_LT((*top)[1] - (*top)[0], 0.01);
}

}  // namespace
}  // namespace capstan::tools
