// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/least_squares.hpp"

#include <gtest/gtest.h>

#include <random>

namespace capstan::tools {
namespace {

auto random_matrix(Eigen::Index rows, Eigen::Index cols, std::uint64_t seed) -> Eigen::MatrixXd {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
}

/// Kuhn-Tucker conditions: no slope on free columns, and at a bound none that leads into the allowed side.
void expect_optimal(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs, const std::vector<Sign>& signs,
                    const Eigen::VectorXd& theta) {
  const Eigen::VectorXd slope = rhs - gram * theta;
  for (Eigen::Index i = 0; i < theta.size(); ++i) {
    const double direction = signs[static_cast<std::size_t>(i)] == Sign::kNonPositive ? -1.0 : 1.0;
    if (signs[static_cast<std::size_t>(i)] == Sign::kAny) {
      EXPECT_NEAR(slope[i], 0.0, 1e-8);
      continue;
    }
    EXPECT_GE(direction * theta[i], 0.0);
    if (theta[i] == 0.0) {
      EXPECT_LE(direction * slope[i], 1e-8);
    } else {
      EXPECT_NEAR(slope[i], 0.0, 1e-8);
    }
  }
}

TEST(SignedLeastSquares, MeetsTheConditionsOfAnOptimumForAnySigns) {
  std::mt19937_64 random(5);
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Eigen::MatrixXd x = random_matrix(30, 6, seed);
    const Eigen::VectorXd y = random_matrix(30, 1, seed + 1000);
    std::vector<Sign> signs;
    for (int i = 0; i < 6; ++i) {
      signs.push_back(static_cast<Sign>(random() % 3));
    }
    const Eigen::MatrixXd gram = x.transpose() * x;
    const Eigen::VectorXd rhs = x.transpose() * y;
    expect_optimal(gram, rhs, signs, solve_signed(gram, rhs, signs));
  }
}

TEST(SignedLeastSquares, ManyColumnsMeetTheSameConditions) {
  for (const Eigen::Index n : {160, 300}) {
    const Eigen::MatrixXd x = random_matrix(2 * n, n, 91) + 2.0 * random_matrix(2 * n, 1, 92).replicate(1, n);
    const Eigen::VectorXd y = random_matrix(2 * n, 1, 93) + x.col(3);
    std::vector<Sign> signs(static_cast<std::size_t>(n), Sign::kNonNegative);
    signs[0] = Sign::kAny;
    signs[5] = Sign::kNonPositive;
    const Eigen::MatrixXd gram = x.transpose() * x;
    const Eigen::VectorXd rhs = x.transpose() * y;
    const Eigen::VectorXd theta = solve_signed(gram, rhs, signs);
    expect_optimal(gram / gram.trace(), rhs / gram.trace(), signs, theta);
    EXPECT_GT((theta.array() == 0.0).count(), n / 4) << "bounds that hold nothing back test nothing";
  }
}

TEST(SignedLeastSquares, AColumnOfZerosGetsZero) {
  Eigen::MatrixXd x = random_matrix(20, 2, 3);
  x.col(1).setZero();
  const Eigen::VectorXd y = 2.0 * x.col(0);
  const Eigen::VectorXd theta = solve_signed(x.transpose() * x, x.transpose() * y, {Sign::kAny, Sign::kAny});
  EXPECT_NEAR(theta[0], 2.0, 1e-12);
  EXPECT_EQ(theta[1], 0.0);
}

// Printed with eight digits a copy is no copy to the bit; large coefficients that cancel would fit its last digits.
TEST(SignedLeastSquares, AlmostACopySharesTheCoefficient) {
  Eigen::MatrixXd x = random_matrix(200, 2, 4);
  const Eigen::VectorXd y = 2.0 * x.col(0) + 0.1 * random_matrix(200, 1, 5);
  x.col(1) = x.col(0) + 1e-7 * random_matrix(200, 1, 6);
  const Eigen::VectorXd theta = solve_signed(x.transpose() * x, x.transpose() * y, {Sign::kAny, Sign::kAny});
  EXPECT_NEAR(theta[0], 1.0, 0.02);
  EXPECT_NEAR(theta[1], 1.0, 0.02);
}

TEST(FitColumns, TheToleranceOfACopiedColumnIsNearZero) {
  Eigen::MatrixXd x = random_matrix(400, 3, 4);
  x.col(2) = x.col(0) - 0.5 * x.col(1);
  const LinearFit fit =
      fit_columns(x, random_matrix(400, 1, 9), even_blocks({400}, 10), {Sign::kAny, Sign::kAny, Sign::kAny});
  EXPECT_LT(fit.tolerance.maxCoeff(), 1e-9);
}

TEST(FitColumns, IntervalsHoldTheirCoverageUnderAutocorrelatedNoise) {
  constexpr int kRuns = 300;
  int covered = 0;
  int covered_if_independent = 0;
  for (int run = 0; run < kRuns; ++run) {
    std::mt19937_64 random(static_cast<std::uint64_t>(run));
    std::normal_distribution<double> normal(0.0, 1.0);
    constexpr Eigen::Index kRows = 3000;
    Eigen::MatrixXd x(kRows, 2);
    Eigen::VectorXd y(kRows);
    double noise = 0.0;
    double wander = 0.0;
    for (Eigen::Index i = 0; i < kRows; ++i) {
      noise = 0.95 * noise + normal(random);
      wander = 0.95 * wander + normal(random);
      x.row(i) << wander, 1.0;
      y[i] = 0.3 * wander + 1.0 + noise;
    }
    const std::vector<Sign> any = {Sign::kAny, Sign::kAny};
    const LinearFit fit = fit_columns(x, y, even_blocks({kRows}, 30), any);
    covered += std::abs(fit.theta[0] - 0.3) < half_interval(fit, 0) ? 1 : 0;
    const double naive = 1.96 * fit.rmse / x.col(0).norm();
    covered_if_independent += std::abs(fit.theta[0] - 0.3) < naive ? 1 : 0;
  }
  EXPECT_GT(covered, kRuns * 91 / 100);
  EXPECT_LT(covered, kRuns * 99 / 100);
  EXPECT_LT(covered_if_independent, kRuns * 60 / 100);  // the trap that the blocks avoid
}

TEST(EvenBlocks, CoverEveryRowOnceAndNeverSpanTwoLogs) {
  const Blocks blocks = even_blocks({100, 37, 55}, 9);
  Eigen::Index next = 0;
  for (const auto& block : blocks) {
    EXPECT_EQ(block.begin, next);
    next = block.end;
    EXPECT_FALSE(block.begin < 100 && block.end > 100);
    EXPECT_FALSE(block.begin < 137 && block.end > 137);
  }
  EXPECT_EQ(next, 192);
}

}  // namespace
}  // namespace capstan::tools
