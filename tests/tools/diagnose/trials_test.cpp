// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/trials.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"

namespace capstan::tools {
namespace {

using test::candidate_named;
using test::evidence_of;
using test::normals;
using test::preparation_of;
using test::split_of;

auto values(std::initializer_list<double> list) -> Eigen::VectorXd {
  Eigen::VectorXd result(static_cast<Eigen::Index>(list.size()));
  std::copy(list.begin(), list.end(), result.begin());
  return result;
}

TEST(ClearlyPositive, ByTheMeanOrByTheRanks) {
  EXPECT_TRUE(clearly_positive(values({1, 2, 3, 2, 1})));  // t = 4.8
  EXPECT_FALSE(clearly_positive(values({-1, -2, -3, -2, -1})));
  EXPECT_FALSE(clearly_positive(values({1, -1, 2, -1.5, 0.5, -0.9})));
  // One block with much motion makes the mean uncertain, t = 1.2; all six ranks are positive, (21 - 10.5) / 4.77.
  EXPECT_TRUE(clearly_positive(values({30, 1, 1, 1, 1, 1})));
  // One large block decides neither by its size (t = 1) nor by its rank.
  EXPECT_FALSE(clearly_positive(values({100, -1, -1.1, -1.2, -1.3, -1.4, -1.5, -1.6, -1.7})));
  EXPECT_FALSE(clearly_positive(values({0, 0, 0})));
}

TEST(EvidenceNeeded, GrowsWithTheNumberOfNamesTried) {
  Evidence evidence;
  evidence.candidates.resize(5);
  EXPECT_NEAR(evidence_needed(evidence), std::log(500.0), 1e-12);
}

/// A trial that passes both ways, of five candidates.
auto passing() -> CandidateTrial {
  CandidateTrial trial;
  trial.possible = true;
  trial.explained = 0.3;
  trial.explained_t = 5.0;
  trial.p_value = trial.p_sieve = 0.001;
  trial.log_e_value = 10.0;
  return trial;
}

TEST(Passes, EitherWayIsEnoughAndHasToBeOfUse) {
  Evidence evidence;
  evidence.candidates.resize(5);
  CandidateTrial trial = passing();
  EXPECT_TRUE(passes(trial, evidence));
  trial.p_sieve = 0.006;  // above half of the error rate: the whitened way alone
  EXPECT_TRUE(passes(trial, evidence));
  trial.log_e_value = std::log(500.0) - 0.01;
  EXPECT_FALSE(passes(trial, evidence));
  trial.log_e_value = std::log(500.0);
  EXPECT_TRUE(passes(trial, evidence));
  trial.p_value = 0.006;
  EXPECT_FALSE(passes(trial, evidence));
  trial.p_sieve = 0.005;  // across halves alone
  EXPECT_TRUE(passes(trial, evidence));
  trial.explained = 0.0;
  EXPECT_FALSE(passes(trial, evidence));
  trial = passing();
  trial.possible = false;
  EXPECT_FALSE(passes(trial, evidence));
}

TEST(Passes, AnEffortsEffectIsConfirmedByEnergyAndNotByLikelihood) {
  Evidence evidence;
  evidence.candidates.resize(5);
  evidence.by_energy = true;
  CandidateTrial trial = passing();
  trial.log_e_value = -100.0;
  EXPECT_TRUE(passes(trial, evidence));
  trial.p_sieve = 1.0;
  EXPECT_TRUE(passes(trial, evidence));
  trial.p_value = 0.006;
  EXPECT_FALSE(passes(trial, evidence));
  trial = passing();
  trial.explained_t = 2.7;
  EXPECT_FALSE(passes(trial, evidence));
}

/// Two candidates, of which the first is the best: what other() changes decides whether the second stays beside it.
struct Rivals {
  Rivals() {
    evidence.candidates.resize(2);
    for (auto& candidate : evidence.candidates) {
      candidate.in_catalogue = true;
      candidate.signs = {Sign::kAny};
      candidate.variants.resize(1);
    }
    trials.resize(2);
    for (std::size_t i = 0; i < 2; ++i) {
      trials[i].candidate = i;
      trials[i].possible = true;
      trials[i].energies = values({1, 1.01, 0.99, 1.02, 0.98, 1});
      trials[i].likelihoods = values({50, 51, 49, 50.5, 49.5, 50});
    }
  }
  auto other() -> CandidateTrial& { return trials[1]; }
  [[nodiscard]] auto are_confusable(double floor_energy = 0.0) const -> bool {
    return !confusable_with(evidence, trials, 0, floor_energy).empty();
  }
  /// Each block of the other less likely by about so much; six times that has to exceed ln 200 = 5.3.
  void less_likely(double nats) { other().likelihoods -= nats * values({1, 1.1, 0.9, 1.05, 0.95, 1}); }
  void leaves_more(double energy) { other().energies += energy * values({1, 1.1, 0.9, 1.05, 0.95, 1}); }
  Evidence evidence;
  std::vector<CandidateTrial> trials;
};

TEST(Confusable, WhatDoesAsWellIsNotToldApart) {
  Rivals rivals;
  EXPECT_TRUE(rivals.are_confusable());
  rivals.less_likely(0.8);  // 4.8 nats
  EXPECT_TRUE(rivals.are_confusable());
}

TEST(Confusable, WhatIsImpossibleIsNoRival) {
  Rivals rivals;
  rivals.other().possible = false;
  EXPECT_FALSE(rivals.are_confusable());
}

TEST(Confusable, LessLikelyByMoreThanTheBestMayOweToWhatNeitherHasRulesOut) {
  Rivals rivals;
  rivals.less_likely(1.2);                   // 7.2 nats
  rivals.leaves_more(0.25);                  // 1.5 in all, of 6 that the best leaves
  EXPECT_TRUE(rivals.are_confusable(4.0));   // 2 of these may be somebody else's
  EXPECT_FALSE(rivals.are_confusable(5.0));  // 1
}

TEST(Confusable, OverwhelminglyLessLikelyRulesOutWhateverTheEnergy) {
  Rivals rivals;
  rivals.less_likely(2.8);  // 16.8 nats, of three times 5.3
  EXPECT_FALSE(rivals.are_confusable());
}

TEST(Confusable, LikelihoodThatOneBlockDecidesCountsWhereTheEnergyAgrees) {
  Rivals rivals;
  rivals.other().likelihoods -= values({40, -0.4, -0.5, -0.6, -0.5, -0.4});  // far less likely, by one block
  EXPECT_TRUE(rivals.are_confusable());
  rivals.leaves_more(0.25);  // in every block
  EXPECT_FALSE(rivals.are_confusable());
}

TEST(Confusable, OneWithMoreParametersHasNoDoubtInItsFavour) {
  Rivals rivals;
  rivals.less_likely(1.2);
  EXPECT_TRUE(rivals.are_confusable());
  rivals.evidence.candidates[1].signs.push_back(Sign::kAny);
  EXPECT_FALSE(rivals.are_confusable());
}

TEST(Confusable, OneThatPredictsUnseenRowsBetterForCertainStays) {
  Rivals rivals;
  rivals.less_likely(2.8);
  rivals.leaves_more(-0.3);
  EXPECT_TRUE(rivals.are_confusable());
  rivals.evidence.candidates[1].in_catalogue = false;  // a probe has no such name to defend
  EXPECT_FALSE(rivals.are_confusable());
}

TEST(Confusable, OneThatLeavesTwiceTheEnergyIsRuledOutHoweverLikely) {
  Rivals rivals;
  rivals.less_likely(-5.0);
  rivals.leaves_more(0.9);
  EXPECT_TRUE(rivals.are_confusable());
  rivals.leaves_more(0.2);  // 1.1 beyond 1
  EXPECT_FALSE(rivals.are_confusable());
}

/// 20 blocks of 30 rows: the law is a constant; the error is 0.5 of the first effect in white noise of variance 1.
struct Line {
  static constexpr Eigen::Index kBlocks = 20, kSize = 30, kRows = kBlocks * kSize;
  Line() {
    const Eigen::MatrixXd own = normals(kRows, 3, 11);
    const Eigen::VectorXd error = 0.5 * own.col(0) + normals(kRows, 1, 12);
    Candidate waiting = candidate_named("waits", own.col(0));
    waiting.waits = true;
    evidence = evidence_of({Eigen::MatrixXd::Ones(kRows, 1),
                            error,
                            {candidate_named("true", own.col(0)), candidate_named("nothing", own.col(1)),
                             candidate_named("forbidden", own.col(0), Sign::kNonPositive),
                             candidate_named("in the law", Eigen::VectorXd::Constant(kRows, 2.0)), waiting}},
                           split);
    evidence.noise_from_repeats = true;
    SieveResult luck;
    luck.candidate_p = {0.1, 0.2, 0.3, 0.4, 0.5};
    trials = try_candidates(p, evidence, luck);
  }
  Split split = split_of(kBlocks, kSize, {Role::kFit, Role::kFit, Role::kChoose});
  Preparation p = preparation_of(kRows, split);
  Evidence evidence;
  std::vector<CandidateTrial> trials;
};

TEST(TryCandidates, OnlyTheTrueOneIsDetectedAndConfirmed) {
  const Line line;
  ASSERT_EQ(line.trials.size(), 5u);
  EXPECT_TRUE(line.trials[0].possible);
  EXPECT_NEAR(line.trials[0].p_value, 1.0 / 500.0, 1e-12);  // above all 499 draws
  EXPECT_TRUE(passes(line.trials[0], line.evidence));
  EXPECT_GT(line.trials[1].p_value, 0.05);
  EXPECT_FALSE(passes(line.trials[1], line.evidence));
  EXPECT_EQ(line.trials[1].p_sieve, 0.2);  // as the sieve says
  EXPECT_FALSE(line.trials[2].possible);
  EXPECT_EQ(line.trials[2].p_value, 1.0);
  EXPECT_FALSE(line.trials[4].possible);  // it waits for another
}

/// p of an effect of which noise gains as much once in some 10^8 draws, beside another candidate.
auto p_beside(const Candidate& other) -> double {
  const Eigen::VectorXd own = normals(Line::kRows, 1, 21);
  const Split split = split_of(Line::kBlocks, Line::kSize, {Role::kFit, Role::kFit, Role::kChoose});
  Evidence evidence = evidence_of({Eigen::MatrixXd::Ones(Line::kRows, 1),
                                   0.3 * own + normals(Line::kRows, 1, 22),
                                   {candidate_named("true", own), other}},
                                  split);
  evidence.noise_from_repeats = true;
  SieveResult luck;
  luck.candidate_p = {1.0, 1.0};
  return try_candidates(preparation_of(Line::kRows, split), evidence, luck)[0].p_value;
}

TEST(TryCandidates, DrawsOfNoiseGainNoMoreWhereManyColumnsReproduceEachOther) {
  // Steps and bells of 120 widths, from what one row shows to wider than the motion, where they are nearly constants;
  // without told_apart() p came out as 0.004 to 0.3 beside them.
  constexpr int kWidths = 120;
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(Line::kRows, -1.0, 1.0);
  for (const double change : {-1e-6, 0.0, 1e-6}) {
    Candidate steps = candidate_named("steps", Eigen::MatrixXd::Zero(Line::kRows, 2));
    steps.variants.clear();
    for (int i = 0; i < kWidths; ++i) {
      const Eigen::ArrayXd in_widths = (1.0 + change) / 1e-3 * std::pow(3e3, -i / (kWidths - 1.0)) * t;
      Eigen::MatrixXd own(Line::kRows, 2);
      own << in_widths.tanh().matrix(), (-in_widths.square()).exp().matrix();
      steps.variants.push_back({{}, own, 0});
    }
    EXPECT_NEAR(p_beside(steps), 1.0 / 500.0, 1e-12) << change;
  }
}

TEST(TryCandidates, WhatIsExplainedIsTheEnergyTakenAwayOutOfFold) {
  const Line line;
  const Eigen::VectorXd law =
      cross_validated(line.evidence.raw(), line.evidence.learned, law_model(line.evidence.layout));
  const CandidateTrial& trial = line.trials[0];
  EXPECT_NEAR(trial.explained, 1.0 - trial.energies.sum() / law.sum(), 1e-12);
  EXPECT_NEAR(trial.explained, 0.2, 0.07);  // 0.25 of 1.25
  EXPECT_NEAR(trial.explained_t, t_statistic(law - trial.energies), 1e-12);
}

TEST(TryCandidates, WhatTheLawHoldsAlreadyIsAbsorbed) {
  const Line line;
  EXPECT_NEAR(line.trials[3].absorbed, 1.0, 1e-6);
  EXPECT_LT(line.trials[0].absorbed, 0.02);
}

TEST(TryCandidates, TheSmallestEffectThatWouldHaveShownFollowsFromTheEvidenceAsked) {
  // Half of the rows judge, and have to bring ln(5 / 0.01) nats: energy 4 ln 500 over all 600 rows, in variances.
  const Line line;
  EXPECT_NEAR(line.trials[0].detectable, std::sqrt(4.0 * std::log(500.0) / 600.0),
              0.02 * std::sqrt(4.0 * std::log(500.0) / 600.0));
}

TEST(TryCandidates, EvidenceIsTheMeanOfTwoRatiosInWhichEachHalfJudgesWhatTheOtherTaught) {
  const Line line;
  const auto& columns = line.evidence.columns;
  // Rows of every other block; the noise is white and known, so fits are least squares and the likelihood a sum of
  // squares, over all rows but the first eight of each block.
  const auto log_ratio = [&](Eigen::Index judging) {
    std::vector<Eigen::Index> taught, judged, own;
    for (Eigen::Index row = 0; row < Line::kRows; ++row) {
      const bool mine = row / Line::kSize % 2 == judging;
      (mine ? own : taught).push_back(row);
      if (mine && row % Line::kSize >= 8) {
        judged.push_back(row);
      }
    }
    const auto error_of = [&](const std::vector<Eigen::Index>& from, const std::vector<Eigen::Index>& used) {
      const Eigen::MatrixXd x = columns(from, used);
      const Eigen::VectorXd theta = x.colPivHouseholderQr().solve(Eigen::VectorXd(columns(from, 1)));
      return (columns(judged, 1) - columns(judged, used) * theta).squaredNorm();
    };
    return 0.5 * (error_of(own, {0}) - error_of(taught, {0, 2}));  // the law alone, noncausally
  };
  const double first = log_ratio(0);
  const double second = log_ratio(1);
  EXPECT_NEAR(line.trials[0].log_e_value, std::log(0.5 * (std::exp(first) + std::exp(second))), 1e-6);
}

TEST(TryCandidates, AnOutputTermIsJudgedByTheLawThroughIt) {
  // The law is a ramp, its change by the term a sine; the error is that change and noise.
  const Eigen::Index rows = Line::kRows;
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(rows, 0.0, 60.0);
  Eigen::MatrixXd exact(rows, 2);
  exact << t.array().sin().matrix(), t + t.array().sin().matrix();
  Candidate late = candidate_named("late", exact);
  late.acts_on_output = true;
  late.signs = {Sign::kAny};
  late.variants.push_back({{}, t.array().sin().matrix(), 0});
  const Split split = split_of(Line::kBlocks, Line::kSize, {Role::kFit, Role::kFit, Role::kChoose});
  Evidence evidence =
      evidence_of({t, Eigen::VectorXd(t.array().sin().matrix() + 0.3 * normals(rows, 1, 13)), {late}, {}, 0.09}, split);
  evidence.noise_from_repeats = true;
  SieveResult luck;
  luck.candidate_p = {1.0};
  const auto trials = try_candidates(preparation_of(rows, split), evidence, luck);
  EXPECT_TRUE(trials[0].possible);
  EXPECT_EQ(trials[0].variant, 0u);
  EXPECT_NEAR(trials[0].p_value, 1.0 / 500.0, 1e-12);
  EXPECT_NEAR(trials[0].explained, 0.5 / 0.59, 0.05);
  EXPECT_TRUE(passes(trials[0], evidence));
}

}  // namespace
}  // namespace capstan::tools
