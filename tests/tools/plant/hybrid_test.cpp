// SPDX-License-Identifier: Apache-2.0
// Joint angle and joint torque at once, in the board's numbers, whatever the tip touches. More joints:
// tools/plant_benchmark --hybrid.
#include "capstan/tests/tools/plant/hybrid.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "capstan/tests/tools/plant/plant_joint.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"

namespace capstan::tools::plant {
namespace {

constexpr std::uint64_t kSeed = 9030;
constexpr double kHeld = std::numeric_limits<double>::infinity();

TEST(HybridEstimate, IsRightWithTheTipFreeTouchingAndHeldByOneLaw) {
  const sim::PlantParameters plant = drawn_plant(kSeed);
  const JointFile law = hybrid_law(plant, kSeed);
  const double range = torque_range(plant);
  for (const double spring : {0.0, 0.02, 0.1, 0.5, 2.0, kHeld}) {
    const HybridError error = hybrid_error(law, plant, spring, range);
    EXPECT_LT(error.torque_share, 0.03) << spring;
    EXPECT_LT(error.angle_rad, plant.camera_noise_rad) << spring;
  }
}

// Where the estimate of the torque fell short: a free tip does not tell eta from pretension, and a held one needs both.
TEST(HybridEstimate, NeedsALogWithTheTipHeld) {
  const sim::PlantParameters plant = drawn_plant(kSeed);
  const AxisLog free = log_of(plant, PlantMotion::kIdentify, kSeed);
  const JointFile law = identify({free}, form_of_model(kTendonModel, {free})).joint;
  const double range = torque_range(plant);
  const double with_both = hybrid_error(hybrid_law(plant, kSeed), plant, kHeld, range).torque_share;
  const double by_free_tip = hybrid_error(law, plant, kHeld, range).torque_share;
  std::printf("torque with the tip held: %.2f %% of its range by both logs, %.2f %% by the free tip's alone\n",
              100.0 * with_both, 100.0 * by_free_tip);
  EXPECT_GT(by_free_tip, 3.0 * with_both);
}

}  // namespace
}  // namespace capstan::tools::plant
