// SPDX-License-Identifier: Apache-2.0
// The force laws beside the simulated instrument, whose tendons are chains of springs and know no phases.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "capstan/hal/sim/plant.hpp"
#include "capstan/model/pull_push.hpp"

namespace capstan {
namespace {

/// Rms error of a law over slow triangles of the motor with the tip locked, as a share of the largest joint torque. The
/// law gets the plant's own friction numbers and the true motor torque.
auto error_share(double pretension_n, double pull, double pull_push, HoldRule rule) -> double {
  sim::PlantParameters p;
  p.environment.kind = sim::EnvironmentKind::kLocked;
  p.pretension_n = pretension_n;
  p.element_count = 64;
  sim::Plant plant(p, 1);
  PullPush<double> law(
      {p.eta_top, p.eta_bottom, pretension_n * p.input_radius_m, p.output_radius_m / p.input_radius_m, pull, pull_push},
      rule);
  double sum = 0.0;
  double full_scale = 0.0;
  double q1 = 0.0;
  constexpr int kCycle = 10000;
  for (int i = 0; i < 2 * kCycle; ++i) {
    const double next =
        0.25 * 2.0 / std::numbers::pi * std::asin(std::sin(2.0 * std::numbers::pi * static_cast<double>(i) / kCycle));
    plant.step_kinematic(next);
    const auto estimate = law.update(plant.truth().tau_in_nm, next >= q1);
    q1 = next;
    if (i >= kCycle) {
      sum += std::pow(estimate.force - plant.truth().tau_out_nm, 2.0);
      full_scale = std::fmax(full_scale, std::fabs(plant.truth().tau_out_nm));
    }
  }
  return std::sqrt(sum / kCycle) / full_scale;
}

constexpr double kThesisPretension = 27.6984;

TEST(PullPushOnThePlant, HoldingUntilPassedIsFarNearerThanHoldingUntilPulling) {
  const double passed = error_share(kThesisPretension, 0.0, 1.0, HoldRule::kUntilPassed);
  const double printed = error_share(kThesisPretension, 0.0, 1.0, HoldRule::kUntilPulling);
  const double blend = error_share(kThesisPretension, 0.5904, 0.4686, HoldRule::kUntilPulling);
  std::printf("tip locked, I = 27.7 N, rms of full scale: pull-push %.1f %%, as printed %.1f %%, blend %.1f %%\n",
              100.0 * passed, 100.0 * printed, 100.0 * blend);
  EXPECT_LT(passed, 0.06);  // what is left is phase II, where the law takes the pushed tendon to move at once
  EXPECT_GT(printed, 3.0 * passed);
  EXPECT_GT(blend, 2.0 * passed);
  EXPECT_LT(blend, printed) << "why the thesis blends";
}

TEST(PullPushOnThePlant, IsExactWhereTheTendonsGoSlackBeforePhaseIIMatters) {
  EXPECT_LT(error_share(5.0, 0.0, 1.0, HoldRule::kUntilPassed), 0.001);
}

}  // namespace
}  // namespace capstan
