// SPDX-License-Identifier: Apache-2.0
// What tendons carry is named by the motor's torque, from the law of a drawn plant's healthy joint. In full:
// tools/plant_benchmark.
#include <gtest/gtest.h>

#include "capstan/tests/tools/plant/plant_joint.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools::plant {
namespace {

TEST(TorqueOnPlant, AWeightAndAnotherPretensionAreNamedWithTheirSizeAndAStickySpotIsNot) {
  constexpr std::uint64_t kJoint = 700;
  const sim::PlantParameters healthy = drawn_plant(kJoint);
  const Diagnosis before = diagnose({log_of(healthy, PlantMotion::kIdentify, kJoint)}, {});
  ASSERT_TRUE(before.base.has("tendon"));
  ASSERT_TRUE(before.effects.empty()) << before.reason;
  const auto asked = [&](double sim::Effects::*effect, double size) {
    sim::PlantParameters plant = healthy;
    plant.effects.*effect = size;
    DiagnoseOptions options;
    options.base_model = "healthy.toml";
    options.base_law = before.law;
    return diagnose({log_of(plant, PlantMotion::kIdentify, kJoint + 1)}, options);
  };
  const Diagnosis weight = asked(&sim::Effects::gravity_torque_nm, 0.05);
  ASSERT_EQ(weight.effects.size(), 1U) << weight.reason;
  EXPECT_EQ(weight.effects.front().name, "gravity");
  ASSERT_TRUE(weight.effects.front().size);
  EXPECT_NEAR(weight.effects.front().size->value, 0.05, 0.005);
  const Diagnosis taut = asked(&sim::Effects::pretension_change_n, 0.6 * healthy.pretension_n);
  ASSERT_EQ(taut.effects.size(), 1U) << taut.reason;
  EXPECT_EQ(taut.effects.front().name, "pretension_offset");
  ASSERT_TRUE(taut.effects.front().size);
  EXPECT_NEAR(taut.effects.front().size->value, 1.6, 0.1);  // by the width alone 1.4
  EXPECT_TRUE(asked(&sim::Effects::sticky_spot_nm, 0.02).effects.empty());
}

}  // namespace
}  // namespace capstan::tools::plant
