// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/left_to_choose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"

namespace capstan::tools {
namespace {

using test::preparation_of;
using test::split_of;

/// Motor angles of a sine over 100 samples.
auto sine() -> Samples {
  Samples samples(100);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].q1 = samples[i].h = std::sin(0.3 * static_cast<double>(i));
  }
  return samples;
}

auto ratio_and_offset() -> LawForm {
  LawForm law;
  law.terms = {"motor_angle", "joint_offset"};
  return law;
}

TEST(LeftToChoose, IsTheErrorOfRowsThatTheFitHasNotSeen) {
  // 2 q1 + 0.5 to fit; the offset is 0.3 more where it is chosen, and anything where it is reported.
  const Samples samples = sine();
  const Split split = split_of(10, 10, {Role::kFit, Role::kChoose, Role::kFit, Role::kReport});
  Eigen::VectorXd target(100);
  for (const auto& block : split.blocks) {
    for (Eigen::Index i = block.rows.begin; i < block.rows.end; ++i) {
      target[i] = 2.0 * samples[static_cast<std::size_t>(i)].q1 + 0.5 +
                  (block.role == Role::kChoose ? 0.3 : (block.role == Role::kReport ? 100.0 : 0.0));
    }
  }
  EXPECT_NEAR(left_to_choose(preparation_of(samples, target, split), ratio_and_offset()), 0.3, 1e-9);
}

TEST(NoiseOf, OfRepeatsIsTheirsElseAtMostWhatTheLawFoundLeaves) {
  Preparation p = preparation_of(10, split_of(1, 10, {Role::kFit}));
  Search search;
  search.noise_floor = 0.4;
  EXPECT_EQ(noise_of(p, search, 0.3), 0.3);
  EXPECT_EQ(noise_of(p, search, 0.5), 0.4);
  p.repeats = Repeats{0, 5, 2};
  EXPECT_EQ(noise_of(p, search, 0.3), 0.4);
}

TEST(NoiseKnown, IsWhatTheHealthyLawLeftOrWhatThisCameraShowsFromSampleToSample) {
  Eigen::VectorXd target(100);
  for (Eigen::Index i = 0; i < 100; ++i) {
    target[i] = i % 2 == 0 ? 0.1 : -0.1;  // steps of 0.2: as of white noise of 0.2 / sqrt(2)
  }
  const Preparation p = preparation_of(sine(), target, split_of(10, 10, {Role::kFit}));
  JointFile healthy;
  EXPECT_EQ(noise_known(p, healthy), std::numeric_limits<double>::infinity());  // nobody wrote it down
  healthy.fit.emplace();
  healthy.fit->rmse = 0.05;
  EXPECT_NEAR(noise_known(p, healthy), 0.2 / std::sqrt(2.0), 1e-12);
  healthy.fit->rmse = 0.3;
  EXPECT_EQ(noise_known(p, healthy), 0.3);
}

}  // namespace
}  // namespace capstan::tools
