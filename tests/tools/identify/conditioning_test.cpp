// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/conditioning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace capstan::tools {
namespace {

/// A motor that goes to and fro between 0 and 2 rad, 2 mrad a sample.
auto triangle(Eigen::Index rows) -> Eigen::VectorXd {
  Eigen::VectorXd q1(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Eigen::Index in_cycle = i % 2000;
    q1[i] = 0.002 * static_cast<double>(in_cycle < 1000 ? in_cycle : 2000 - in_cycle);
  }
  return q1;
}

auto quantised(const Eigen::VectorXd& q1, double step) -> Eigen::VectorXd {
  return (q1.array() / step + 1e-9).floor() * step;
}

auto log_of(const Eigen::VectorXd& q1) -> AxisLog {
  AxisLog log;
  log.period_s = 0.01;
  log.time_s = Eigen::VectorXd::LinSpaced(q1.size(), 0.0, 0.01 * static_cast<double>(q1.size() - 1));
  log.q1_rad = q1;
  log.tau_nm = Eigen::VectorXd::Zero(q1.size());
  return log;
}

TEST(MovingMean, ByHandAndWithinEachLog) {
  Eigen::MatrixXd column(7, 1);
  column << 1, 2, 6, 4, 100, 200, 600;  // logs of four and three rows
  const Eigen::MatrixXd means = moving_mean(column, {4, 3}, 2);
  const double expected[] = {1, 3, 4, 4, 100, 300, 600};  // as many neighbours as there are to both sides
  for (Eigen::Index i = 0; i < 7; ++i) {
    EXPECT_NEAR(means(i, 0), expected[i], 1e-12) << i;
  }
  EXPECT_EQ(moving_mean(column, {4, 3}, 0), column);
}

TEST(Decimated, IsTheMeanOfSoManyRows) {
  Eigen::MatrixXd columns(4, 2);
  columns << 1, 10, 3, 30, 5, 50, 9, 90;
  const Eigen::MatrixXd coarse = decimated(columns, 2);
  ASSERT_EQ(coarse.rows(), 2);
  EXPECT_EQ(coarse(0, 0), 2.0);
  EXPECT_EQ(coarse(1, 1), 70.0);
  EXPECT_EQ(decimated(columns, 1), columns);
}

TEST(DirectionChanges, AreTheSamplesThatTurn) {
  Samples samples(6);
  for (const std::size_t i : {2, 3, 5}) {
    samples[i].forward = false;
  }
  EXPECT_EQ(direction_changes(samples), (std::vector<std::size_t>{2, 4, 5}));
  EXPECT_TRUE(direction_changes({}).empty());
}

TEST(AngleNoise, OfAnEncoderIsItsStepAndOfAnAnalogueSensorItsDeviation) {
  const AngleNoise encoder = motor_angle_noise({log_of(quantised(triangle(4000), 0.01))});
  EXPECT_NEAR(encoder.step_rad, 0.01, 1e-9);
  Eigen::VectorXd noisy = triangle(4000);
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal(0.0, 0.003);
  for (double& value : noisy) {
    value += normal(engine);
  }
  const AngleNoise analogue = motor_angle_noise({log_of(triangle(4000)), log_of(noisy)});  // the worse of the logs
  EXPECT_NEAR(analogue.white_rad, 0.003, 0.0003);
}

TEST(DirectionThresholds, AreThreeQuartersOfAStepWhereNoEdgeTrembles) {
  const std::vector<AxisLog> logs = {log_of(quantised(triangle(4000), 0.01))};
  const auto thresholds = direction_thresholds(logs, motor_angle_noise(logs));
  ASSERT_EQ(thresholds.size(), 3u);  // 0.04 is 2 % of the motion
  EXPECT_NEAR(thresholds[0], 0.0075, 1e-9);
  EXPECT_NEAR(thresholds[1], 0.015, 1e-9);
  EXPECT_NEAR(thresholds[2], 0.03, 1e-9);
}

TEST(DirectionThresholds, AreAStepAndAHalfWhereOneDoesOrTooFewWereCrossedToKnow) {
  Eigen::VectorXd trembling = quantised(triangle(4000), 0.01);
  trembling[503] -= 0.01;  // one count back, and on again
  std::vector<AxisLog> logs = {log_of(trembling)};
  EXPECT_NEAR(direction_thresholds(logs, {.step_rad = 0.01}).front(), 0.015, 1e-9);
  logs = {log_of(quantised(triangle(400), 0.01))};  // 79 edges
  EXPECT_NEAR(direction_thresholds(logs, {.step_rad = 0.01}).front(), 0.015, 1e-9);
}

TEST(DirectionThresholds, AreEightDeviationsOfNoiseAndNeverMoreThanTwoPercentOfTheMotion) {
  const std::vector<AxisLog> logs = {log_of(triangle(4000))};
  const auto thresholds = direction_thresholds(logs, {.white_rad = 0.001});
  EXPECT_NEAR(thresholds.front(), 0.008, 1e-12);
  EXPECT_LT(thresholds.back(), 0.04);
  const auto coarse = direction_thresholds(logs, {.white_rad = 0.1});
  ASSERT_EQ(coarse.size(), 1u);
  EXPECT_NEAR(coarse.front(), 0.04, 1e-12);
  // An encoder's steps show as noise of the third difference: they are counted once.
  EXPECT_NEAR(direction_thresholds({log_of(triangle(400))}, {.step_rad = 0.01, .white_rad = 0.004}).front(), 0.015,
              1e-9);
}

TEST(CausalSamples, SeeTheOtherAxesInTheirSlotsAndTheWarmth) {
  AxisLog log = log_of(triangle(3000));
  log.temperature_c = Eigen::VectorXd::Constant(3000, 30.0);
  OtherAxis other;
  other.q1_rad = -triangle(3000);
  other.tau_nm = Eigen::VectorXd::Constant(3000, 0.7);
  log.others.assign(kMostOthers + 1, other);  // one more than there are slots
  const Samples samples = causal_samples(log, {});
  EXPECT_NEAR(samples[500].warmth, 5.0, 1e-12);
  EXPECT_EQ(samples[500].others[0].tau, 0.7);
  EXPECT_TRUE(samples[500].forward);
  EXPECT_FALSE(samples[500].others[2].forward);  // it goes the other way
  EXPECT_TRUE(samples[1500].others[2].forward);
}

TEST(CausalSamples, KnowTheJointAsTheUsualLawHasItAndNotAsItWasMeasured) {
  AxisLog log = log_of(triangle(4000));
  log.q2_rad = (0.5 + 0.8 * log.q1_rad.array()).matrix();
  log.q2_rad[1234] += 3.0;  // what a law is to predict must not be told to it
  const Samples samples = causal_samples(log, {});
  EXPECT_NEAR(samples[1234].q2, 0.5 + 0.8 * log.q1_rad[1234], 0.02);
  EXPECT_NEAR(samples[3000].q2, 0.5 + 0.8 * log.q1_rad[3000], 0.02);
}

}  // namespace
}  // namespace capstan::tools
