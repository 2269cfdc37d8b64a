// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/round.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"

namespace capstan::tools {
namespace {

/// Three candidates, of which the last is a probe; every trial passes and leaves 10 in the measured quantity.
struct Three {
  Three() {
    for (const char* name : {"a", "b", "probe"}) {
      round.evidence.candidates.push_back(test::candidate_named(name, Eigen::MatrixXd::Zero(1, 1)));
    }
    round.evidence.candidates[2].in_catalogue = false;
    round.trials.resize(3);
    for (std::size_t i = 0; i < 3; ++i) {
      CandidateTrial& trial = round.trials[i];
      trial.candidate = i;
      trial.possible = true;
      trial.explained = 0.5;
      trial.explained_t = 5.0;
      trial.p_value = trial.p_sieve = 0.002;
      trial.log_e_value = 20.0;
      trial.log_likelihood = 100.0;
      trial.energies = Eigen::VectorXd::Constant(5, 2.0);
    }
  }
  [[nodiscard]] auto best(bool catalogue_only = false) const -> std::string {
    const CandidateTrial* trial = best_passing(round, catalogue_only);
    return trial == nullptr ? "" : round.evidence.candidates[trial->candidate].name;
  }
  Round round;
};

TEST(BestPassing, OfAllThatAreAsLikelyTheOneThatExplainsMost) {
  Three three;
  three.round.trials[1].explained = 0.6;
  EXPECT_EQ(three.best(), "b");
  three.round.trials[2].explained = 0.7;
  EXPECT_EQ(three.best(), "probe");
  EXPECT_EQ(three.best(true), "b");
}

TEST(BestPassing, NobodyWhereNobodyPasses) {
  Three three;
  for (auto& trial : three.round.trials) {
    trial.possible = false;
  }
  EXPECT_EQ(three.best(), "");
}

TEST(BestPassing, WhatEvidencePutsBehindTheMostLikelyIsOut) {
  Three three;
  three.round.trials[1].explained = 0.6;
  three.round.trials[1].log_likelihood = 100.0 - std::log(300.0) + 0.01;  // three candidates at 1 %
  EXPECT_EQ(three.best(), "b");
  three.round.trials[1].log_likelihood -= 0.02;
  EXPECT_EQ(three.best(), "a");
  three.round.evidence.by_energy = true;  // an effort is not judged by likelihood
  EXPECT_EQ(three.best(), "b");
}

TEST(BestPassing, WhatLeavesHalfAsMuchAgainAsTheLeastIsOutHoweverLikely) {
  Three three;
  three.round.trials[1].log_likelihood = 1000.0;
  EXPECT_EQ(three.best(), "b");
  three.round.trials[1].energies *= 1.51;
  EXPECT_EQ(three.best(), "a");
}

TEST(Summary, SaysOfEveryCandidateWhyMostLikelyFirst) {
  Three three;
  auto& trials = three.round.trials;
  three.round.adequacy.lacks_something = true;
  three.round.adequacy.reducible_share = 0.4;
  const auto outcome_of = [&](const std::string& name, const CandidateTrial* chosen,
                              std::vector<std::size_t> confusable) {
    for (const auto& ranked : summary_of(three.round, chosen, confusable).ranking) {
      if (ranked.name == name) {
        return ranked.outcome;
      }
    }
    return std::string("not ranked");
  };
  EXPECT_EQ(outcome_of("a", &trials[0], {}), "explains the residual best");
  EXPECT_EQ(outcome_of("b", &trials[0], {1}), "this log cannot distinguish it from the best");
  EXPECT_EQ(outcome_of("b", &trials[0], {}), "ruled out: the best explains significantly more");
  trials[1].explained = 0.0;
  EXPECT_EQ(outcome_of("b", &trials[0], {}), "not confirmed on unseen rows");
  trials[1].p_value = 0.3;
  EXPECT_EQ(outcome_of("b", &trials[0], {}), "not detected");
  trials[1].absorbed = 0.995;
  EXPECT_EQ(outcome_of("b", &trials[0], {}), "not identifiable beside the law on this motion");
  trials[1].possible = false;
  EXPECT_EQ(outcome_of("b", &trials[0], {}), "ruled out: the data give a sign that is physically impossible");
  three.round.evidence.candidates[1].waits = true;
  three.round.evidence.candidates[1].builds_on = {"a", "c"};
  EXPECT_EQ(outcome_of("b", nullptr, {}), "waits for a or c");

  trials[2].log_likelihood = 200.0;
  trials[2].p_sieve = 0.8;
  trials[2].p_value = 0.7;
  const RoundSummary summary = summary_of(three.round, nullptr, {});
  EXPECT_TRUE(summary.lacks_something);
  EXPECT_EQ(summary.reducible_share, 0.4);
  EXPECT_EQ(summary.ranking.front().name, "probe");
  EXPECT_FALSE(summary.ranking.front().in_catalogue);
  EXPECT_EQ(summary.ranking.front().p_value, 1.0);  // twice the smaller one, as there are two ways
  EXPECT_NEAR(summary.ranking[1].p_value, 0.004, 1e-12);
}

TEST(Rounds, CandidatesAreFoundByName) {
  const Three three;
  EXPECT_EQ(trial_of(three.round, "b"), &three.round.trials[1]);
  EXPECT_EQ(trial_of(three.round, "z"), nullptr);
  EXPECT_EQ(names_of(three.round, {2, 0}), (std::vector<std::string>{"probe", "a"}));
}

}  // namespace
}  // namespace capstan::tools
