// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/noncausal_samples.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tests/tools/synthetic_joint.hpp"
#include "capstan/tools/diagnose/round.hpp"
#include "capstan/tools/diagnose/verdict.hpp"

namespace capstan::tools {
namespace {

constexpr double kStep = 2.0 * std::numbers::pi / 8192.0;
constexpr double kPeriod = 0.001;

/// A cosine, read through an encoder: reversals every half period of 2 s, at known samples.
auto swinging() -> AxisLog {
  AxisLog log;
  log.period_s = kPeriod;
  log.time_s = Eigen::VectorXd::LinSpaced(8000, 0.0, 7.999);
  log.q1_rad = (log.time_s.array() * std::numbers::pi).cos();
  log.q1_rad = (log.q1_rad.array() / kStep).floor() * kStep;
  log.tau_nm = Eigen::VectorXd::Zero(8000);
  return log;
}

TEST(NoncausalSamples, TheDirectionTurnsWhereTheMotorDidWhileTheCausalSwitchIsLate) {
  const AxisLog log = swinging();
  ConditionerShape<double> shape;
  shape.direction_threshold_rad = 2.5 * kStep;
  const NoncausalSamples noncausal = noncausal_samples(log, shape, {kStep, 0.0});
  const auto known = direction_changes(noncausal.samples);
  const auto noticed = direction_changes(causal_samples(log, shape));
  ASSERT_EQ(known.size(), noticed.size());
  for (std::size_t i = 1; i < known.size(); ++i) {
    const double truth = 1000.0 * static_cast<double>(i);
    EXPECT_NEAR(static_cast<double>(known[i]), truth, 8.0);
    EXPECT_GT(static_cast<double>(noticed[i]) - truth, 15.0);
  }
}

TEST(NoncausalSamples, SamplesOfUncertainDirectionSurroundEveryReversal) {
  const AxisLog log = swinging();
  ConditionerShape<double> shape;
  shape.direction_threshold_rad = 2.5 * kStep;
  const NoncausalSamples noncausal = noncausal_samples(log, shape, {kStep, 0.0});
  ASSERT_GE(noncausal.uncertain.size(), 7U);
  for (std::size_t i = 1; i < noncausal.uncertain.size(); ++i) {
    const auto truth = static_cast<Eigen::Index>(1000 * i);
    EXPECT_LE(noncausal.uncertain[i].begin, truth + 2);
    EXPECT_GE(noncausal.uncertain[i].end, truth - 2);
    EXPECT_LT(noncausal.uncertain[i].size(), 80);
  }
}

TEST(DoubtfulRows, AreThoseBetweenATurnAndItsNoticeAndThoseThatTheEncoderHides) {
  const AxisLog log = swinging();
  ConditionerShape<double> shape;
  shape.direction_threshold_rad = 2.5 * kStep;
  const Samples running = causal_samples(log, shape);
  const NoncausalSamples afterwards = noncausal_samples(log, shape, {kStep, 0.0});
  const Blocks doubtful = doubtful_rows(running, afterwards);
  const auto noticed = direction_changes(running);
  ASSERT_GE(doubtful.size(), noticed.size() - 1);
  std::vector<bool> in_doubt(running.size());
  Eigen::Index last = -1;
  for (const auto& block : doubtful) {
    EXPECT_GT(block.begin, last);  // in order, none touches another
    EXPECT_LT(block.size(), 100);
    last = block.end;
    std::fill(in_doubt.begin() + block.begin, in_doubt.begin() + block.end, true);
  }
  for (std::size_t i = 1; i < noticed.size(); ++i) {
    EXPECT_TRUE(in_doubt[1000 * i]);                                  // where it turned
    EXPECT_TRUE(in_doubt[static_cast<std::size_t>(noticed[i]) - 1]);  // the last row before it is noticed
    EXPECT_FALSE(in_doubt[static_cast<std::size_t>(noticed[i]) + 60]);
  }
}

TEST(NoncausalSamples, TheAngleBetweenCountsIsKnownBetterThanTheCounts) {
  AxisLog log = swinging();
  const Eigen::ArrayXd truth = 0.05 * (log.time_s.array() * std::numbers::pi).cos();  // five samples a count
  log.q1_rad = (truth / kStep).round() * kStep;
  const NoncausalSamples noncausal = noncausal_samples(log, {}, {kStep, 0.0});
  Eigen::ArrayXd known(8000);
  for (Eigen::Index i = 0; i < 8000; ++i) {
    known[i] = noncausal.samples[static_cast<std::size_t>(i)].q1;
  }
  const double of_counts = std::sqrt((log.q1_rad.array() - truth).square().mean());
  const double of_lines = std::sqrt((known - truth).square().mean());
  EXPECT_LT(of_lines, 0.6 * of_counts);  // most of what is left is hidden where it turns between two counts
  EXPECT_LT((known - log.q1_rad.array()).abs().maxCoeff(), 0.501 * kStep);
  // What may still be hidden is drawn from the same motion with its edges moved: of that size, and not measured.
  EXPECT_NEAR(noncausal.hidden_rad.norm() / std::sqrt(8000.0), of_lines, 0.5 * of_lines);
}

TEST(NoncausalSamples, TheRateHasNoLag) {
  AxisLog log = swinging();
  log.q1_rad = (log.time_s.array() * std::numbers::pi).cos();
  const Eigen::VectorXd slope = local_slope(log.q1_rad, 10, kPeriod);
  const Eigen::VectorXd truth = -std::numbers::pi * (log.time_s.array() * std::numbers::pi).sin();
  EXPECT_LT((slope - truth).segment(20, 7950).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(NoncausalSamples, WhatLiesBehindTheInputTermsIsSeenAsWellAsTheMotor) {
  const NoncausalSamples noncausal = noncausal_samples(swinging(), {}, {kStep, 0.0});
  for (const auto& sample : noncausal.samples) {  // the ratio reads h, drag reads both rates
    ASSERT_EQ(sample.h, sample.q1);
    ASSERT_EQ(sample.dh, sample.dq1);
  }
}

TEST(NoncausalSamples, WhatARateHidesIsAsLargeAsItsError) {
  AxisLog log = swinging();
  const Eigen::ArrayXd phase = log.time_s.array() * std::numbers::pi;
  const NoncausalSamples noncausal = noncausal_samples(log, {}, {kStep, 0.0});
  double of_rate = 0.0;
  double of_acceleration = 0.0;
  constexpr Eigen::Index kEdge = 200;
  for (Eigen::Index i = kEdge; i < 8000 - kEdge; ++i) {
    const auto& sample = noncausal.samples[static_cast<std::size_t>(i)];
    of_rate += std::pow(sample.dq1 + std::numbers::pi * std::sin(phase[i]), 2);
    of_acceleration += std::pow(sample.ddq1 + 1e-3 * std::numbers::pi * std::numbers::pi * std::cos(phase[i]), 2);
  }
  const auto energy = [](const Eigen::VectorXd& signal) {
    return signal.segment(kEdge, 8000 - 2 * kEdge).squaredNorm();
  };
  EXPECT_GT(energy(noncausal.hidden_rate), of_rate / 4.0);
  EXPECT_LT(energy(noncausal.hidden_rate), of_rate * 4.0);
  EXPECT_GT(energy(noncausal.hidden_acceleration), of_acceleration / 4.0);
  EXPECT_LT(energy(noncausal.hidden_acceleration), of_acceleration * 4.0);
}

TEST(NoncausalSamples, WhatTheResolutionHidesReachesTheLaw) {
  test::SyntheticRequest request;
  request.counts_per_turn = 1024.0;
  const std::vector<AxisLog> logs = {test::synthetic_log(request)};
  const LawForm law = form_of_model("kinematic", logs);
  const Eigen::VectorXd hidden = residual_of(prepare(logs, law), law).resolution;
  const double counts = 1.08 * 2.0 * std::numbers::pi / 1024.0 / std::sqrt(12.0);  // of whoever sees nothing in between
  EXPECT_GT(hidden.norm(), 0.02 * counts * std::sqrt(static_cast<double>(hidden.size())));
  EXPECT_LT(hidden.norm(), counts * std::sqrt(static_cast<double>(hidden.size())));
}

/// A search that named an effect and still finds something for certain.
auto search_that_explains(double share) -> Search {
  Search search;
  search.effects.emplace_back();
  search.effects.back().name = "play";
  search.lacks_something = true;
  search.share = {share, share};
  return search;
}

TEST(Verdict, WhatTheFormOfATermLeavesIsNoOtherEffect) {
  Diagnosis whole;
  EXPECT_EQ(judge(search_that_explains(0.985), whole), Verdict::kEffect);
  EXPECT_EQ(whole.reason.find("cannot be distinguished from noise"), std::string::npos);  // it can
  Diagnosis part;
  EXPECT_EQ(judge(search_that_explains(0.94), part), Verdict::kEffectPlusUnlisted);  // another, four times smaller
}

}  // namespace
}  // namespace capstan::tools
