// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/long_rests.hpp"

#include <gtest/gtest.h>

#include <cmath>

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

/// The log with so many rows before one in which everything stays as it is in that one.
auto with_rest(AxisLog log, Eigen::Index before, Eigen::Index rows) -> AxisLog {
  for_each_signal(log, [before, rows](Eigen::VectorXd& signal) {
    if (signal.size() > 0) {
      Eigen::VectorXd longer(rows + signal.size());
      longer << signal.head(before), Eigen::VectorXd::Constant(rows, signal[before]),
          signal.tail(signal.size() - before);
      signal = std::move(longer);
    }
  });
  log.time_s = Eigen::VectorXd::LinSpaced(log.samples(), 0.0, static_cast<double>(log.samples() - 1) * log.period_s);
  return log;
}

auto after_rest(const AxisLog& log, Eigen::Index rows) -> AxisLog {
  return with_rest(log, 0, rows);
}

TEST(LongRests, AreNoRowsToLeaveOutWhereTheAnswerGoesByTime) {
  Diagnosis d;
  EXPECT_FALSE(goes_by_time(d));
  d.rounds.emplace_back();
  d.rounds.back().ranking.emplace_back().name = "play";
  EXPECT_FALSE(goes_by_time(d));
  d.rounds.emplace_back();
  d.rounds.back().ranking.emplace_back().name = "wander";
  EXPECT_TRUE(goes_by_time(d));
  d.rounds.clear();
  d.law.terms = {"motor_angle", "thermal_drift"};
  EXPECT_TRUE(goes_by_time(d));
}

TEST(LongRests, AreCutButForATwentiethOfTheMotion) {
  const AxisLog moving = moving_log();
  const AxisLog log = after_rest(moving, 4000);
  const AxisLog cut = without_long_rests(log);
  const auto kept = static_cast<double>(cut.samples() - moving.samples());
  EXPECT_NEAR(kept, 0.05 * static_cast<double>(moving.samples()), 30.0);
  EXPECT_EQ(cut.q2_rad.tail(moving.samples()), moving.q2_rad);
  EXPECT_EQ(cut.time_s[cut.samples() - 1], log.time_s[log.samples() - 1]) << "times stay those of the file";
  ASSERT_EQ(cut.warnings.size(), log.warnings.size() + 1);
  EXPECT_NE(cut.warnings.back().find("nothing moves for 7"), std::string::npos) << cut.warnings.back();
}

TEST(LongRests, AreCutWithinALogAndAtItsEnd) {
  const AxisLog moving = moving_log();
  const Eigen::Index half = moving.samples() / 2;
  const AxisLog log = with_rest(with_rest(moving, moving.samples() - 1, 3000), half, 4000);
  const AxisLog cut = without_long_rests(log);
  const auto kept = static_cast<double>(cut.samples() - moving.samples());
  EXPECT_NEAR(kept, 2 * 0.05 * static_cast<double>(moving.samples()), 60.0);
  EXPECT_EQ(cut.q2_rad.head(half), moving.q2_rad.head(half));
  EXPECT_GT((cut.time_s.tail(cut.samples() - 1) - cut.time_s.head(cut.samples() - 1)).maxCoeff(), 50.0)
      << "times stay those of the file";
  EXPECT_EQ(cut.warnings.size(), log.warnings.size() + 1);
}

// So slow that each rest, as far as it may go to and fro, reaches into the next one.
TEST(LongRests, OfAMotorThatCrawlsDoNotOverlap) {
  const AxisLog moving = moving_log();
  AxisLog log = with_rest(moving, moving.samples() / 2, 4000);
  const double range = moving.q1_rad.maxCoeff() - moving.q1_rad.minCoeff();
  log.q1_rad.segment(moving.samples() / 2, 4000) += Eigen::VectorXd::LinSpaced(4000, 0.0, 5e-4 * range);
  const AxisLog cut = without_long_rests(log);
  EXPECT_LT(cut.samples(), log.samples());
  EXPECT_GE(cut.samples(), moving.samples());
  for (Eigen::Index i = 0; i < cut.samples(); ++i) {
    const auto row = static_cast<Eigen::Index>(std::lround(cut.time_s[i] / log.period_s));
    ASSERT_EQ(cut.q1_rad[i], log.q1_rad[row]) << i;
    ASSERT_TRUE(i == 0 || cut.time_s[i] > cut.time_s[i - 1]) << i;
  }
}

TEST(LongRests, AreNoneWhereTheJointCreeps) {
  const AxisLog moving = moving_log();
  AxisLog log = with_rest(moving, moving.samples() / 2, 4000);
  const double range = moving.q2_rad.maxCoeff() - moving.q2_rad.minCoeff();
  log.q2_rad.segment(moving.samples() / 2, 4000) += Eigen::VectorXd::LinSpaced(4000, 0.0, 0.02 * range);
  EXPECT_EQ(without_long_rests(log).samples(), log.samples());
}

TEST(LongRests, AreNoneInALogThatMoves) {
  const AxisLog log = moving_log();
  const AxisLog cut = without_long_rests(log);
  EXPECT_EQ(cut.samples(), log.samples());
  EXPECT_EQ(cut.warnings, log.warnings);
}

TEST(LongRests, EndWhereAnotherMotorOrTheJointMoves) {
  const AxisLog log = after_rest(moving_log(), 4000);
  AxisLog pulled = log;
  pulled.others.push_back({1, Eigen::VectorXd::LinSpaced(log.samples(), 0.0, 1.0), log.tau_nm});
  EXPECT_EQ(without_long_rests(pulled).samples(), log.samples());
  AxisLog pressed = log;
  pressed.q2_rad.head(4000) += Eigen::VectorXd::LinSpaced(4000, 0.0, 10.0);
  EXPECT_EQ(without_long_rests(pressed).samples(), log.samples());
}

TEST(LongRests, StayWhereAnEffortSaysSomething) {
  AxisLog log = after_rest(moving_log(), 4000);
  log.effort = std::exchange(log.q2_rad, {});
  for (const bool has_torque : {false, true}) {
    log.has_torque = has_torque;
    EXPECT_EQ(without_long_rests(log).samples(), log.samples());
  }
}

TEST(LongRests, OfAMotorThatNeverMovesIsLeftToOthersToSay) {
  AxisLog log = moving_log();
  log.q1_rad.setConstant(0.3);
  log.q2_rad.setConstant(0.1);
  EXPECT_EQ(without_long_rests(log).samples(), log.samples());
}

TEST(LongRests, ChangeNoVerdict) {
  const AxisLog moving = moving_log();
  const Diagnosis plain = diagnose({moving}, {});
  ASSERT_EQ(plain.effects.size(), 1U);
  for (const Eigen::Index before : {Eigen::Index{0}, moving.samples() / 3}) {
    const Diagnosis rested = diagnose({with_rest(moving, before, 2 * moving.samples())}, {});
    EXPECT_STREQ(verdict_word(rested.verdict), verdict_word(plain.verdict)) << rested.reason;
    ASSERT_EQ(rested.effects.size(), 1U) << rested.reason;
    EXPECT_EQ(rested.effects[0].name, plain.effects[0].name);
    EXPECT_LT(rested.after.rmse, 1.05 * plain.after.rmse);
    if (before == 0) {  // behind a rest the same rows are judged on
      EXPECT_GT(rested.after.rmse, 0.95 * plain.after.rmse);
    }
  }
}

}  // namespace
}  // namespace capstan::tools
