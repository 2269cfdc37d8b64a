// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/log_zeros.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/synthetic_joint.hpp"
#include "capstan/tools/identify/law_fit.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools {
namespace {

auto log_of(test::Truth truth, std::uint64_t seed, double zero = 0.0) -> AxisLog {
  test::SyntheticRequest request;
  request.truth = truth;
  request.rate_hz = 100.0;
  request.cycle_s = 25.0;
  request.seed = seed;
  AxisLog log = test::synthetic_log(request);
  log.q2_rad.array() += zero;
  return log;
}

auto nothing_left(const std::vector<AxisLog>& logs) -> Eigen::VectorXd {
  return Eigen::VectorXd::Zero(stacked_target(logs).size());
}

TEST(LogZeros, AreFoundWithinTheirIntervalsWhateverTheJointHas) {
  for (const auto truth : {test::Truth::kNone, test::Truth::kPlay, test::Truth::kPretension, test::Truth::kDelay}) {
    const auto zeros = log_zeros({log_of(truth, 1), log_of(truth, 2, 0.02), log_of(truth, 3, -0.3)});
    ASSERT_EQ(zeros.size(), 3U);
    EXPECT_EQ(zeros[0].shift, 0.0);
    EXPECT_NEAR(zeros[1].shift, 0.02, 2e-3) << test::truth_name(truth);
    EXPECT_NEAR(zeros[2].shift, -0.3, 2e-3) << test::truth_name(truth);
    EXPECT_TRUE(zeros[1].is_certain() && zeros[2].is_certain());
  }
}

TEST(LogZeros, ThatAreTheSameStayAsTheyAre) {
  for (const auto truth : {test::Truth::kNone, test::Truth::kPlay, test::Truth::kCreep}) {
    std::vector<AxisLog> logs = {log_of(truth, 1), log_of(truth, 2)};
    const Eigen::VectorXd before = logs[1].q2_rad;
    EXPECT_TRUE(count_from_one_zero(logs, nothing_left).empty()) << test::truth_name(truth);
    EXPECT_EQ(logs[1].q2_rad, before);
  }
}

TEST(LogZeros, AreTakenOffByTheRoughLawAndThenByWhatTheFoundOneLeaves) {
  const AxisLog plain = log_of(test::Truth::kPlay, 2);
  std::vector<AxisLog> logs = {log_of(test::Truth::kPlay, 1), log_of(test::Truth::kPlay, 2, 0.1)};
  const auto left = [&plain](const std::vector<AxisLog>& all) {
    Eigen::VectorXd residual = nothing_left(all);
    residual.tail(plain.samples()) = all[1].q2_rad - plain.q2_rad;  // as a law without an error of its own
    return residual;
  };
  const auto sentences = count_from_one_zero(logs, left);
  ASSERT_EQ(sentences.size(), 1U);
  EXPECT_NE(sentences[0].find("the joint's zero is 0.1 rad away from the first log's"), std::string::npos);
  EXPECT_LT((logs[1].q2_rad - plain.q2_rad).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(LogZeros, OfALogWithTheTipHeldAreNotAsked) {
  AxisLog held = log_of(test::Truth::kPlay, 2, 0.1);
  held.q2_rad = (0.05 * held.q2_rad.array()).matrix();
  std::vector<AxisLog> logs = {log_of(test::Truth::kPlay, 1), held, log_of(test::Truth::kPlay, 3, 0.2)};
  const auto sentences = count_from_one_zero(logs, nothing_left);
  EXPECT_EQ(logs[1].q2_rad, held.q2_rad);
  EXPECT_EQ(sentences.size(), 1U);
  EXPECT_NEAR(logs[2].q2_rad[0], log_of(test::Truth::kPlay, 3).q2_rad[0], 2e-3);
}

TEST(LogZeros, OfAMotorThatBeganElsewhereAreTakenOffTheJoint) {
  AxisLog second = log_of(test::Truth::kPlay, 2);
  second.q1_rad.array() += 30.0;
  const auto zeros = log_zeros({log_of(test::Truth::kPlay, 1), second});
  const auto prompt = log_zeros({log_of(test::Truth::kPlay, 1), log_of(test::Truth::kPlay, 2)});
  const double ratio = zeros[1].shift / -30.0;
  EXPECT_NEAR(ratio, 1.1, 0.2) << "the joint turns by its ratio";
  EXPECT_FALSE(prompt[1].is_certain());
}

/// A joint of inertia, drag, dry friction and a weight about a middle angle.
auto effort_log(std::uint64_t seed, double zero, double middle = 0.0) -> AxisLog {
  constexpr Eigen::Index kRows = 6000;
  AxisLog log;
  log.name = "log" + std::to_string(seed) + ".csv";
  log.target = "axis0/tau_Nm";
  log.period_s = 0.005;
  log.time_s = log.q1_rad = log.effort = Eigen::VectorXd::Zero(kRows);
  log.tau_nm = Eigen::VectorXd::Zero(kRows);
  Random random(seed);
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double t = log.period_s * static_cast<double>(i);
    log.time_s[i] = t;
    log.q1_rad[i] = middle + 0.9 * std::sin(1.3 * t) + 0.4 * std::sin(4.1 * t);
    const double speed = 1.17 * std::cos(1.3 * t) + 1.64 * std::cos(4.1 * t);
    const double acceleration = -1.521 * std::sin(1.3 * t) - 6.724 * std::sin(4.1 * t);
    log.effort[i] = 2e-3 * acceleration + 0.01 * speed + std::copysign(0.05, speed) + 0.1 * std::sin(log.q1_rad[i]) +
                    zero + 2e-3 * random.normal();
  }
  return log;
}

TEST(LogZeros, OfAnEffortAreTakenOff) {
  std::vector<AxisLog> logs = {effort_log(1, 0.0), effort_log(2, 0.02), effort_log(3, 0.0)};
  const Eigen::VectorXd same = logs[2].effort;
  const auto sentences = count_from_one_zero(logs, nothing_left);
  ASSERT_EQ(sentences.size(), 1U);
  EXPECT_NE(sentences[0].find("log2.csv: axis0/tau_Nm's zero is 0.0"), std::string::npos) << sentences[0];
  EXPECT_LT((logs[1].effort - effort_log(2, 0.0).effort).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_EQ(logs[2].effort, same);
}

TEST(LogZeros, OfAnEffortAreNotAskedWhereItsWeightHangsElsewhere) {
  std::vector<AxisLog> logs = {effort_log(1, 0.0), effort_log(2, 0.0, 1.5)};
  const Eigen::VectorXd before = logs[1].effort;
  EXPECT_TRUE(count_from_one_zero(logs, nothing_left).empty());
  EXPECT_EQ(logs[1].effort, before);
}

}  // namespace
}  // namespace capstan::tools
