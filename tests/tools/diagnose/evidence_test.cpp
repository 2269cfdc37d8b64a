// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"

namespace capstan::tools {
namespace {

using test::candidate_named;
using test::equal_blocks;
using test::evidence_of;
using test::normals;
using test::split_of;

const std::vector<Role> kAllFit = {Role::kFit};

TEST(BlockGrams, SumsAreScalarProductsOverTheBlocksAskedFor) {
  const Eigen::MatrixXd columns = normals(12, 4, 1);
  const BlockGrams grams(columns, {1, 4, 4}, equal_blocks(3, 4));
  ASSERT_EQ(grams.count(), 3u);
  EXPECT_EQ(grams.rows(1), 4.0);
  Eigen::MatrixXd chosen(8, 4);
  chosen << columns.topRows(4), columns.bottomRows(4);
  EXPECT_LT((grams.sum({0, 2}) - chosen.transpose() * chosen).norm(), 1e-12);
  const Eigen::MatrixXd some = grams.sum({0, 2}, {3, 1});
  EXPECT_NEAR(some(0, 1), chosen.col(3).dot(chosen.col(1)), 1e-12);
  EXPECT_NEAR(some(0, 0), chosen.col(3).squaredNorm(), 1e-12);
}

TEST(BlockGrams, ProjectedProductsAreThoseOfWhatTheLawLeavesOfEachColumn) {
  const Eigen::MatrixXd columns = normals(30, 5, 2);
  const BlockGrams grams(columns, {2, 5, 5}, equal_blocks(3, 10));
  const Projected projected = grams.projected({0, 1, 2});
  const Eigen::MatrixXd law = columns.leftCols(2);
  const Eigen::MatrixXd rest = columns.rightCols(3);
  const Eigen::MatrixXd left = rest - law * law.colPivHouseholderQr().solve(rest);
  EXPECT_LT((projected.gram - left.transpose() * left).norm(), 1e-9);
  EXPECT_EQ(projected.rows, 30.0);
  EXPECT_NEAR(projected.error_energy(), left.col(0).squaredNorm(), 1e-9);
}

TEST(BlockGrams, ALawColumnThatIsNothingIsNoTrouble) {
  Eigen::MatrixXd columns = normals(20, 3, 3);
  columns.col(0).setZero();
  const Projected projected = BlockGrams(columns, {1, 3, 3}, equal_blocks(2, 10)).projected({0, 1});
  EXPECT_NEAR(projected.error_energy(), columns.col(1).squaredNorm(), 1e-9);
}

TEST(BlockGrams, OfAColumnThatTheLawTakesUpNothingIsLeftNotEvenRounding) {
  Eigen::MatrixXd columns = normals(300, 6, 5);
  columns.col(4) = 1e3 * (columns.col(0) - columns.col(1) / 3.0 + columns.col(2) / 7.0);
  const Projected projected = BlockGrams(columns, {3, 6, 6}, equal_blocks(3, 100)).projected({0, 1, 2});
  EXPECT_EQ(projected.gram.row(1).norm(), 0.0);
  EXPECT_EQ(projected.gram.col(1).norm(), 0.0);
  EXPECT_NEAR(projected.gram(2, 2), columns.col(5).squaredNorm(), 0.1 * columns.col(5).squaredNorm());
}

TEST(BlockGrams, EnergyIsWhatAModelLeavesOfABlockWhetherItHasFewColumnsOrMany) {
  const Eigen::MatrixXd columns = normals(10, 9, 4);
  const BlockGrams grams(columns, {1, 9, 9}, equal_blocks(1, 10));
  for (const std::vector<Eigen::Index>& own : {std::vector<Eigen::Index>{3}, {0, 2, 5, 8}}) {
    Eigen::VectorXd theta(static_cast<Eigen::Index>(own.size()));
    Eigen::VectorXd left = columns.col(1);
    for (std::size_t i = 0; i < own.size(); ++i) {
      theta[static_cast<Eigen::Index>(i)] = 0.5 - static_cast<double>(i);
      left -= theta[static_cast<Eigen::Index>(i)] * columns.col(own[i]);
    }
    EXPECT_NEAR(grams.energy(0, own, theta), left.squaredNorm(), 1e-10) << own.size();
  }
}

TEST(FitVariant, OneColumnByHandAndItsSign) {
  // The law takes no part; error (2, 4), column (1, 2): factor 2, which takes away all 20.
  Eigen::MatrixXd own(2, 1);
  own << 1, 2;
  for (const auto& [sign, theta, gain] :
       {std::tuple{Sign::kAny, 2.0, 20.0}, {Sign::kNonNegative, 2.0, 20.0}, {Sign::kNonPositive, 0.0, 0.0}}) {
    const Evidence evidence = evidence_of(
        {Eigen::MatrixXd(2, 0), Eigen::Vector2d(2, 4), {candidate_named("x", own, sign)}}, split_of(1, 2, kAllFit));
    const CandidateFit fit = fit_variant(evidence.raw().projected({0}), evidence.layout, evidence.candidates[0], 0);
    EXPECT_NEAR(fit.theta[0], theta, 1e-9);
    EXPECT_NEAR(fit.gain, gain, 1e-9);
  }
}

TEST(FitVariant, AColumnOfNothingGainsNothing) {
  const Evidence evidence =
      evidence_of({Eigen::MatrixXd(2, 0), Eigen::Vector2d(2, 4), {candidate_named("x", Eigen::MatrixXd::Zero(2, 1))}},
                  split_of(1, 2, kAllFit));
  EXPECT_EQ(fit_variant(evidence.raw().projected({0}), evidence.layout, evidence.candidates[0], 0).gain, 0.0);
}

TEST(FitVariant, OfTwoColumnsASignMayHoldOneBack) {
  // error = 3 a - 1 b on orthogonal columns: with b held at 0 the gain is that of a alone.
  const Eigen::MatrixXd own = Eigen::MatrixXd::Identity(2, 2);
  const Evidence evidence =
      evidence_of({Eigen::MatrixXd(2, 0), Eigen::Vector2d(3, -1), {candidate_named("x", own, Sign::kNonNegative)}},
                  split_of(1, 2, kAllFit));
  const CandidateFit fit = fit_variant(evidence.raw().projected({0}), evidence.layout, evidence.candidates[0], 0);
  EXPECT_NEAR(fit.theta[0], 3.0, 1e-9);
  EXPECT_EQ(fit.theta[1], 0.0);
  EXPECT_NEAR(fit.gain, 9.0, 1e-9);
}

TEST(FitCandidate, TheBestVariantIsTheOneThatGainsMost) {
  Candidate candidate = candidate_named("x", Eigen::Vector3d(1, 0, 0));
  candidate.variants.push_back({{}, Eigen::Vector3d(0, 1, 0), 0});
  candidate.variants.push_back({{}, Eigen::Vector3d(0, 0, 1), 0});
  const Evidence evidence =
      evidence_of({Eigen::MatrixXd(3, 0), Eigen::Vector3d(1, -5, 2), {candidate}}, split_of(1, 3, kAllFit));
  const CandidateFit fit = fit_candidate(evidence.raw().projected({0}), evidence.layout, evidence.candidates[0]);
  EXPECT_EQ(fit.variant, 1u);
  EXPECT_NEAR(fit.gain, 25.0, 1e-9);
}

TEST(FitCandidate, OfAnOutputTermTheExactVariantIsNoLinearOneAndTheFactorIsOne) {
  // Variants: exact (its change and the law through it), then changes alone. error (3, 0): the change (2, 0) takes
  // away 9 - 1 = 8; the change (6, 0) none, as 3 - 6 leaves as much.
  Eigen::MatrixXd exact(2, 2);
  exact << 3, 1, 0, 1;
  Candidate candidate = candidate_named("late", exact);
  candidate.acts_on_output = true;
  candidate.signs = {Sign::kAny};
  candidate.variants.push_back({{}, Eigen::Vector2d(6, 0), 0});
  candidate.variants.push_back({{}, Eigen::Vector2d(2, 0), 0});
  const Evidence evidence =
      evidence_of({Eigen::MatrixXd(2, 0), Eigen::Vector2d(3, 0), {candidate}}, split_of(1, 2, kAllFit));
  const CandidateFit fit = fit_candidate(evidence.raw().projected({0}), evidence.layout, evidence.candidates[0]);
  EXPECT_EQ(fit.variant, 2u);
  EXPECT_EQ(fit.theta[0], 1.0);
  EXPECT_NEAR(fit.gain, 8.0, 1e-9);
  EXPECT_EQ(fit_variant(evidence.raw().projected({0}), evidence.layout, evidence.candidates[0], 1).gain, 0.0);
}

}  // namespace
}  // namespace capstan::tools
