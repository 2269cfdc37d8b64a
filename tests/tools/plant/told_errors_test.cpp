// SPDX-License-Identifier: Apache-2.0
// What a board says of its own error, against the camera of a plant that shares no formula with the laws.
#include <gtest/gtest.h>

#include "capstan/tests/tools/plant/plant_joint.hpp"
#include "capstan/tests/tools/plant/told_errors.hpp"
#include "capstan/tools/identify/identify.hpp"

namespace capstan::tools::plant {
namespace {

constexpr std::uint64_t kSeed = 801;

auto law_of(const AxisLog& log, const std::string& model) -> JointFile {
  return identify({log}, form_of_model(model, {log})).joint;
}

class Told : public testing::TestWithParam<std::string> {};

TEST_P(Told, ErrorHoldsInAMotionThatTheLawHasNotSeen) {
  const sim::PlantParameters plant = drawn_plant(kSeed);
  const JointFile law = law_of(log_of(plant, PlantMotion::kIdentify, kSeed), GetParam());
  const ToldErrors told = told_errors(law, log_of(plant, PlantMotion::kLadder, kSeed));
  EXPECT_GT(told.told, 0.9);
  EXPECT_GT(told.held, 0.9);
  EXPECT_LT(told.width_rad, 3.0 * told.error_rad) << "a bar that holds everything says nothing";
}

TEST_P(Told, ErrorIsBrokenByAJointThatHasChanged) {
  sim::PlantParameters plant = drawn_plant(kSeed);
  const JointFile law = law_of(log_of(plant, PlantMotion::kIdentify, kSeed), GetParam());
  plant.effects.play_half_width_rad = 0.1;
  EXPECT_LT(told_errors(law, log_of(plant, PlantMotion::kLadder, kSeed)).held, 0.7);
}

INSTANTIATE_TEST_SUITE_P(Models, Told, testing::Values("kinematic", "pseudo_kinematic", "tendon"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace capstan::tools::plant
