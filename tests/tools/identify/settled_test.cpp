// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/settled.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace capstan::tools {
namespace {

/// To and fro between -1 and 1 with so many rows a stroke, from 0 on.
auto strokes(Eigen::Index rows, Eigen::Index per_stroke) -> Eigen::VectorXd {
  Eigen::VectorXd q1(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    q1[i] = std::sin(std::numbers::pi * static_cast<double>(i) / static_cast<double>(per_stroke));
  }
  return q1;
}

TEST(Settled, BeginsWhereTheMotorHasCoveredNineTenthsOfItsRange) {
  const Eigen::VectorXd q1 = strokes(1000, 50);
  const Blocks settled = settled_rows(q1, {{0, 1000}});
  ASSERT_EQ(settled.size(), 1U);
  EXPECT_EQ(settled[0].end, 1000);
  // From 1 at row 25 down to -0.8: a quarter of the period of 100 rows, and asin(0.8) / 2 pi of it behind the middle.
  const double expected = 50.0 + 100.0 * std::asin(0.8) / (2.0 * std::numbers::pi);
  EXPECT_NEAR(static_cast<double>(settled[0].begin), expected, 2.0);
}

TEST(Settled, LeavesOutAQuarterOfALogAtMost) {
  const Blocks settled = settled_rows(Eigen::VectorXd::LinSpaced(400, 0.0, 1.0), {{0, 400}});
  EXPECT_EQ(settled[0].begin, 100);
}

TEST(Settled, IsAskedOfEachLogForItself) {
  Eigen::VectorXd q1(2000);
  q1 << strokes(1000, 50), strokes(1000, 50);
  const Blocks settled = settled_rows(q1, {{0, 1000}, {1000, 2000}});
  ASSERT_EQ(settled.size(), 2U);
  EXPECT_GT(settled[0].begin, 50);
  EXPECT_EQ(settled[1].begin, settled[0].begin + 1000);
  EXPECT_EQ(settled[1].end, 2000);
}

TEST(Settled, TakesAMotorThatStandsAsItIs) {
  const Blocks settled = settled_rows(Eigen::VectorXd::Constant(10, 3.0), {{0, 10}, {10, 10}});
  EXPECT_EQ(settled[0].begin, 0);
  EXPECT_EQ(settled[1].begin, 10);
  EXPECT_EQ(settled[1].end, 10);
}

}  // namespace
}  // namespace capstan::tools
