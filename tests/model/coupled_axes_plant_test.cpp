// SPDX-License-Identifier: Apache-2.0
// The wrist's coupling matrices beside the simulated wrist, whose coupling comes from its tendons' way over the pitch.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "capstan/hal/sim/multi_plant.hpp"
#include "capstan/hal/sim/scenario.hpp"
#include "capstan/model/coupled_axes.hpp"

namespace capstan {
namespace {

TEST(WristCouplingOnThePlant, JawsFollowThePitchByTheRatioOfTheirRadiiAndHardlyBack) {
  const sim::Scenario scenario = sim::parse_scenario(
      "name = \"w\"\nseed = 1\ninstrument = \"da_vinci_wrist\"\n[motion]\n[[motion.segments]]\nkind = \"hold\"\n"
      "duration_s = 1.0\n",
      "w.toml");
  sim::MultiPlant plant(scenario);
  const auto go = [&](std::array<double, 3> from, std::array<double, 3> to) {
    for (int i = 1; i <= 2000; ++i) {
      std::array<double, 3> q{};
      for (std::size_t k = 0; k < 3; ++k) {
        q[k] = from[k] + (to[k] - from[k]) * i / 2000.0;
      }
      plant.step_kinematic(q);
    }
  };
  const auto angles = [&] { return std::array{plant.truth(0).q2_rad, plant.truth(1).q2_rad, plant.truth(2).q2_rad}; };
  go({0.0, 0.0, 0.0}, {0.1, 0.0, 0.0});
  const auto first = angles();
  go({0.1, 0.0, 0.0}, {0.4, 0.0, 0.0});
  const auto second = angles();
  const double right = (second[1] - first[1]) / (second[0] - first[0]);
  const double left = (second[2] - first[2]) / (second[0] - first[0]);
  std::printf("jaws per pitch on the plant: right %.4f, left %.4f\n", right, left);
  EXPECT_NEAR(std::fabs(right), 0.674, 0.02);
  EXPECT_NEAR(std::fabs(left), 0.664, 0.02);
  go({0.4, 0.0, 0.0}, {0.4, 0.3, 0.0});
  const auto third = angles();
  EXPECT_LT(std::fabs(third[0] - second[0]), 0.05 * std::fabs(third[1] - second[1]));
}

}  // namespace
}  // namespace capstan
