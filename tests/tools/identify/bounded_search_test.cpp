// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/bounded_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace capstan::tools {
namespace {

constexpr double kOpen = std::numeric_limits<double>::infinity();

/// Rosenbrock's valley, its least 0 at (1, 1).
class Valley final : public NonlinearResidual {
 public:
  auto at(const Eigen::VectorXd& x) -> Eigen::VectorXd override {
    x_ = x;
    ++asked;
    return Eigen::Vector2d(10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]);
  }
  auto jacobian() -> Eigen::MatrixXd override {
    Eigen::Matrix2d rows;
    rows << -20.0 * x_[0], 10.0, -1.0, 0.0;
    return rows;
  }
  int asked = 0;

 private:
  Eigen::Vector2d x_;
};

/// A residual that is no number.
class Nowhere final : public NonlinearResidual {
 public:
  auto at(const Eigen::VectorXd& /*x*/) -> Eigen::VectorXd override {
    return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  auto jacobian() -> Eigen::MatrixXd override { return Eigen::Matrix2d::Zero(); }
};

auto within(const Eigen::Vector2d& lower, const Eigen::Vector2d& upper, const Eigen::Vector2d& start) -> SearchResult {
  Valley valley;
  return least_squares_within({lower, upper}, start, valley);
}

TEST(BoundedSearch, EndsAtTheLeastWhereNothingBoundsIt) {
  const SearchResult found = within({-kOpen, -kOpen}, {kOpen, kOpen}, {-1.2, 1.0});
  EXPECT_NEAR(found.parameters[0], 1.0, 1e-6);
  EXPECT_NEAR(found.parameters[1], 1.0, 1e-6);
  EXPECT_LT(found.squares, 1e-12);
}

TEST(BoundedSearch, GoesAlongABound) {
  // x <= 0.5: y follows to 0.25 and (1 - 0.5)^2 is left.
  const SearchResult found = within({-2.0, -2.0}, {0.5, 2.0}, {-1.2, 1.0});
  EXPECT_EQ(found.parameters[0], 0.5);
  EXPECT_NEAR(found.parameters[1], 0.25, 1e-5);
  EXPECT_NEAR(found.squares, 0.25, 1e-9);
  // y <= 0.5: x is where 200 x^3 - 99 x - 1 is zero, bisected.
  double low = 0.5;
  double high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double x = 0.5 * (low + high);
    (200.0 * x * x * x - 99.0 * x - 1.0 < 0.0 ? low : high) = x;
  }
  const SearchResult below = within({-2.0, -2.0}, {2.0, 0.5}, {1.5, -1.0});
  EXPECT_EQ(below.parameters[1], 0.5);
  EXPECT_NEAR(below.parameters[0], low, 1e-5);
}

TEST(BoundedSearch, AStartOutsideBeginsAtTheBound) {
  const SearchResult found = within({0.0, 0.0}, {3.0, 3.0}, {-5.0, 70.0});
  EXPECT_NEAR(found.parameters[0], 1.0, 1e-6);
}

TEST(BoundedSearch, AsksForAnAcceptedStepOnce) {
  Valley valley;
  least_squares_within({Eigen::Vector2d(-2.0, -2.0), Eigen::Vector2d(2.0, 2.0)}, Eigen::Vector2d(0.9, 0.8), valley);
  EXPECT_LT(valley.asked, 12);
}

TEST(BoundedSearch, GivesBackAStartThatIsNowhereAndNeverPrints) {
  Nowhere nowhere;
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const SearchResult found = least_squares_within({Eigen::Vector2d(-2.0, -2.0), Eigen::Vector2d(2.0, 2.0)},
                                                  Eigen::Vector2d(0.9, 0.8), nowhere);
  within({-2.0, -2.0}, {0.5, 2.0}, {-1.2, 1.0});
  EXPECT_EQ(found.parameters, Eigen::Vector2d(0.9, 0.8));
  EXPECT_FALSE(std::isfinite(found.squares));
  EXPECT_EQ(testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace capstan::tools
