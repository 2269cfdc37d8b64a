// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/recordings.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/tools/log/small_log.hpp"

namespace capstan::tools {
namespace {

using namespace test;

auto axis_of(const VectorXd& q1) -> AxisLog {
  AxisLog log;
  log.name = "run.csv";
  log.period_s = kPeriod;
  log.time_s = VectorXd::LinSpaced(q1.size(), 0.0, kPeriod * static_cast<double>(q1.size() - 1));
  log.q1_rad = q1;
  log.q2_rad = 0.8 * q1;
  log.tau_nm = VectorXd::Zero(q1.size());
  return log;
}

auto rows_of(const std::vector<AxisLog>& recordings) -> std::vector<Index> {
  std::vector<Index> rows;
  for (const auto& one : recordings) {
    rows.push_back(one.samples());
  }
  return rows;
}

TEST(Recordings, AnotherBeginsWhereTheMotorIsSomewhereElse) {
  const Log log;
  for (const double away : {0.5, -3.0, 1e3}) {
    VectorXd q1 = log.q1;
    q1.tail(kRows - 1500).array() += away;
    const auto recordings = recordings_in(axis_of(q1));
    EXPECT_EQ(rows_of(recordings), (std::vector<Index>{1500, kRows - 1500})) << away;
    ASSERT_EQ(recordings.front().warnings.size(), 1U);
    EXPECT_NE(recordings.front().warnings[0].find("run.csv: the motor is somewhere else from one row to the next at "
                                                  "7.5 s, so this file is taken as 2 recordings"),
              std::string::npos)
        << recordings.front().warnings[0];
    EXPECT_EQ(recordings.back().name, "run.csv from 7.5 s");
    EXPECT_TRUE(recordings.back().warnings.empty());
    EXPECT_EQ(recordings.back().q1_rad, q1.tail(kRows - 1500)) << "rows were lost or changed";
    EXPECT_EQ(recordings.back().q2_rad, 0.8 * q1.tail(kRows - 1500));
  }
}

TEST(Recordings, LostRowsEndAnEffortsAndNoAngles) {
  AxisLog log = axis_of(Log().q1);
  log = only_rows(log, [] {
    std::vector<Index> kept;
    for (Index i = 0; i < kRows; ++i) {
      if (i < 1500 || i >= 1900) {
        kept.push_back(i);
      }
    }
    return kept;
  }());
  EXPECT_EQ(recordings_in(log).size(), 1U);
  log.effort = log.q2_rad;
  EXPECT_EQ(rows_of(recordings_in(log)), (std::vector<Index>{1500, kRows - 1900}));
}

TEST(Recordings, ThreeJoinedAreThree) {
  VectorXd q1 = Log().q1;
  q1.segment(1000, 1000).array() += 2.0;
  EXPECT_EQ(rows_of(recordings_in(axis_of(q1))), (std::vector<Index>{1000, 1000, 2000}));
}

TEST(Recordings, AMotionThatGoesOnIsOne) {
  const VectorXd q1 = Log().q1;
  EXPECT_EQ(rows_of(recordings_in(axis_of(q1))), std::vector<Index>{kRows});
  for (const double step : {0.01, 0.1}) {  // of an encoder
    EXPECT_EQ(recordings_in(axis_of(step * (q1 / step).array().round().matrix())).size(), 1U) << step;
  }
  VectorXd held = q1;  // a slower recorder
  for (Index i = 0; i < kRows; ++i) {
    held[i] = q1[i - i % 10];
  }
  EXPECT_EQ(recordings_in(axis_of(held)).size(), 1U);
}

TEST(Recordings, StepsAndAnAngleThatStartsAnewAreNone) {
  VectorXd steps = VectorXd::Zero(kRows);
  steps.tail(kRows / 2).setOnes();
  EXPECT_EQ(recordings_in(axis_of(steps)).size(), 1U) << "nothing moves between the steps";
  VectorXd turning = VectorXd::LinSpaced(kRows, 0.0, 20.0);
  turning = (turning.array() - turning.array().floor()).matrix();
  EXPECT_EQ(recordings_in(axis_of(turning)).size(), 1U);
  EXPECT_EQ(recordings_in(axis_of(VectorXd::Zero(kRows))).size(), 1U);
}

TEST(Recordings, AFewRowsBesideAreNone) {
  VectorXd q1 = Log().q1;
  q1.tail(50).array() += 3.0;
  EXPECT_EQ(recordings_in(axis_of(q1)).size(), 1U);
}

}  // namespace
}  // namespace capstan::tools
