// SPDX-License-Identifier: Apache-2.0
// Boards that watch drawn joints whose tendons fail: each cause is named, and a healthy joint is left alone. In full:
// tools/plant_benchmark --health.
#include "capstan/tests/tools/plant/plant_health.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/tools/plant/plant_joint.hpp"

namespace capstan::tools::plant {
namespace {

constexpr std::uint64_t kJoint = 600;

class TendonHealthOnPlant : public testing::TestWithParam<const char*> {};

TEST_P(TendonHealthOnPlant, EveryCauseIsNamedWithinTwentySecondsOfMotion) {
  const WatchedJoint joint(drawn_plant(kJoint), kJoint, GetParam());
  for (const TendonFault& fault : tendon_faults()) {
    for (const bool sensor : {true, false}) {
      const HealthAnswer answer = joint.watch(fault.name, sensor, 20.0, 7);
      EXPECT_EQ(info(answer.health).name, info(sensor ? fault.cause : fault.blind).name)
          << (fault.name.empty() ? "healthy" : fault.name) << (sensor ? ", joint sensor" : ", motor's torque");
      if (fault.name == "loose") {
        EXPECT_NEAR(answer.tension / answer.true_tension, 1.0, 0.1);
      }
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Laws, TendonHealthOnPlant, testing::Values("pseudo_kinematic", "tendon"),
                         [](const auto& one) { return one.param; });

TEST(TendonHealthOnPlant, NothingIsSaidOfAHealthyJointForTenMinutes) {
  const WatchedJoint joint(drawn_plant(kJoint), kJoint, "pseudo_kinematic");
  for (const bool sensor : {true, false}) {
    const HealthAnswer answer = joint.watch("", sensor, 300.0, 11);
    EXPECT_EQ(answer.warnings, 0);
    EXPECT_EQ(answer.health, TendonHealth::kNothing);
    EXPECT_NEAR(answer.tension, 1.0, 0.03);
  }
}

}  // namespace
}  // namespace capstan::tools::plant
