// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/sieve.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"

namespace capstan::tools {
namespace {

using test::candidate_named;
using test::evidence_of;
using test::normals;
using test::preparation_of;
using test::split_of;

constexpr Eigen::Index kBlocks = 10, kSize = 40, kRows = kBlocks * kSize;
/// Of 299 draws: no p-value is smaller.
constexpr double kLeast = 1.0 / 300.0;
/// A p-value above this is no detection: half of the error rate that each decision is held to.
constexpr double kDecides = 0.005;

struct Case {
  explicit Case(double strength, unsigned seed, const Eigen::MatrixXd& flexible = {})
      : own(normals(kRows, 2, seed)),
        evidence(evidence_of({Eigen::MatrixXd::Ones(kRows, 1),
                              Eigen::VectorXd(strength * own.col(0) + normals(kRows, 1, seed + 1)),
                              {candidate_named("true", own.col(0)), candidate_named("nothing", own.col(1)),
                               candidate_named("forbidden", own.col(0), Sign::kNonPositive)},
                              flexible},
                             split)) {}
  [[nodiscard]] auto run() const -> SieveResult { return sieve(preparation_of(kRows, split), evidence); }
  Split split = split_of(kBlocks, kSize, {Role::kFit});
  Eigen::MatrixXd own;
  Evidence evidence;
};

TEST(Sieve, AnEffectThatPredictsAcrossHalvesIsBeyondAllDraws) {
  const SieveResult result = Case(0.5, 21).run();
  ASSERT_EQ(result.candidate_p.size(), 3u);
  EXPECT_NEAR(result.candidate_p[0], kLeast, 1e-12);
  EXPECT_GT(result.candidate_p[1], kDecides);
  EXPECT_GT(result.candidate_p[2], kDecides);  // physics forbids the sign that the data ask for
}

TEST(Sieve, NoiseAloneIsSeldomFoundToBeAnything) {
  // Five in a hundred p-values of noise are below 0.05; the chance of more than six in forty is 0.3 %.
  int found = 0;
  for (unsigned seed = 100; seed < 140; ++seed) {
    const SieveResult result = Case(0.0, 3 * seed).run();
    found += *std::min_element(result.candidate_p.begin(), result.candidate_p.end()) < 0.05 ? 1 : 0;
  }
  EXPECT_LE(found, 6);
}

TEST(Sieve, NoiseWithAMemoryIsNotTakenForASlowEffect) {
  // A slow wave beside noise that wanders as slowly: white draws would call it beyond luck.
  Eigen::VectorXd error = normals(kRows, 1, 31);
  for (Eigen::Index i = 1; i < kRows; ++i) {
    error[i] += 0.95 * error[i - 1];
  }
  const Eigen::VectorXd wave = Eigen::ArrayXd::LinSpaced(kRows, 0.0, 12.0).sin().matrix();
  Case with_memory(0.0, 32);
  with_memory.evidence =
      evidence_of({Eigen::MatrixXd::Ones(kRows, 1), error, {candidate_named("wave", wave)}}, with_memory.split);
  with_memory.evidence.noise.coefficients = Eigen::VectorXd::Constant(1, 0.95);
  for (Eigen::Index i = kRows - 1; i > 0; --i) {
    with_memory.evidence.white_error[i] -= 0.95 * error[i - 1];
  }
  EXPECT_GT(with_memory.run().candidate_p[0], kDecides);
}

TEST(Sieve, TheCeilingSeesWhatNoNameStandsFor) {
  const Eigen::MatrixXd flexible = normals(kRows, 1, 41);
  Case unnamed(0.0, 42, flexible);
  EXPECT_GT(unnamed.run().flexible_p, kDecides);
  unnamed.evidence = evidence_of({Eigen::MatrixXd::Ones(kRows, 1),
                                  Eigen::VectorXd(0.5 * flexible.col(0) + normals(kRows, 1, 43)),
                                  {candidate_named("nothing", unnamed.own.col(1))},
                                  flexible},
                                 unnamed.split);
  const SieveResult result = unnamed.run();
  EXPECT_NEAR(result.flexible_p, kLeast, 1e-12);
  EXPECT_GT(result.candidate_p[0], kDecides);
}

TEST(Sieve, AnOutputTermsDrawsStandBesideTheLaw) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(kRows, 0.0, 60.0);
  Eigen::MatrixXd exact(kRows, 2);
  exact << t.array().sin().matrix(), t + t.array().sin().matrix();
  Candidate late = candidate_named("late", exact);
  late.acts_on_output = true;
  late.signs = {Sign::kAny};
  late.variants.push_back({{}, t.array().sin().matrix(), 0});
  Case output(0.0, 51);
  output.evidence =
      evidence_of({t, Eigen::VectorXd(t.array().sin().matrix() + normals(kRows, 1, 52)), {late}}, output.split);
  EXPECT_NEAR(output.run().candidate_p[0], kLeast, 1e-12);
  output.evidence = evidence_of({t, normals(kRows, 1, 53), {late}}, output.split);
  EXPECT_GT(output.run().candidate_p[0], kDecides);
}

TEST(Sieve, WhatHoldsInEachHalfForItselfPredictsNothingAcrossThem) {
  Case turning(0.0, 81);
  Eigen::VectorXd error = normals(kRows, 1, 82);
  for (Eigen::Index i = 0; i < kRows; ++i) {  // the halves are every other block
    error[i] += (i / kSize % 2 == 0 ? 0.8 : -0.8) * turning.own(i, 0);
  }
  turning.evidence = evidence_of(
      {Eigen::MatrixXd::Ones(kRows, 1), error, {candidate_named("turning", turning.own.col(0))}}, turning.split);
  EXPECT_GT(turning.run().candidate_p[0], 0.5);
}

TEST(Sieve, AResidualOfNothingIsNoDetection) {
  Case nothing(0.0, 71, normals(kRows, 1, 72));
  nothing.evidence = evidence_of({Eigen::MatrixXd::Ones(kRows, 1),
                                  Eigen::VectorXd::Zero(kRows),
                                  {candidate_named("any", nothing.own.col(0))},
                                  nothing.own.col(1)},
                                 nothing.split);
  const SieveResult result = nothing.run();
  EXPECT_EQ(result.candidate_p[0], 1.0);
  EXPECT_EQ(result.flexible_p, 1.0);
}

TEST(Sieve, TheSameLogGetsTheSameAnswer) {
  const SieveResult first = Case(0.1, 61).run();
  const SieveResult second = Case(0.1, 61).run();
  EXPECT_EQ(first.candidate_p, second.candidate_p);
  EXPECT_EQ(first.flexible_p, second.flexible_p);
}

}  // namespace
}  // namespace capstan::tools
