// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/leading_rest.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/tools/synthetic_joint.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools {
namespace {

using test::Truth;

auto moving_log() -> AxisLog {
  test::SyntheticRequest request;
  request.truth = Truth::kPlay;
  request.rate_hz = 50.0;
  request.cycle_s = 25.0;
  return test::synthetic_log(request);
}

/// The log behind so many rows in which everything stays as it is in its first one.
auto after_rest(AxisLog log, Eigen::Index rows) -> AxisLog {
  for_each_signal(log, [rows](Eigen::VectorXd& signal) {
    if (signal.size() > 0) {
      Eigen::VectorXd longer(rows + signal.size());
      longer << Eigen::VectorXd::Constant(rows, signal[0]), signal;
      signal = std::move(longer);
    }
  });
  log.time_s = Eigen::VectorXd::LinSpaced(log.samples(), 0.0, static_cast<double>(log.samples() - 1) * log.period_s);
  return log;
}

TEST(LeadingRest, IsCutButForATwentiethOfWhatFollows) {
  const AxisLog moving = moving_log();
  const AxisLog log = after_rest(moving, 4000);
  const AxisLog cut = without_leading_rest(log);
  const auto kept = static_cast<double>(cut.samples() - moving.samples());
  EXPECT_NEAR(kept, 0.05 * static_cast<double>(moving.samples()), 30.0);
  EXPECT_EQ(cut.q2_rad.tail(moving.samples()), moving.q2_rad);
  EXPECT_EQ(cut.time_s[cut.samples() - 1], log.time_s[log.samples() - 1]) << "times stay those of the file";
  ASSERT_EQ(cut.warnings.size(), log.warnings.size() + 1);
  EXPECT_NE(cut.warnings.back().find("nothing moves in the first 7"), std::string::npos) << cut.warnings.back();
}

TEST(LeadingRest, IsNoneInALogThatBeginsToMove) {
  const AxisLog log = moving_log();
  const AxisLog cut = without_leading_rest(log);
  EXPECT_EQ(cut.samples(), log.samples());
  EXPECT_EQ(cut.warnings, log.warnings);
}

TEST(LeadingRest, EndsWhereAnotherMotorOrTheJointMoves) {
  const AxisLog log = after_rest(moving_log(), 4000);
  AxisLog pulled = log;
  pulled.others.push_back({1, Eigen::VectorXd::LinSpaced(log.samples(), 0.0, 1.0), log.tau_nm});
  EXPECT_EQ(without_leading_rest(pulled).samples(), log.samples());
  AxisLog pressed = log;
  pressed.q2_rad.head(4000) += Eigen::VectorXd::LinSpaced(4000, 0.0, 10.0);
  EXPECT_EQ(without_leading_rest(pressed).samples(), log.samples());
}

TEST(LeadingRest, StaysWhereAnEffortSaysSomething) {
  AxisLog log = after_rest(moving_log(), 4000);
  log.effort = std::exchange(log.q2_rad, {});
  for (const bool has_torque : {false, true}) {
    log.has_torque = has_torque;
    EXPECT_EQ(without_leading_rest(log).samples(), log.samples());
  }
}

TEST(LeadingRest, OfAMotorThatNeverMovesIsLeftToOthersToSay) {
  AxisLog log = moving_log();
  log.q1_rad.setConstant(0.3);
  log.q2_rad.setConstant(0.1);
  EXPECT_EQ(without_leading_rest(log).samples(), log.samples());
}

TEST(LeadingRest, ChangesNoVerdict) {
  const AxisLog moving = moving_log();
  const Diagnosis plain = diagnose({moving}, {});
  ASSERT_EQ(plain.effects.size(), 1U);
  const Diagnosis rested = diagnose({after_rest(moving, 2 * moving.samples())}, {});
  EXPECT_STREQ(verdict_word(rested.verdict), verdict_word(plain.verdict)) << rested.reason;
  ASSERT_EQ(rested.effects.size(), 1U) << rested.reason;
  EXPECT_EQ(rested.effects[0].name, plain.effects[0].name);
  EXPECT_NEAR(rested.after.rmse, plain.after.rmse, 0.05 * plain.after.rmse);
}

}  // namespace
}  // namespace capstan::tools
