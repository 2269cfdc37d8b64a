// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/loop_gauge.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"

namespace capstan::tools {
namespace {

// What a loop says is in tests/tools/blind, on plants that are drawn; here is where it says nothing.
TEST(ByLoop, SaysNothingOfALawWithoutTendonsOrOfAMotorThatGoesOneWay) {
  Samples samples(200);
  Eigen::VectorXd target(200);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].q1 = samples[i].h = 0.01 * static_cast<double>(i);
    samples[i].dq1 = samples[i].dh = 0.01;
    samples[i].tau = 0.02;
    target[static_cast<Eigen::Index>(i)] = samples[i].q1;
  }
  const Preparation p = test::preparation_of(samples, target, test::split_of(10, 20, {Role::kFit, Role::kChoose}));
  int told = 0;
  const auto progress = [&told](const std::string&) { ++told; };
  JointFile healthy;
  healthy.terms = {"motor_angle", "joint_offset"};
  EXPECT_FALSE(by_loop(p, healthy, form_of(healthy), progress));
  healthy.terms.emplace_back(kTendonModel);
  healthy.steady_torque = SteadyTorque{0.02, -0.02};
  healthy.fit.emplace();
  healthy.fit->loop_half_width = 0.1;
  EXPECT_FALSE(by_loop(p, healthy, form_of(healthy), progress));  // nothing goes backward
  EXPECT_EQ(told, 0);
}

}  // namespace
}  // namespace capstan::tools
