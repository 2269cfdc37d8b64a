// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/machines/recorded_otherwise.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace capstan::tools::machines {
namespace {

auto small_log() -> DrawnMachine {
  DrawnMachine log{"sine", {"time_s", "axis0/q1_rad", "axis0/q2_rad"}, Eigen::MatrixXd(1000, 3)};
  for (Eigen::Index i = 0; i < 1000; ++i) {
    const double t = 0.01 * static_cast<double>(i);
    log.rows.row(i) << t, std::sin(t), 0.5 * std::sin(t - 0.1);
  }
  return log;
}

auto recorded(const std::string& name) -> DrawnMachine {
  for (const auto& way : ways()) {
    if (way.name == name) {
      return way.record(small_log());
    }
  }
  ADD_FAILURE() << "there is no way " << name;
  return {};
}

TEST(RecordedOtherwise, KeepsTheMotion) {
  const DrawnMachine log = small_log();
  for (const auto& way : ways()) {
    SCOPED_TRACE(way.name);
    const DrawnMachine other = way.record(log);
    EXPECT_EQ(other.columns, log.columns);
    const auto range = [](const Eigen::VectorXd& x) { return x.maxCoeff() - x.minCoeff(); };
    EXPECT_NEAR(range(other.rows.col(1)), range(log.rows.col(1)), 1e-3);
    for (Eigen::Index i = 1; i < other.rows.rows(); ++i) {
      ASSERT_GT(other.rows(i, 0), other.rows(i - 1, 0)) << "time runs backward in row " << i;
    }
  }
}

TEST(RecordedOtherwise, HasAsManyRowsAsItSays) {
  EXPECT_EQ(recorded("behind a rest").rows.rows(), 1300);
  EXPECT_EQ(recorded("a rest within").rows.rows(), 1300);
  EXPECT_EQ(recorded("half of the rows").rows.rows(), 500);
  EXPECT_EQ(recorded("twice the rows").rows.rows(), 1999);
  EXPECT_NEAR(static_cast<double>(recorded("one row in 20 lost").rows.rows()), 950.0, 30.0);
}

TEST(RecordedOtherwise, MovesZerosAndTargetsAlone) {
  const DrawnMachine log = small_log();
  EXPECT_TRUE(recorded("other zeros").rows.col(0) == log.rows.col(0));
  EXPECT_NEAR((recorded("other zeros").rows.rightCols(2) - log.rows.rightCols(2)).minCoeff(), 5.0, 1e-12);
  for (const char* name : {"2 % of noise", "200 steps", "wild values"}) {
    const DrawnMachine other = recorded(name);
    EXPECT_TRUE(other.rows.leftCols(2) == log.rows.leftCols(2)) << name;
    EXPECT_FALSE(other.rows.col(2) == log.rows.col(2)) << name;
  }
}

TEST(RecordedOtherwise, ComesBackFromAFile) {
  const auto folder = std::filesystem::temp_directory_path() / "capstan_recorded_otherwise";
  std::filesystem::create_directories(folder);
  write_machines(folder.string(), {small_log()}, 12);
  const auto read = read_machines(folder.string());
  std::filesystem::remove_all(folder);
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].columns, small_log().columns);
  EXPECT_NEAR((read[0].rows - small_log().rows).cwiseAbs().maxCoeff(), 0.0, 1e-10);
}

}  // namespace
}  // namespace capstan::tools::machines
