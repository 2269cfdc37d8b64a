// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/free_run.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"

namespace capstan::tools {
namespace {

using test::normals;
using test::preparation_of;
using test::split_of;

/// 200 samples of a target of 2 and -2 in turn, every other block of 20 set aside to report on.
auto reported(Samples samples = Samples(200)) -> Preparation {
  Eigen::VectorXd target(200);
  for (Eigen::Index i = 0; i < 200; ++i) {
    target[i] = i % 2 == 0 ? 2.0 : -2.0;
  }
  return preparation_of(std::move(samples), target, split_of(10, 20, {Role::kFit, Role::kReport}));
}

TEST(ReportError, IsThatOfTheRowsSetAside) {
  const Preparation p = reported();
  Eigen::VectorXd estimate = p.target.array() + 0.5;
  estimate.head(20).setConstant(1000.0);  // learned from, and not asked
  const ErrorSummary error = report_error(p, estimate);
  EXPECT_NEAR(error.rmse, 0.5, 1e-12);
  EXPECT_NEAR(error.relative_percent, 25.0, 1e-12);
  // 100 (1 - |q - q^| / |q^ - mean(q^)|): 0.5 of 2 a row.
  EXPECT_NEAR(error.gof_percent, 75.0, 1e-9);
}

TEST(ErrorOfKnownDirection, LeavesOutWhereTheRunningSwitchIsWrong) {
  Preparation p = reported();
  Samples late(200);
  Eigen::VectorXd estimate = p.target.array() + 0.1;
  for (std::size_t i = 25; i < 35; ++i) {
    late[i].forward = false;
    estimate[static_cast<Eigen::Index>(i)] += 5.0;
  }
  p.causal = LawDesign({late}, {1.0});
  EXPECT_NEAR(error_of_known_direction(p, estimate), 0.1, 1e-12);
  for (auto& sample : late) {
    sample.forward = false;
  }
  p.causal = LawDesign({late}, {1.0});
  EXPECT_EQ(error_of_known_direction(p, estimate), 0.0);  // nothing is known
}

TEST(ShareLateByOneRow, CountsReversals) {
  Preparation p = reported();
  EXPECT_EQ(share_late_by_one_row(p), 0.0);
  Samples late(200);
  for (const std::size_t i : {5, 25, 26, 27, 40, 199}) {
    late[i].forward = false;
  }
  p.causal = LawDesign({late}, {1.0});
  EXPECT_EQ(share_late_by_one_row(p), 0.75);  // one is shown after three rows
}

TEST(RatioInterval, OfBlocksThatAreAlikeIsTheRatioItself) {
  const Preparation p = reported();
  const Eigen::VectorXd before = p.target.array() + 0.4;
  const Eigen::VectorXd after = p.target.array() - 0.1;
  const Interval ratio = ratio_interval(p, before, after);
  EXPECT_NEAR(ratio[0], 0.25, 1e-12);
  EXPECT_NEAR(ratio[1], 0.25, 1e-12);
  EXPECT_EQ(ratio_interval(p, p.target, after), (Interval{1.0, 1.0}));  // nothing before: nothing to compare
}

TEST(RatioInterval, HoldsTheRatioOfBlocksThatDiffer) {
  const Eigen::VectorXd target = Eigen::VectorXd::Zero(2000);
  const Eigen::VectorXd before = normals(2000, 1, 1);
  const Eigen::VectorXd after = 0.8 * normals(2000, 1, 2);
  const Interval ratio = ratio_interval(target, test::equal_blocks(40, 50), before, after);
  EXPECT_LT(ratio[0], 0.8);
  EXPECT_GT(ratio[1], 0.8);
  // Each rms of 2000 has a spread of 1.6 %, their ratio one of 2.2 %: four of these, 0.072, between the ends.
  EXPECT_NEAR(ratio[1] - ratio[0], 0.072, 0.03);
}

TEST(RatioInterval, OfAShortLogHoldsTheRatioToo) {
  // 40 of 160 rows are set aside, in one block. Eight parts of it resampled hold a ratio in nine of ten logs or so.
  constexpr int kLogs = 200;
  int held = 0;
  for (unsigned seed = 1; seed <= kLogs; ++seed) {
    const Preparation p = preparation_of(Samples(160), Eigen::VectorXd::Zero(160),
                                         split_of(4, 40, {Role::kFit, Role::kFit, Role::kChoose, Role::kReport}));
    const Interval ratio = ratio_interval(p, normals(160, 1, 2 * seed), 0.5 * normals(160, 1, 2 * seed + 1));
    held += ratio[0] < 0.5 && 0.5 < ratio[1] ? 1 : 0;
  }
  EXPECT_GT(held, 0.8 * kLogs);
  EXPECT_LT(held, 0.99 * kLogs);
}

TEST(HoldsOnUnseenRows, OnlyWhereALawErrsLessForCertain) {
  Samples samples(400);
  Eigen::VectorXd target = 0.1 * normals(400, 1, 3);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].q1 = samples[i].h = std::sin(0.05 * static_cast<double>(i));
    target[static_cast<Eigen::Index>(i)] += samples[i].q1 + 0.3 * std::sin(8.0 * samples[i].q1);
  }
  const Preparation p = preparation_of(samples, target, split_of(20, 20, {Role::kFit, Role::kReport}));
  LawForm base;
  base.terms = {"motor_angle", "joint_offset"};
  LawForm rippled = base;
  rippled.terms.emplace_back("angle_periodic");
  rippled.set_shapes(rippled.catalogue->term("angle_periodic"), {8.0});
  EXPECT_TRUE(holds_on_unseen_rows(p, base, rippled));
  EXPECT_FALSE(holds_on_unseen_rows(p, rippled, base));
  EXPECT_FALSE(holds_on_unseen_rows(p, base, base));
}

}  // namespace
}  // namespace capstan::tools
