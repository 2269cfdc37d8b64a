// SPDX-License-Identifier: Apache-2.0
// What a board says of its own error, against the camera of a plant that shares no formula with the laws.
#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "capstan/tests/tools/plant/plant_joint.hpp"
#include "capstan/tests/tools/plant/told_torques.hpp"
#include "capstan/tools/identify/identify.hpp"

namespace capstan::tools::plant {
namespace {

constexpr std::uint64_t kSeed = 801;

/// Of the healthy joint, found once for the tests of a model.
auto healthy_law(const std::string& model) -> const JointFile& {
  static const AxisLog kLog = log_of(drawn_plant(kSeed), PlantMotion::kIdentify, kSeed);
  static std::map<std::string, JointFile> laws;
  const auto found = laws.find(model);
  return found != laws.end() ? found->second
                             : laws.emplace(model, identify({kLog}, form_of_model(model, {kLog})).joint).first->second;
}

class Told : public testing::TestWithParam<std::string> {};

TEST_P(Told, ErrorHoldsInAMotionThatTheLawHasNotSeen) {
  const sim::PlantParameters plant = drawn_plant(kSeed);
  const ToldErrors told = told_errors(healthy_law(GetParam()), log_of(plant, PlantMotion::kLadder, kSeed));
  EXPECT_GT(told.told, 0.9);
  EXPECT_GT(told.held, 0.9);
  EXPECT_LT(told.width, 3.0 * told.error) << "a bar that holds everything says nothing";
}

TEST_P(Told, ErrorIsBrokenByAJointThatHasChanged) {
  sim::PlantParameters plant = drawn_plant(kSeed);
  plant.effects.play_half_width_rad = 0.1;
  EXPECT_LT(told_errors(healthy_law(GetParam()), log_of(plant, PlantMotion::kLadder, kSeed)).held, 0.7);
}

constexpr double kHeldTip = std::numeric_limits<double>::infinity();
class ToldTorque : public testing::TestWithParam<std::string> {};

TEST_P(ToldTorque, ErrorHoldsInAMotionThatTheLawHasNotSeen) {
  const std::string law = force_file_of(GetParam(), kSeed);
  const ToldErrors told = told_torque_errors(law, force_log_of("", kSeed, kHeldTip));
  EXPECT_GT(told.told, 0.8);
  EXPECT_GT(told.held, 0.85);
  EXPECT_LT(told.width, 4.0 * told.error) << "a bar that holds everything says nothing";
}

TEST_P(ToldTorque, ErrorIsBrokenByAJointThatHasChanged) {
  const std::string law = force_file_of(GetParam(), kSeed);
  EXPECT_LT(told_torque_errors(law, force_log_of("", kSeed + 1, kHeldTip)).held, 0.7) << "another joint";
}

INSTANTIATE_TEST_SUITE_P(Laws, ToldTorque, testing::Values("pull_push", "preisach"),
                         [](const auto& info) { return info.param; });

INSTANTIATE_TEST_SUITE_P(Models, Told, testing::Values("kinematic", "pseudo_kinematic", "tendon"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace capstan::tools::plant
