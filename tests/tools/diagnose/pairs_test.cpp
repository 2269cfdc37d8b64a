// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/pairs.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"

namespace capstan::tools {
namespace {

using test::candidate_named;
using test::evidence_of;
using test::normals;
using test::split_of;

constexpr Eigen::Index kBlocks = 12, kSize = 20, kRows = kBlocks * kSize;

/// Terms by their names alone.
auto catalogue_of(const std::vector<std::string>& names, const std::vector<std::string>& doubles_of_first = {})
    -> Catalogue {
  std::vector<CatalogueTerm> terms;
  for (const auto& name : names) {
    CatalogueTerm term;
    term.name = name;
    terms.push_back(term);
  }
  terms.front().doubles = doubles_of_first;
  return {TargetKind::kAngle, "rad", "rad", terms};
}

/// What a constant leaves: the sum of the first two of four effects, and noise.
struct Two {
  Two() : own(normals(kRows, 4, 1)), error(own.col(0) - own.col(1) + 0.3 * normals(kRows, 1, 2)) {
    for (Eigen::Index i = 0; i < 4; ++i) {
      candidates.push_back(candidate_named(std::string(1, "abcd"[i]), own.col(i)));
    }
  }
  [[nodiscard]] auto evidence() const -> Evidence {
    return evidence_of({Eigen::MatrixXd::Ones(kRows, 1), error, candidates},
                       split_of(kBlocks, kSize, {Role::kFit, Role::kChoose}));
  }
  Eigen::MatrixXd own;
  Eigen::VectorXd error;
  std::vector<Candidate> candidates;
  Catalogue catalogue = catalogue_of({"a", "b", "c", "d"});
};

TEST(Pairs, TwoThatTogetherExplainWhatNeitherDoesAreFound) {
  const Two two;
  const auto pair = best_pair(two.evidence(), two.catalogue);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->candidate[0], 0u);
  EXPECT_EQ(pair->candidate[1], 1u);
  EXPECT_NEAR(pair->energies.sum() / kRows, 0.09, 0.02);  // the noise
}

TEST(Pairs, TheBestSettingOfEachIsTaken) {
  Two two;
  two.candidates[0].variants.insert(two.candidates[0].variants.begin(), {{}, normals(kRows, 1, 7), 0});
  two.candidates[1].variants.push_back({{}, normals(kRows, 1, 8), 0});
  const auto pair = best_pair(two.evidence(), two.catalogue);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->variant[0], 1u);
  EXPECT_EQ(pair->variant[1], 0u);
}

TEST(Pairs, NoneIsNamedWhereAnotherDoesAsWell) {
  Two two;
  two.candidates[2] = candidate_named("c", two.own.col(0) + 0.01 * two.own.col(2));  // all but the first
  EXPECT_FALSE(best_pair(two.evidence(), two.catalogue));
}

TEST(Pairs, APairThatHoldsThisOneAsASpecialCaseIsNoRival) {
  Two two;
  Eigen::MatrixXd general(kRows, 2);
  general << two.own.col(1), two.own.col(3);
  two.candidates[2] = candidate_named("c", general);
  EXPECT_FALSE(best_pair(two.evidence(), two.catalogue));
  two.candidates[2].special_cases = {"b"};
  const auto pair = best_pair(two.evidence(), two.catalogue);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->candidate[0], 0u);
  EXPECT_EQ(pair->candidate[1], 1u);
  two.error += 0.5 * two.own.col(3);  // which only the general one explains
  const auto wider = best_pair(two.evidence(), two.catalogue);
  ASSERT_TRUE(wider);
  EXPECT_EQ(wider->candidate[1], 2u);
}

TEST(Pairs, EffectsThatPassForEachOtherAreNoPair) {
  Two two;
  two.candidates.resize(2);
  EXPECT_TRUE(best_pair(two.evidence(), two.catalogue));
  EXPECT_FALSE(best_pair(two.evidence(), catalogue_of({"a", "b"}, {"b"})));
  EXPECT_FALSE(best_pair(two.evidence(), catalogue_of({"b", "a"}, {"a"})));
}

TEST(Pairs, OneThatWaitsComesWithWhatItWaitsForOrNotAtAll) {
  Two two;
  two.candidates.resize(2);
  two.candidates[1].waits = true;
  two.candidates[1].builds_on = {"c"};
  EXPECT_FALSE(best_pair(two.evidence(), two.catalogue));
  two.candidates[1].builds_on = {"c", "a"};
  EXPECT_TRUE(best_pair(two.evidence(), two.catalogue));
}

TEST(Pairs, AProbeIsNoPartOfOneAndTwoOutputTermsAreNone) {
  Two two;
  two.candidates.resize(2);
  two.candidates[1].in_catalogue = false;
  EXPECT_FALSE(best_pair(two.evidence(), two.catalogue));
  two.candidates[1].in_catalogue = true;
  two.candidates[0].acts_on_output = two.candidates[1].acts_on_output = true;
  EXPECT_FALSE(best_pair(two.evidence(), two.catalogue));
}

TEST(Pairs, ASignThatPhysicsForbidsTakesAPartAway) {
  Two two;
  two.candidates.resize(2);
  two.candidates[1].signs = {Sign::kNonNegative};  // the data ask for -1
  const auto pair = best_pair(two.evidence(), two.catalogue);
  ASSERT_TRUE(pair);
  EXPECT_NEAR(pair->energies.sum() / kRows, 1.09, 0.2);  // the second effect stays
}

TEST(Pairs, BesideAnOutputTermTheLawGoesThroughIt) {
  // The term's change of the law is the first column, the law through it the second; its other setting is not tried.
  Two two;
  const Eigen::VectorXd law = normals(kRows, 1, 20);
  const Eigen::VectorXd change = normals(kRows, 1, 21);
  Eigen::MatrixXd exact(kRows, 2);
  exact << change, law + change;
  Candidate late = candidate_named("a", exact);
  late.acts_on_output = true;
  late.signs = {Sign::kAny};
  late.variants.push_back({{}, change, 0});
  for (const bool first : {true, false}) {
    std::vector<Candidate> both = {late, candidate_named("b", two.own.col(1), Sign::kNonPositive)};
    if (!first) {
      std::swap(both[0], both[1]);
    }
    const Evidence evidence = evidence_of({law, change - 2.0 * two.own.col(1) + 0.3 * normals(kRows, 1, 22), both},
                                          split_of(kBlocks, kSize, {Role::kFit, Role::kChoose}));
    const auto pair = best_pair(evidence, two.catalogue);
    ASSERT_TRUE(pair);
    EXPECT_EQ(pair->variant[0], 0u);
    EXPECT_NEAR(pair->energies.sum() / kRows, 0.09, 0.02);
  }
}

TEST(Pairs, ByTheirNames) {
  const Two two;
  const Evidence evidence = two.evidence();
  const auto pair = pair_of(evidence, {"d", "b"});
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->candidate[0], 1u);
  EXPECT_EQ(pair->candidate[1], 3u);
  EXPECT_FALSE(pair_of(evidence, {"b", "x"}));
  EXPECT_FALSE(pair_of(evidence, {"b"}));
}

TEST(Pairs, OfNothingThereIsNone) {
  Two two;
  two.candidates.resize(1);
  EXPECT_FALSE(best_pair(two.evidence(), two.catalogue));
}

}  // namespace
}  // namespace capstan::tools
