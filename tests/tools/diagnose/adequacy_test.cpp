// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/adequacy.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"

namespace capstan::tools {
namespace {

using test::evidence_of;
using test::normals;
using test::preparation_of;
using test::split_of;

const std::vector<Role> kAllFit = {Role::kFit};

TEST(ExplainedShare, OfBlocksThatAreAlikeIsTheSameForEveryResampling) {
  const auto share = [](double before, double after, double flexible) {
    const auto all = [](double energy) { return Eigen::VectorXd::Constant(10, energy); };
    return explained_share(all(before), all(after), all(flexible));
  };
  EXPECT_NEAR(share(10, 4, 2).value, 6.0 / 8.0, 1e-12);
  EXPECT_NEAR(share(10, 4, 2).lower, 6.0 / 8.0, 1e-12);
  EXPECT_NEAR(share(10, 1, 2).value, 1.0, 1e-12);     // better than the flexible model: all there is to explain
  EXPECT_NEAR(share(10, 12, 2).value, -0.25, 1e-12);  // it does harm
  EXPECT_EQ(share(1, 1.5, 2).value, 0.0);             // nothing is to be explained
}

TEST(ExplainedShare, WhatOneBlockOwesToItselfIsNotCertain) {
  Eigen::VectorXd before = Eigen::VectorXd::Ones(10);
  Eigen::VectorXd after = before;
  before[3] = 20.0;  // the effect shows in one block, and makes things a little worse in the others
  after.array() += 0.1;
  const ExplainedShare share = explained_share(before, after, Eigen::VectorXd::Constant(10, 0.5));
  EXPECT_NEAR(share.value, (29.0 - 11.0) / (29.0 - 5.0), 1e-12);
  EXPECT_LT(share.lower, 0.0);  // a third of the resamplings are without it
}

TEST(LearnedCycles, AreThoseBehindTheWarmUpAndBeforeTheReport) {
  Split split;
  split.blocks = {{{0, 180}, Role::kFit}, {{210, 290}, Role::kChoose}, {{300, 400}, Role::kReport}};
  Preparation p = preparation_of(400, split);
  p.repeats = Repeats{0, 100, 4};
  const Repeats all = learned_cycles(p);
  EXPECT_EQ(all.first, 0);
  EXPECT_EQ(all.count, 3);  // the fourth begins where the report does
  p.coarse_logs = {{50, 400}};
  const Repeats warm = learned_cycles(p);
  EXPECT_EQ(warm.first, 100);
  EXPECT_EQ(warm.count, 2);
  p.coarse_logs = {{150, 400}};
  EXPECT_EQ(learned_cycles(p).count, 2);  // no fewer: one cycle repeats nothing
}

TEST(PureError, IsTheSpreadBetweenCyclesWhereTheDirectionIsKnown) {
  // Cycles that differ by 1, 2 and 6 all along: variance (4 + 1 + 9) / 2 = 7.
  Preparation p = preparation_of(12, split_of(1, 12, kAllFit));
  p.repeats = Repeats{0, 4, 3};
  Eigen::VectorXd error(12);
  error << 1, 1, 1, 1, 2, 2, 2, 2, 6, 6, 6, 6;
  EXPECT_NEAR(pure_error_level(p, error), std::sqrt(7.0), 1e-12);
  error[5] = 1000.0;  // a row whose direction is not known, and with it its place in all cycles
  p.uncertain = {{5, 6}};
  EXPECT_NEAR(pure_error_level(p, error), std::sqrt(7.0), 1e-12);
  p.uncertain = {{0, 12}};
  EXPECT_EQ(pure_error_level(p, error), 0.0);
}

TEST(PureError, CountsEverySampleOfACoarseRow) {
  Preparation p = preparation_of(8, split_of(1, 4, kAllFit));
  p.factor = 2;
  p.repeats = Repeats{0, 2, 2};  // coarse rows
  Eigen::VectorXd error(8);
  error << 3, -1, 0, 0, -3, 1, 0, 0;  // differences 6, -2 and nothing: variances 18, 2, 0, 0
  EXPECT_NEAR(pure_error_level(p, error), std::sqrt(20.0 / 4.0), 1e-12);
}

TEST(AveragedOut, IsWhatTheMeansOfTheCoarseGridLeaveOut) {
  Preparation p = preparation_of(8, split_of(1, 4, kAllFit));
  p.factor = 2;
  Eigen::VectorXd error(8);
  error << 1, -1, 1, -1, 1, -1, 1, -1;
  EXPECT_NEAR(averaged_out(p, error), 1.0, 1e-12);
  EXPECT_NEAR(averaged_out(p, error + Eigen::VectorXd::Constant(8, 5.0)), 1.0, 1e-12);
  EXPECT_NEAR(averaged_out(p, Eigen::VectorXd::Constant(8, 5.0)), 0.0, 1e-12);
}

constexpr Eigen::Index kBlocks = 40, kSize = 20, kRows = kBlocks * kSize;

/// A constant as the law; what it leaves is white noise of variance 1 and `strength` of a flexible feature.
struct Left {
  explicit Left(double strength, unsigned seed)
      : flexible(normals(kRows, 1, seed)),
        evidence(evidence_of({Eigen::MatrixXd::Ones(kRows, 1),
                              Eigen::VectorXd(strength * flexible.col(0) + normals(kRows, 1, seed + 1)),
                              {},
                              flexible},
                             split)) {}
  [[nodiscard]] auto judged(double flexible_p) const -> Adequacy {
    SieveResult sieve;
    sieve.flexible_p = flexible_p;
    return judge_adequacy(p, evidence, sieve);
  }
  Split split = split_of(kBlocks, kSize, kAllFit);
  Preparation p = preparation_of(kRows, split);
  Eigen::MatrixXd flexible;
  Evidence evidence;
};

TEST(Adequacy, ALawThatLeavesNoiseLacksNothing) {
  const Adequacy judged = Left(0.0, 1).judged(0.4);
  EXPECT_FALSE(judged.lacks_something);
  EXPECT_NEAR(judged.reducible_share, 0.0, 0.02);
  EXPECT_EQ(judged.lack_of_fit_p, 1.0);  // nobody repeated anything
  EXPECT_EQ(judged.flexible_p, 0.4);
}

TEST(Adequacy, WhatAFlexibleModelPredictsIsMissing) {
  const Adequacy judged = Left(0.6, 3).judged(0.4);  // certain by its t over the blocks alone
  EXPECT_TRUE(judged.lacks_something);
  EXPECT_GT(judged.flexible_t, 2.7);
  EXPECT_NEAR(judged.reducible_share, 0.36 / 1.36, 0.06);
}

TEST(Adequacy, SomethingCertainButTooSmallToMatterIsNotMissing) {
  const Adequacy judged = Left(0.22, 5).judged(0.001);  // 4.6 % of the energy, of 8
  EXPECT_GT(judged.reducible_share, 0.02);
  EXPECT_FALSE(judged.lacks_something);
}

TEST(Adequacy, WhatSensorsHideIsNotMissing) {
  Left left(0.6, 7);
  left.evidence.sensing.col(0) = left.evidence.white_sensing.col(0) = 0.6 * left.flexible.col(0);
  const Adequacy judged = left.judged(0.4);
  EXPECT_FALSE(judged.lacks_something);
  EXPECT_NEAR(judged.hidden_energy, 0.36 * left.flexible.squaredNorm(), 1e-9);
  EXPECT_NEAR(judged.reducible_share, 0.0, 0.04);
}

TEST(Adequacy, TheCeilingIsTheLawLessWhatCanBeReduced) {
  for (const double strength : {0.0, 0.6}) {
    const Adequacy judged = Left(strength, 9).judged(0.4);
    const double share = std::max(0.0, judged.reducible_share);
    EXPECT_NEAR(judged.flexible_energy.sum(), (1.0 - share) * judged.law_energy.sum(), 1e-9 * judged.law_energy.sum());
    EXPECT_LE(judged.flexible_energy.sum(), judged.law_energy.sum() * (1.0 + 1e-12));
  }
}

/// Four cycles of a quarter of the rows each.
auto with_cycles(Left left) -> Left {
  left.p.repeats = Repeats{0, kRows / 4, 4};
  left.evidence.noise_from_repeats = true;
  return left;
}

TEST(Adequacy, WhatRepeatsWithTheMotionIsMissingThoughNoModelKnowsIt) {
  Left left = with_cycles(Left(0.0, 11));
  const Eigen::VectorXd once = normals(kRows / 4, 1, 13);
  Eigen::VectorXd again(kRows);
  again << once, once, once, once;
  left.evidence = evidence_of(
      {Eigen::MatrixXd::Ones(kRows, 1), Eigen::VectorXd(0.7 * again + normals(kRows, 1, 14)), {}, left.flexible},
      left.split);
  left.evidence.noise_from_repeats = true;
  const Adequacy judged = left.judged(1.0);
  EXPECT_TRUE(judged.lacks_something);
  EXPECT_LT(judged.lack_of_fit_p, 1e-6);
  const double repeated = 0.49 * (once.array() - once.mean()).square().mean();
  EXPECT_NEAR(judged.reducible_share, repeated / (1.0 + repeated), 0.05);
}

TEST(Adequacy, NoiseThatDoesNotRepeatIsNotMissing) {
  const Adequacy judged = with_cycles(Left(0.0, 15)).judged(1.0);
  EXPECT_FALSE(judged.lacks_something);
  EXPECT_GT(judged.lack_of_fit_p, 0.001);
}

TEST(Adequacy, ALawThatLeavesNothingAtAllLacksNothing) {
  for (const bool repeats : {false, true}) {
    Left left(0.0, 17);
    left.evidence =
        evidence_of({Eigen::MatrixXd::Ones(kRows, 1), Eigen::VectorXd::Zero(kRows), {}, left.flexible}, left.split);
    left = repeats ? with_cycles(left) : left;
    const Adequacy judged = left.judged(1.0);
    EXPECT_FALSE(judged.lacks_something);
    EXPECT_EQ(judged.reducible_share, 0.0);
    EXPECT_EQ(judged.flexible_energy.sum(), 0.0);
    EXPECT_EQ(judged.lack_of_fit_p, 1.0);
  }
}

TEST(Adequacy, WhatRepeatsToTheLastDigitIsMissing) {
  Left left(0.0, 19);
  const Eigen::VectorXd once = normals(kRows / 4, 1, 20);
  Eigen::VectorXd again(kRows);
  again << once, once, once, once;
  left.evidence = evidence_of({Eigen::MatrixXd::Ones(kRows, 1), again, {}, left.flexible}, left.split);
  const Adequacy judged = with_cycles(left).judged(1.0);
  EXPECT_TRUE(judged.lacks_something);
  EXPECT_LT(judged.lack_of_fit_p, 1e-6);
  EXPECT_NEAR(judged.reducible_share, 1.0, 1e-6);
}

}  // namespace
}  // namespace capstan::tools
