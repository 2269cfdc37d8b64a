// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"

namespace capstan::tools {
namespace {

using test::equal_blocks;
using test::normals;

/// An autoregression of first order from the test's own innovations.
auto first_order(double a, const Eigen::VectorXd& innovations) -> Eigen::VectorXd {
  Eigen::VectorXd x = innovations;
  for (Eigen::Index i = 1; i < x.size(); ++i) {
    x[i] += a * x[i - 1];
  }
  return x;
}

/// [a law's column | error | two columns of an effect]
auto columns_with(const Eigen::VectorXd& error, unsigned seed) -> Eigen::MatrixXd {
  Eigen::MatrixXd columns(error.size(), 4);
  columns << normals(error.size(), 1, seed), error, normals(error.size(), 2, seed + 1);
  return columns;
}

TEST(Profile, UnderKnownNoiseItIsLeastSquaresOfTheDifferencesThatAreNoNoise) {
  AutoregressiveNoise known;
  known.coefficients = Eigen::VectorXd::Constant(1, 0.6);
  known.innovation_variance = 2.0;
  Eigen::MatrixXd columns = columns_with(first_order(0.6, normals(60, 1, 1)), 2);
  columns.col(1) += 1.5 * columns.col(0) - 0.5 * columns.col(2);
  const ColumnModel model{{0, 2}, {Sign::kAny, Sign::kAny}};
  const Blocks rows = equal_blocks(3, 20);
  const Profile profile = fit_profile(columns, {1, 4, 4}, model, rows, &known);
  Eigen::MatrixXd x(57, 2);  // the first row of a block has none before it
  Eigen::VectorXd y(57);
  Eigen::Index at = 0;
  for (const auto& block : rows) {
    for (Eigen::Index i = block.begin + 1; i < block.end; ++i, ++at) {
      x(at, 0) = columns(i, 0) - 0.6 * columns(i - 1, 0);
      x(at, 1) = columns(i, 2) - 0.6 * columns(i - 1, 2);
      y[at] = columns(i, 1) - 0.6 * columns(i - 1, 1);
    }
  }
  const Eigen::VectorXd expected = x.colPivHouseholderQr().solve(y);
  EXPECT_LT((profile.theta - expected).norm(), 1e-9);
  EXPECT_EQ(profile.noise.innovation_variance, 2.0);
}

TEST(Profile, NoiseOfItsOwnIsFoundBesideTheCoefficients) {
  const Eigen::Index rows = 6000;
  Eigen::MatrixXd columns = columns_with(first_order(0.8, normals(rows, 1, 3)), 4);
  columns.col(1) += 2.0 * columns.col(2);
  const Profile profile =
      fit_profile(columns, {1, 4, 4}, {{0, 2}, {Sign::kAny, Sign::kAny}}, equal_blocks(4, rows / 4), nullptr);
  EXPECT_NEAR(profile.theta[1], 2.0, 0.05);  // five spreads: 1 / sqrt(6000 (1 + 0.64))
  ASSERT_GE(profile.noise.order(), 1);
  EXPECT_NEAR(profile.noise.coefficients[0], 0.8, 0.04);
  EXPECT_NEAR(profile.noise.innovation_variance, 1.0, 0.08);
}

TEST(Profile, WhatIsFixedIsTakenOutFirst) {
  Eigen::MatrixXd columns = columns_with(Eigen::VectorXd::Zero(40), 5);
  columns.col(1) = 3.0 * columns.col(2) + columns.col(3);
  AutoregressiveNoise white;
  white.innovation_variance = 1.0;
  const ColumnModel model{{2}, {Sign::kAny}, 3};
  const Profile profile = fit_profile(columns, {1, 4, 4}, model, equal_blocks(2, 20), &white);
  EXPECT_NEAR(profile.theta[0], 3.0, 1e-9);
  // Nothing is left: the likelihood is that of the variance alone, over all rows but the first eight of each block.
  const Eigen::VectorXd likelihood = log_likelihood(columns, {1, 4, 4}, model, profile, equal_blocks(2, 20));
  EXPECT_NEAR(likelihood[0], -0.5 * 12.0 * std::log(2.0 * std::numbers::pi), 1e-9);
}

TEST(Profile, LikelihoodByHand) {
  // No columns: what is judged is the error itself, from the ninth row of each block on, under variance 4.
  Eigen::MatrixXd columns(20, 1);
  for (Eigen::Index i = 0; i < 20; ++i) {
    columns(i, 0) = static_cast<double>(i);
  }
  Profile profile;
  profile.theta.resize(0);
  profile.noise.innovation_variance = 4.0;
  const Eigen::VectorXd likelihood = log_likelihood(columns, {0, 1, 1}, {}, profile, {{0, 10}, {10, 15}, {10, 20}});
  const auto of = [](std::initializer_list<double> values) {
    double sum = 0.0;
    for (const double value : values) {
      sum += -0.5 * std::log(2.0 * std::numbers::pi * 4.0) - 0.5 * value * value / 4.0;
    }
    return sum;
  };
  EXPECT_NEAR(likelihood[0], of({8, 9}), 1e-9);
  EXPECT_EQ(likelihood[1], 0.0);  // too short to be judged
  EXPECT_NEAR(likelihood[2], of({18, 19}), 1e-9);
}

}  // namespace
}  // namespace capstan::tools
