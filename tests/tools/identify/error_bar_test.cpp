// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/error_bar.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "capstan/tools/identify/settled.hpp"

namespace capstan::tools {
namespace {

/// A motor that goes from 0 to 1 rad and back, again and again, 500 rows a way.
auto ways(int count) -> Samples {
  constexpr int kRows = 500;
  Samples samples;
  for (int way = 0; way < count; ++way) {
    for (int row = 0; row < kRows; ++row) {
      const double gone = static_cast<double>(row + 1) / kRows;
      Sample<double> sample;
      sample.q1 = way % 2 == 0 ? gone : 1.0 - gone;
      sample.q1_reversal = way % 2 == 0 ? 0.0 : 1.0;
      samples.push_back(sample);
    }
  }
  return samples;
}

TEST(ErrorBarOfLogs, TellsNothingOfTheWayThatALogBeganWith) {
  const std::vector<Samples> logs = {ways(8)};
  Eigen::VectorXd error = Eigen::VectorXd::Constant(4000, 0.01);
  error.head(450).setConstant(5.0);  // a joint that came from elsewhere
  Eigen::VectorXd q1(4000);
  std::transform(logs[0].begin(), logs[0].end(), q1.begin(), [](const auto& sample) { return sample.q1; });
  const auto bar = error_bar(logs, error, settled_rows(q1, {{0, 4000}}));
  ASSERT_TRUE(bar);
  EXPECT_DOUBLE_EQ(bar->steady_rad(), 0.01);
  EXPECT_DOUBLE_EQ(bar->turning_rad(), 0.01);
}

TEST(ErrorBarOfLogs, IsThatOfFiveInAHundredOnEitherSideOfTheTurn) {
  const std::vector<Samples> logs = {ways(8)};
  Eigen::VectorXd error(4000);
  for (Eigen::Index i = 0; i < error.size(); ++i) {
    const bool turning = i % 500 < 50;  // a tenth of each way
    error[i] = turning ? 0.2 : (i % 10 == 0 ? -0.02 : 0.01);
  }
  const auto bar = error_bar(logs, error, {{0, 4000}});
  ASSERT_TRUE(bar);
  EXPECT_DOUBLE_EQ(bar->turning_rad(), 0.2);
  EXPECT_DOUBLE_EQ(bar->steady_rad(), 0.02) << "one in ten is that large, either way";
}

TEST(ErrorBarOfLogs, IsNotToldOfAHandfulOfRows) {
  const std::vector<Samples> logs = {ways(1)};
  EXPECT_FALSE(error_bar(logs, Eigen::VectorXd::Constant(500, 0.01), {{450, 500}}));
}

}  // namespace
}  // namespace capstan::tools
