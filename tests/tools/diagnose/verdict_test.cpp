// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"

namespace capstan::tools {
namespace {

using test::preparation_of;
using test::split_of;

auto found(const std::vector<std::string>& names, double share = 0.95) -> Search {
  Search search;
  for (const auto& name : names) {
    search.effects.emplace_back();
    search.effects.back().name = name;
  }
  search.share = {share, share};
  return search;
}

auto says(const Diagnosis& d, const std::string& words) -> bool {
  return d.reason.find(words) != std::string::npos;
}

TEST(Judge, NothingFoundAndNothingLackingIsNothingMissing) {
  Diagnosis d;
  EXPECT_EQ(judge({}, d), Verdict::kNothingMissing);
  EXPECT_FALSE(d.next_experiment);
}

TEST(Judge, SomethingWithoutANameIsUnknownAndSaysWhatItIsLike) {
  Search search;
  search.lacks_something = true;
  Diagnosis d;
  EXPECT_EQ(judge(search, d), Verdict::kUnknown);
  EXPECT_EQ(*d.next_experiment, kEverything);
  search.unlisted = "wear";
  EXPECT_EQ(judge(search, d), Verdict::kUnknown);
  EXPECT_TRUE(says(d, "most like wear"));
  search.unlisted = "axis3/q1";
  judge(search, d);
  EXPECT_NE(d.next_experiment->find("--coupled-to 3"), std::string::npos);
}

TEST(Judge, AnEffectIsNamedWhereItIsCertainToExplainHalf) {
  Diagnosis d;
  EXPECT_EQ(judge(found({"play"}, 0.5), d), Verdict::kEffect);
  EXPECT_TRUE(says(d, "The law lacks play"));
  EXPECT_EQ(judge(found({"play"}, 0.49), d), Verdict::kUnknown);
  EXPECT_TRUE(says(d, "49 %"));
  EXPECT_EQ(judge(found({"play"}, -0.3), d), Verdict::kUnknown);
  EXPECT_TRUE(says(d, " 0 %"));  // not less than nothing
}

TEST(Judge, BesideSomethingUnlistedItHasToExplainNineTenths) {
  Search search = found({"play", "gravity"}, 0.89);
  search.lacks_something = true;
  Diagnosis d;
  EXPECT_EQ(judge(search, d), Verdict::kUnknown);
  search.share.lower = 0.9;
  EXPECT_EQ(judge(search, d), Verdict::kEffectPlusUnlisted);
  EXPECT_TRUE(says(d, "play and gravity"));
  search.unlisted = "wear";
  judge(search, d);
  EXPECT_TRUE(says(d, "(most like wear)"));
  search.share.lower = 0.98;  // what is left may be the terms' form
  EXPECT_EQ(judge(search, d), Verdict::kEffect);
}

TEST(Judge, UpToThreeListedAlternativesAreAnAnswer) {
  Search search = found({"play"});
  search.effects.front().alternatives = {"presliding"};
  Diagnosis d;
  EXPECT_EQ(judge(search, d), Verdict::kAmbiguous);
  EXPECT_TRUE(says(d, "play or presliding"));
  EXPECT_NE(d.next_experiment->find(catalogue_term("presliding").exciting_motion), std::string::npos);
  search.effects.front().alternatives = {"presliding", "gravity", "thermal_drift"};
  EXPECT_EQ(judge(search, d), Verdict::kAmbiguous);
  search.effects.front().alternatives.emplace_back("angle_periodic");
  EXPECT_EQ(judge(search, d), Verdict::kUnknown);
  search.effects.front().alternatives = {"sticky_spot"};  // a probe
  EXPECT_EQ(judge(search, d), Verdict::kUnknown);
  EXPECT_TRUE(says(d, "cannot distinguish play from sticky_spot"));
}

TEST(CandidateShares, AreThoseOfTheFirstRoundMostFirst) {
  Search search;
  EXPECT_TRUE(candidate_shares(search).empty());
  RoundSummary first;
  const auto add = [&](const char* name, double explained, bool listed = true) {
    RankedEffect ranked;
    ranked.name = name;
    ranked.in_catalogue = listed;
    ranked.explained = explained;
    first.ranking.push_back(ranked);
  };
  add("a", 0.1);
  add("probe", 0.9, false);
  add("b", 0.5);
  add("none", 0.0);
  add("c", 0.2);
  add("d", 0.4);
  add("e", 0.3);
  add("f", 0.05);
  search.rounds = {first, {}};
  const auto shares = candidate_shares(search);
  std::vector<std::string> names;
  for (const auto& one : shares) {
    names.push_back(one.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"b", "d", "e", "c", "a"}));
  EXPECT_EQ(shares.front().share, 0.5);
}

/// A log of 200 rows, half of them to report on. The target is 1 and -1 in turn, the error of both laws as wished.
struct Reported {
  Reported() {
    Samples samples(200);
    Eigen::VectorXd target(200);
    for (Eigen::Index i = 0; i < 200; ++i) {
      target[i] = i % 2 == 0 ? 1.0 : -1.0;
    }
    p = preparation_of(samples, target, split_of(10, 20, {Role::kFit, Role::kReport}));
    p.repeats = Repeats{0, 50, 4};
    d.verdict = Verdict::kNothingMissing;
    d.noise_floor = 0.1;
    d.target = "axis2/q2_rad";
    set_before(0.11);
  }
  void set_before(double rmse) {
    d.before.rmse = rmse;
    d.traces.before = p.target.array() + rmse;
  }
  /// The running switch is wrong in a tenth of the rows, so many in a row, where the estimate errs by `there`; else it
  /// errs by `elsewhere`.
  void err_late(double there, double elsewhere, std::size_t rows = 2) {
    Samples late = p.noncausal.samples()[0];
    Eigen::VectorXd error = Eigen::VectorXd::Constant(200, elsewhere);
    for (std::size_t i = 0; i < 200; ++i) {
      if (i % (10 * rows) < rows) {
        late[i].forward = !late[i].forward;
        error[static_cast<Eigen::Index>(i)] = there;
      }
    }
    p.causal = LawDesign({late}, {1.0});
    d.traces.before = p.target + error;
    d.before.rmse = std::sqrt(0.1 * there * there + 0.9 * elsewhere * elsewhere);
  }
  void reconcile_with(LawStatus status, const Search& search = {}) {
    LawChoice choice;
    choice.status = status;
    reconcile(p, search, choice, d);
  }
  Preparation p = preparation_of(1, {});
  Diagnosis d;
};

TEST(Reconcile, WhatIsCompleteStays) {
  Reported log;
  log.d.detectable = {{"play", 0.02}};
  log.reconcile_with(LawStatus::kBase);
  EXPECT_EQ(log.d.verdict, Verdict::kNothingMissing);
  ASSERT_EQ(log.d.warnings.size(), 1u);
  EXPECT_NE(log.d.warnings[0].find("play 0.02"), std::string::npos);
}

TEST(Reconcile, NothingIsMissingOnlyWhereNoOtherLawDoesBetter) {
  Reported log;
  log.reconcile_with(LawStatus::kProvisional);
  EXPECT_EQ(log.d.verdict, Verdict::kUnknown);
  EXPECT_EQ(*log.d.next_experiment, kEverything);
}

TEST(Reconcile, NothingIsMissingOnlyWithinTwelveTenthsOfTheFloor) {
  Reported log;
  log.set_before(0.119);
  log.reconcile_with(LawStatus::kBase);
  EXPECT_EQ(log.d.verdict, Verdict::kNothingMissing);
  log.set_before(0.121);
  log.reconcile_with(LawStatus::kBase);
  EXPECT_EQ(log.d.verdict, Verdict::kUnknown);
  EXPECT_TRUE(says(log.d, "1.2 times the noise"));
}

TEST(Reconcile, AForceLawIsNotHeldToTheFloorAsAGridRoundsIt) {
  Reported log;
  const Catalogue forces(TargetKind::kForce, "Nm", "rad", {});
  log.d.base = JointFile(forces);
  log.set_before(1.0);
  log.reconcile_with(LawStatus::kBase);
  EXPECT_EQ(log.d.verdict, Verdict::kNothingMissing);
}

TEST(Reconcile, ErrorsWhereTheSwitchIsLateAreNoFaultOfTheLaw) {
  Reported log;
  log.err_late(1.0, 0.1);  // 0.1 of 0.109 mean squares lie there
  log.reconcile_with(LawStatus::kBase);
  EXPECT_EQ(log.d.verdict, Verdict::kNothingMissing);
  ASSERT_FALSE(log.d.warnings.empty());
  EXPECT_NE(log.d.warnings[0].find("encoder"), std::string::npos);
  log.d.warnings.clear();
  log.err_late(0.3, 0.3);  // as large elsewhere
  log.reconcile_with(LawStatus::kBase);
  EXPECT_EQ(log.d.verdict, Verdict::kUnknown);
}

TEST(Reconcile, ASwitchThatIsLateByOneRowAsksForAHigherRateAndForNoEncoder) {
  Reported log;
  log.err_late(1.0, 0.1, 1);
  log.reconcile_with(LawStatus::kBase);
  EXPECT_EQ(log.d.verdict, Verdict::kNothingMissing);
  ASSERT_FALSE(log.d.warnings.empty());
  EXPECT_NE(log.d.warnings[0].find("log at a higher rate"), std::string::npos);
  EXPECT_EQ(log.d.warnings[0].find("encoder"), std::string::npos);
}

TEST(Reconcile, WithoutRepeatsNoEffectOfATenthOfTheMotionMayHide) {
  Reported log;
  log.p.repeats.reset();
  log.d.detectable = {{"play", 0.02}, {"gravity", 0.09}};
  log.reconcile_with(LawStatus::kBase);
  EXPECT_EQ(log.d.verdict, Verdict::kNothingMissing);
  EXPECT_EQ(log.d.warnings.size(), 2u);  // and that a weak one may
  log.d.detectable[1].rmse = 0.11;       // the target's rms about its mean is 1
  log.reconcile_with(LawStatus::kBase);
  EXPECT_EQ(log.d.verdict, Verdict::kUnknown);
  log.d.verdict = Verdict::kNothingMissing;
  log.d.detectable.clear();  // nothing was tried: anything may hide
  log.reconcile_with(LawStatus::kBase);
  EXPECT_EQ(log.d.verdict, Verdict::kUnknown);
}

TEST(Reconcile, RepeatsThatDifferByMoreThanATenthOfTheMotionMayHideEffectsToo) {
  Reported log;
  log.d.noise_floor = 0.3;  // a joint that stuck in one of them
  log.set_before(0.3);
  log.d.detectable = {{"play", 0.11}};
  log.reconcile_with(LawStatus::kBase);
  EXPECT_EQ(log.d.verdict, Verdict::kUnknown);
  EXPECT_TRUE(says(log.d, "the repeated cycles differ by 30 % of the motion"));
  log.d.verdict = Verdict::kNothingMissing;
  log.d.detectable = {{"play", 0.09}};  // noise averages out in a long log
  log.reconcile_with(LawStatus::kBase);
  EXPECT_EQ(log.d.verdict, Verdict::kNothingMissing);
}

TEST(Reconcile, AnEffectIsTheWholeAnswerOnlyWhereTheLawDeliveredHasNoMore) {
  Reported log;
  log.d.verdict = Verdict::kEffect;
  log.d.reason = "as it was";
  log.d.after.rmse = 0.1;
  log.reconcile_with(LawStatus::kConfirmed, found({"play"}));
  EXPECT_EQ(log.d.reason, "as it was");
  log.d.after.rmse = 0.13;
  log.reconcile_with(LawStatus::kConfirmed, found({"play"}));
  EXPECT_EQ(log.d.verdict, Verdict::kEffect);
  EXPECT_TRUE(says(log.d, "no effect of the catalogue lowers the error further"));
  log.d.after.rmse = 0.1;
  log.reconcile_with(LawStatus::kProvisional, found({"play"}));
  EXPECT_EQ(log.d.verdict, Verdict::kEffectPlusUnlisted);
  EXPECT_TRUE(says(log.d, kMoreThanNamed));
}

TEST(Reconcile, ANamedLawThatGainsNothingAsItRunsIsSaid) {
  Reported log;
  log.d.verdict = Verdict::kEffect;
  log.d.effects = found({"play"}).effects;
  LawChoice choice;
  choice.status = LawStatus::kConfirmed;
  choice.is_named = true;
  log.d.ratio_ci95 = {0.9, 1.01};
  reconcile(log.p, found({"play"}), choice, log.d);
  EXPECT_EQ(log.d.warnings.size(), 1u);
  log.d.warnings.clear();
  log.d.ratio_ci95 = {0.5, 0.99};
  reconcile(log.p, found({"play"}), choice, log.d);
  EXPECT_TRUE(log.d.warnings.empty());
}

TEST(HoldToOwnLogs, ALawThatLeavesMoreThanItDidOfItsOwnHasGotSomething) {
  Reported log;
  log.p.target.setZero();  // a camera without noise
  JointFile law;
  hold_to_own_logs(log.p, law, log.d);
  EXPECT_EQ(log.d.verdict, Verdict::kNothingMissing);  // nobody wrote down what it left
  law.fit.emplace();
  law.fit->rmse = 0.1;
  log.d.before.rmse = 0.119;
  hold_to_own_logs(log.p, law, log.d);
  EXPECT_EQ(log.d.verdict, Verdict::kNothingMissing);
  log.d.before.rmse = 0.13;
  hold_to_own_logs(log.p, law, log.d);
  EXPECT_EQ(log.d.verdict, Verdict::kUnknown);
  EXPECT_TRUE(says(log.d, "1.3 times the error on its own logs"));
  log.d.verdict = Verdict::kEffect;
  hold_to_own_logs(log.p, law, log.d);
  EXPECT_EQ(log.d.verdict, Verdict::kEffect);
}

TEST(UnnamedPart, OnlyALawWithoutANameHasOne) {
  Reported log;
  LawChoice choice;
  choice.status = LawStatus::kConfirmed;
  choice.law.terms = {"motor_angle", "joint_offset", "presliding"};
  EXPECT_FALSE(unnamed_part(log.p, choice, log.d));
  choice.status = LawStatus::kProvisional;
  log.d.base.terms = choice.law.terms;  // the base law has all of it
  EXPECT_FALSE(unnamed_part(log.p, choice, log.d));
}

TEST(UnnamedPart, SaysWhatItDependsOnAndHowMuchItTakesAway) {
  Reported log;
  log.p.logs.front().others.push_back({4, {}, {}});
  log.d.base.terms = {"motor_angle", "joint_offset"};
  log.d.before.rmse = 0.5;
  log.d.after.rmse = 0.3;  // 1 - 0.36
  LawChoice choice;
  choice.status = LawStatus::kProvisional;
  choice.law.terms = {"hysteresis",         "motor_angle",          "joint_offset", "curved_ratio",
                      "coupled_hysteresis", "coupled_hysteresis_2", "thermal_drift"};
  const CatalogueTerm& stage = choice.law.catalogue->term("hysteresis");
  choice.law.parameters.shapes[stage.first_shape] = 0.1;
  choice.law.parameters.shapes[stage.first_shape + 1] = 0.5;
  const auto part = unnamed_part(log.p, choice, log.d);
  ASSERT_TRUE(part);
  EXPECT_NE(std::find(part->signals.begin(), part->signals.end(), "axis2/q1"), part->signals.end());
  EXPECT_NE(std::find(part->signals.begin(), part->signals.end(), "axis4/q1"), part->signals.end());
  EXPECT_NE(std::find(part->signals.begin(), part->signals.end(), "another axis"), part->signals.end());
  EXPECT_NE(std::find(part->signals.begin(), part->signals.end(), "time"), part->signals.end());
  EXPECT_NE(part->form.find("hysteresis + "), std::string::npos);
  EXPECT_NE(part->form.find("curve"), std::string::npos);
  EXPECT_NEAR(part->share, 0.64, 1e-12);
  EXPECT_NEAR(part->rmse, 0.8 * 0.5, 1e-12);
  EXPECT_NE(part->sentence.find("64 %"), std::string::npos);
}

TEST(UnnamedPart, ATableDependsOnTheSignalItIsDrawnOver) {
  Reported log;
  log.d.base.terms = {"motor_angle", "joint_offset"};
  LawChoice choice;
  choice.status = LawStatus::kProvisional;
  choice.law.terms = {"motor_angle", "joint_offset", "table"};
  const std::size_t first = choice.law.catalogue->term("table").first_shape;
  auto& shapes = choice.law.parameters.shapes;
  shapes[first] = static_cast<double>(TableSignal::kTorque);
  shapes[first + 4] = static_cast<double>(TableFactor::kOne);
  auto part = unnamed_part(log.p, choice, log.d);
  ASSERT_TRUE(part);
  EXPECT_EQ(part->signals, std::vector<std::string>{"axis2/tau"});
  EXPECT_EQ(part->form, "curve");
  shapes[first] = static_cast<double>(TableSignal::kMotorAngle);
  shapes[first + 4] = static_cast<double>(TableFactor::kRate);
  part = unnamed_part(log.p, choice, log.d);
  EXPECT_EQ(part->signals, std::vector<std::string>{"axis2/q1"});
  EXPECT_EQ(part->form, std::string("curve times ") + describe(TableFactor::kRate));
  shapes[first] = static_cast<double>(TableSignal::kWarmth);
  EXPECT_EQ(unnamed_part(log.p, choice, log.d)->signals, std::vector<std::string>{describe(TableSignal::kWarmth)});
}

TEST(GainsNothing, CountsOnlyWhereTheRunningSwitchKnowsTheDirection) {
  constexpr Eigen::Index kRows = 200;
  Samples samples(kRows);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].forward = i % 2 == 0;
  }
  Preparation p = preparation_of(samples, Eigen::VectorXd::Ones(kRows), split_of(10, 20, {Role::kFit, Role::kReport}));
  Samples late = samples;
  for (std::size_t i = 0; i < late.size(); i += 10) {
    late[i].forward = !late[i].forward;
  }
  p.causal = p.causal.with({late});
  Diagnosis d;
  d.traces.before = Eigen::VectorXd::Zero(kRows);
  d.traces.after = Eigen::VectorXd::Constant(kRows, 0.03);
  EXPECT_TRUE(gains_nothing(p, d));  // 6 % of the energy
  d.traces.after.setConstant(0.05);
  EXPECT_FALSE(gains_nothing(p, d));  // 10 %
  d.traces.after.setConstant(0.03);
  for (Eigen::Index i = 0; i < kRows; i += 10) {
    d.traces.after[i] = 1.0;  // all of it where the switch is late
  }
  EXPECT_TRUE(gains_nothing(p, d));
}

}  // namespace
}  // namespace capstan::tools
