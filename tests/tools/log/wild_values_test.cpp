// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/wild_values.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace capstan::tools {
namespace {

using Rows = std::vector<Eigen::Index>;

constexpr Eigen::Index kRows = 600;

/// Three cycles of an angle, and noise.
auto sine(double noise = 0.002) -> Eigen::VectorXd {
  std::mt19937_64 draw(5);
  std::normal_distribution<double> normal(0.0, noise);
  Eigen::VectorXd x(kRows);
  for (Eigen::Index i = 0; i < kRows; ++i) {
    x[i] = std::sin(6.0 * std::numbers::pi * static_cast<double>(i) / kRows) + normal(draw);
  }
  return x;
}

/// Every so many rows, up and down.
auto wild_rows(Eigen::Index every) -> Rows {
  Rows rows;
  for (Eigen::Index i = every; i + 1 < kRows; i += every) {
    rows.push_back(i);
  }
  return rows;
}

auto with_wild_values(Eigen::VectorXd x, const Rows& rows) -> Eigen::VectorXd {
  double far = 3.0;
  for (const Eigen::Index row : rows) {
    x[row] += far;
    far = -far;
  }
  return x;
}

TEST(WildValues, OneInSevenIsFoundInAnAngleAndOneInAHundredInATorque) {
  for (const Eigen::Index every : {7, 10, 30, 150}) {
    const Rows rows = wild_rows(every);
    const Eigen::VectorXd x = with_wild_values(sine(), rows);
    EXPECT_EQ(spike_rows(x, false), rows) << every;
    EXPECT_EQ(spike_rows(x, true), every == 150 ? rows : Rows{}) << every;
  }
}

TEST(WildValues, ALineTakesTheirPlace) {
  const Eigen::VectorXd x = sine();
  const Eigen::VectorXd mended = without(with_wild_values(x, wild_rows(10)), wild_rows(10));
  EXPECT_LT((mended - x).cwiseAbs().maxCoeff(), 0.02);
}

TEST(WildValues, SmallOnesBesideManyFarOnesAreFoundToo) {
  Eigen::VectorXd x = with_wild_values(sine(), wild_rows(20));
  x[133] += 0.6;
  Rows rows = wild_rows(20);
  rows.insert(std::upper_bound(rows.begin(), rows.end(), 133), 133);
  EXPECT_EQ(spike_rows(x, false), rows);
}

TEST(WildValues, AThirdOfAllRowsIsHowTheChannelIs) {
  EXPECT_EQ(spike_rows(with_wild_values(sine(), wild_rows(3)), false), Rows{});
}

TEST(WildValues, NoiseStepsAndShortStrokesAreNone) {
  EXPECT_EQ(spike_rows(sine(), false), Rows{});
  EXPECT_EQ(spike_rows(sine(0.3), false), Rows{});
  Eigen::VectorXd steps(kRows);
  Eigen::VectorXd strokes = Eigen::VectorXd::Zero(kRows);
  Eigen::VectorXd coarse = sine();
  for (Eigen::Index i = 0; i < kRows; ++i) {
    steps[i] = i / 40 % 2 == 0 ? 1.0 : -1.0;
    // There and back within twelve rows, and a rest.
    const auto place = static_cast<double>(i % 120);
    strokes[i] = place < 12.0 ? std::sin(std::numbers::pi * place / 12.0) : 0.0;
    coarse[i] = std::round(10.0 * coarse[i]) / 10.0;
  }
  EXPECT_EQ(spike_rows(steps, false), Rows{});
  EXPECT_EQ(spike_rows(strokes, false), Rows{});
  EXPECT_EQ(spike_rows(coarse, false), Rows{});
}

}  // namespace
}  // namespace capstan::tools
