// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/log_zeros.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/tools/synthetic_joint.hpp"
#include "capstan/tools/identify/law_fit.hpp"

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
    EXPECT_EQ(zeros[0].shift_rad, 0.0);
    EXPECT_NEAR(zeros[1].shift_rad, 0.02, 2e-3) << test::truth_name(truth);
    EXPECT_NEAR(zeros[2].shift_rad, -0.3, 2e-3) << test::truth_name(truth);
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
  EXPECT_NE(sentences[0].find("the joint's zero is 0.1 rad beside that of the first log"), std::string::npos);
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
  const double ratio = zeros[1].shift_rad / -30.0;
  EXPECT_NEAR(ratio, 1.1, 0.2) << "the joint turns by its ratio";
  EXPECT_FALSE(prompt[1].is_certain());
}

}  // namespace
}  // namespace capstan::tools
