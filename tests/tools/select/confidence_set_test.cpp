// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/confidence_set.hpp"

#include <gtest/gtest.h>

#include "capstan/tools/support/random.hpp"

namespace capstan::tools {
namespace {

constexpr double kLevel = 0.1;
constexpr int kResamplings = 500;

/// Losses of models around given means with noise that they share and noise of their own.
auto losses_around(const std::vector<double>& means, double common, double own, std::uint64_t seed = 7)
    -> Eigen::MatrixXd {
  constexpr Eigen::Index kPieces = 40;
  Random random(seed);
  Eigen::MatrixXd losses(kPieces, static_cast<Eigen::Index>(means.size()));
  for (Eigen::Index row = 0; row < kPieces; ++row) {
    const double shared = common * random.normal();
    for (Eigen::Index i = 0; i < losses.cols(); ++i) {
      losses(row, i) = means[static_cast<std::size_t>(i)] + shared + own * random.normal();
    }
  }
  return losses;
}

auto set_of(const Eigen::MatrixXd& losses) -> ConfidenceSet {
  return confidence_set(losses, kLevel, kResamplings, 3);
}

TEST(ConfidenceSet, OneModelIsItsOwnSet) {
  const ConfidenceSet set = set_of(Eigen::MatrixXd::Ones(10, 1));
  EXPECT_EQ(set.in_set, std::vector<bool>{true});
  EXPECT_EQ(set.p_values, std::vector<double>{1.0});
}

TEST(ConfidenceSet, EqualModelsStayTogether) {
  const Eigen::VectorXd losses = losses_around({1.0}, 0.0, 0.1).col(0);
  Eigen::MatrixXd twice(losses.size(), 2);
  twice << losses, losses;
  const ConfidenceSet set = set_of(twice);
  EXPECT_TRUE(set.in_set[0]);
  EXPECT_TRUE(set.in_set[1]);
}

TEST(ConfidenceSet, AModelThatIsWorseByManySpreadsLeaves) {
  // 0.5 beside a standard error of the difference of 0.1 sqrt(2 / 40) = 0.022.
  const ConfidenceSet set = set_of(losses_around({1.0, 1.5, 1.0}, 0.0, 0.1));
  EXPECT_FALSE(set.in_set[1]);
  EXPECT_LT(set.p_values[1], kLevel);
  EXPECT_TRUE(set.in_set[0] || set.in_set[2]);
}

TEST(ConfidenceSet, WhatAllModelsShareDoesNotHideADifference) {
  EXPECT_FALSE(set_of(losses_around({1.0, 1.2}, 5.0, 0.05)).in_set[1]);
}

TEST(ConfidenceSet, TheBestOfEquallyGoodModelsKeepsItsPlaceNineTimesInTen) {
  constexpr int kLogs = 200;
  int kept = 0;
  for (int log = 0; log < kLogs; ++log) {
    kept +=
        set_of(losses_around({1.0, 1.0, 1.0, 1.0}, 1.0, 0.3, 100 + static_cast<std::uint64_t>(log))).in_set[0] ? 1 : 0;
  }
  EXPECT_GE(kept, 170);  // 180 expected at a level of 0.1; three standard deviations are 13
}

TEST(ConfidenceSet, PValuesRiseTowardsTheBestModel) {
  const ConfidenceSet set = set_of(losses_around({1.0, 1.03, 2.0}, 0.0, 0.1));
  EXPECT_LE(set.p_values[2], set.p_values[1]);
  EXPECT_LE(set.p_values[1], 1.0);
}

}  // namespace
}  // namespace capstan::tools
