// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/loop_without_torque.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"

namespace capstan::tools {
namespace {

auto doubted(const std::string& effect, bool torque) -> Diagnosis {
  Preparation p = test::preparation_of(20, {});
  p.logs.front().has_torque = torque;
  Diagnosis d;
  d.target = "axis2/q2_rad";
  d.effects.emplace_back().name = effect;
  d.found.emplace();
  d.found->terms = {"motor_angle", effect};
  d.found->parameters.shapes[d.found->catalogue->term("play").first_shape] = 0.012;
  doubt_loop_without_torque(p, d);
  return d;
}

TEST(LoopWithoutTorque, IsSaidToBeHealthyTendonsPerhapsWithTheLogThatTells) {
  const Diagnosis d = doubted("play", false);
  ASSERT_EQ(d.warnings.size(), 1U);
  EXPECT_NE(d.warnings.front().find("0.012 rad to either side"), std::string::npos) << d.warnings.front();
  ASSERT_TRUE(d.next_experiment);
  EXPECT_NE(d.next_experiment->find("axis2/tau_Nm"), std::string::npos) << *d.next_experiment;
}

TEST(LoopWithoutTorque, IsNotDoubtedWhereTorqueIsLoggedOrNoLoopWasNamed) {
  for (const Diagnosis& d : {doubted("play", true), doubted("angle_periodic", false)}) {
    EXPECT_TRUE(d.warnings.empty());
    EXPECT_FALSE(d.next_experiment);
  }
}

}  // namespace
}  // namespace capstan::tools
