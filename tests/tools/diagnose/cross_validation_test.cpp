// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/cross_validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"

namespace capstan::tools {
namespace {

using test::candidate_named;
using test::evidence_of;
using test::normals;
using test::split_of;

const std::vector<Role> kAllFit = {Role::kFit};

TEST(CrossValidation, TheLawAloneIsItsOwnColumnsWithoutSigns) {
  const ColumnModel law = law_model({3, 5, 7});
  EXPECT_EQ(law.free, (ColumnList{0, 1, 2}));
  EXPECT_EQ(law.signs, std::vector<Sign>(3, Sign::kAny));
  EXPECT_EQ(law.fixed, -1);
}

TEST(CrossValidation, ACandidateStandsBesideTheLawWithItsSigns) {
  Candidate candidate = candidate_named("x", Eigen::MatrixXd::Zero(1, 2), Sign::kNonNegative);
  candidate.variants[0].first = 5;
  const ColumnModel model = model_of({3, 7, 7}, candidate, 0);
  EXPECT_EQ(model.free, (ColumnList{0, 1, 2, 5, 6}));
  EXPECT_EQ(model.signs,
            (std::vector<Sign>{Sign::kAny, Sign::kAny, Sign::kAny, Sign::kNonNegative, Sign::kNonNegative}));
  EXPECT_EQ(model.fixed, -1);
}

TEST(CrossValidation, AnOutputTermReplacesTheLawsColumnsAndHasAFactorOfOne) {
  Candidate candidate = candidate_named("late", Eigen::MatrixXd::Zero(1, 1));
  candidate.acts_on_output = true;
  candidate.variants[0].first = 4;  // its change in 4, the law's three columns through it in 5 to 7
  const ColumnModel model = model_of({3, 8, 8}, candidate, 0);
  EXPECT_EQ(model.free, (ColumnList{5, 6, 7}));
  EXPECT_EQ(model.fixed, 4);
}

TEST(CrossValidation, FitsByHand) {
  // error = 2 a + 3 b on rows that are the two unit vectors, twice
  Eigen::MatrixXd law(4, 1);
  law << 1, 0, 1, 0;
  Eigen::MatrixXd own(4, 1);
  own << 0, 1, 0, 1;
  Eigen::VectorXd error(4);
  error << 2, 3, 2, 4;
  const Evidence evidence = evidence_of({law, error, {candidate_named("b", own)}}, split_of(2, 2, kAllFit));
  const ColumnModel model = model_of(evidence.layout, evidence.candidates[0], 0);
  const FittedModel first = fit_model(evidence.raw(), {0}, model);
  EXPECT_NEAR(first.theta[0], 2.0, 1e-12);
  EXPECT_NEAR(first.theta[1], 3.0, 1e-12);
  const Eigen::VectorXd energies = block_energies(evidence.raw(), {0, 1}, first);
  EXPECT_NEAR(energies[0], 0.0, 1e-12);
  EXPECT_NEAR(energies[1], 1.0, 1e-12);  // 4 where 3 was learned
  const FittedModel both = fit_model(evidence.raw(), {0, 1}, model);
  EXPECT_NEAR(both.theta[1], 3.5, 1e-12);
}

TEST(CrossValidation, ASignThatTheDataForbidLeavesTheCoefficientAtNothing) {
  Eigen::MatrixXd own(2, 1);
  own << 1, 1;
  const Evidence evidence = evidence_of(
      {Eigen::MatrixXd::Zero(2, 0), Eigen::Vector2d(-1, -3), {candidate_named("b", own, Sign::kNonNegative)}},
      split_of(1, 2, kAllFit));
  const FittedModel fitted = fit_model(evidence.raw(), {0}, model_of(evidence.layout, evidence.candidates[0], 0));
  EXPECT_EQ(fitted.theta[0], 0.0);
  EXPECT_NEAR(block_energies(evidence.raw(), {0}, fitted)[0], 10.0, 1e-12);
}

TEST(CrossValidation, AnOutputTermsChangeIsTakenAsItIs) {
  // error (5, 5): the change (1, 2) leaves (4, 3), of which the law's column through the term, (4, 3), takes all.
  Eigen::MatrixXd through(2, 2);
  through << 1, 4, 2, 3;
  Candidate candidate = candidate_named("late", through);
  candidate.acts_on_output = true;
  const Evidence evidence =
      evidence_of({Eigen::MatrixXd::Ones(2, 1), Eigen::Vector2d(5, 5), {candidate}}, split_of(1, 2, kAllFit));
  const FittedModel fitted = fit_model(evidence.raw(), {0}, model_of(evidence.layout, evidence.candidates[0], 0));
  ASSERT_EQ(fitted.columns.size(), 2u);
  EXPECT_NEAR(fitted.theta[0], 1.0, 1e-12);
  EXPECT_EQ(fitted.theta[1], 1.0);
  EXPECT_NEAR(block_energies(evidence.raw(), {0}, fitted)[0], 0.0, 1e-12);
}

TEST(CrossValidation, NoBlockIsJudgedByAFitThatHasSeenItsFold) {
  // A mean of single rows: what is left of each is its distance from the mean of the other folds' rows. Of seven rows
  // the first and the sixth, the second and the seventh are one fold each.
  Eigen::VectorXd error(7);
  error << 1, 2, 3, 4, 10, -5, 7;
  const Evidence evidence = evidence_of({Eigen::MatrixXd::Ones(7, 1), error}, split_of(7, 1, kAllFit));
  const Eigen::VectorXd energies = cross_validated(evidence.raw(), evidence.learned, law_model(evidence.layout));
  for (Eigen::Index i = 0; i < 7; ++i) {
    double sum = 0.0;
    int count = 0;
    for (Eigen::Index k = 0; k < 7; ++k) {
      if (k % 5 != i % 5) {
        sum += error[k];
        ++count;
      }
    }
    EXPECT_NEAR(energies[i], std::pow(error[i] - sum / count, 2.0), 1e-9) << i;
  }
}

TEST(CrossValidation, TheCeilingIsTheBestOfFourRidges) {
  // Rows of one block are one row each; the same fits, written out with rows instead of products.
  const Eigen::Index rows = 40;
  const Eigen::MatrixXd law = Eigen::MatrixXd::Ones(rows, 1);
  const Eigen::MatrixXd own = normals(rows, 1, 5);
  const Eigen::MatrixXd flexible = normals(rows, 2, 6);
  const Eigen::VectorXd error = 0.3 * own.col(0) + 0.2 * flexible.col(1) + normals(rows, 1, 7);
  const Evidence evidence =
      evidence_of({law, error, {candidate_named("x", own)}, flexible}, split_of(rows, 1, kAllFit));
  Eigen::MatrixXd x(rows, 4);
  x << law, own, flexible;
  double least = std::numeric_limits<double>::infinity();
  Eigen::VectorXd best;
  for (const double ridge : {1e-6, 1e-4, 1e-2, 1.0}) {
    Eigen::VectorXd energies(rows);
    for (Eigen::Index fold = 0; fold < 5; ++fold) {
      Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(4, 4);
      Eigen::VectorXd rhs = Eigen::VectorXd::Zero(4);
      for (Eigen::Index i = 0; i < rows; ++i) {
        if (i % 5 != fold) {
          gram += x.row(i).transpose() * x.row(i);
          rhs += error[i] * x.row(i).transpose();
        }
      }
      for (Eigen::Index k = 1; k < 4; ++k) {
        gram(k, k) += ridge * x.col(k).squaredNorm();  // of all rows
      }
      const Eigen::VectorXd theta = gram.fullPivLu().solve(rhs);
      for (Eigen::Index i = fold; i < rows; i += 5) {
        energies[i] = std::pow(error[i] - x.row(i) * theta, 2.0);
      }
    }
    if (energies.sum() < least) {
      least = energies.sum();
      best = energies;
    }
  }
  const Eigen::VectorXd energy = flexible_model(evidence.raw(), evidence.learned);
  EXPECT_LT((energy - best).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(CrossValidation, StudentsTByHand) {
  Eigen::VectorXd values(5);
  values << 1, 2, 3, 4, 5;
  EXPECT_NEAR(t_statistic(values), 3.0 / std::sqrt(2.5 / 5.0), 1e-12);
  EXPECT_NEAR(t_statistic(-values), -3.0 / std::sqrt(0.5), 1e-12);
  EXPECT_EQ(t_statistic(Eigen::VectorXd::Constant(4, 2.0)), 0.0);  // without a spread nothing is certain
  EXPECT_EQ(t_statistic(Eigen::VectorXd::Constant(1, 2.0)), 0.0);
}

TEST(CrossValidation, SignedRanksByHand) {
  Eigen::VectorXd values(5);
  values << 3, -2, 100, 1, 4;  // ranks 3, 2, 5, 1, 4: positive ones 13 of 15, expected 7.5
  EXPECT_NEAR(signed_rank_score(values), (13.0 - 7.5) / std::sqrt(5.0 * 6.0 * 11.0 / 24.0), 1e-12);
  EXPECT_NEAR(signed_rank_score(-values), (2.0 - 7.5) / std::sqrt(13.75), 1e-12);
  values[2] = 5;  // how large the largest is does not matter
  EXPECT_NEAR(signed_rank_score(values), 5.5 / std::sqrt(13.75), 1e-12);
}

}  // namespace
}  // namespace capstan::tools
