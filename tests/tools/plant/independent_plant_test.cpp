// SPDX-License-Identifier: Apache-2.0
// A plant that shares no code with hal/sim: that it obeys what tendons obey, and that names found on hal/sim are found
// on it. In full: tools/plant_benchmark --independent.
#include "capstan/tests/tools/plant/independent_plant.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tests/tools/plant/independent_joint.hpp"
#include "capstan/tools/diagnose/compare.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools::plant {
namespace {

auto even_joint(double eta) -> independent::Parameters {
  independent::Parameters joint;
  for (independent::TendonDrawing* tendon : {&joint.top, &joint.bottom}) {
    tendon->eta = eta;
    tendon->guide_shares.assign(12, 1.0 / 12.0);
  }
  return joint;
}

TEST(IndependentPlant, AHeldJointGetsWhatACapstanLeavesOfTheMotorsPull) {
  // Pulled until the other tendon is slack, tau_out / r2 = tau_in / r1 e^-eta (2.18), but for the motor's friction.
  constexpr double kEta = 0.9;
  independent::Parameters joint = even_joint(kEta);
  joint.pretension_n = 4.0;
  joint.held = true;
  const auto rows = independent::moved(
      joint, [](double time) { return std::min(0.25, 0.1 * time); }, 2.4, 500.0, 1);
  const independent::Row& last = rows.back();
  const double in = (last.tau_nm - joint.motor_friction_nm - joint.motor_viscous_nms * 0.1) / joint.motor_radius_m;
  ASSERT_GT(in, 20.0);
  EXPECT_NEAR(last.tau_out_nm / joint.joint_radius_m / in, std::exp(-kEta), 0.02 * std::exp(-kEta));
}

TEST(IndependentPlant, AFreeJointsLoopIsThatOfTautTendons) {
  // Half width at the joint, beside what its own friction stretches: I tanh(eta / 2) / (2 K r2), MODELS.md (7.5).
  constexpr double kEta = 1.0;
  independent::Parameters joint = even_joint(kEta);
  joint.joint_friction_nm = 1e-5;
  joint.joint_viscous_nms = 2e-4;
  joint.camera_noise_rad = 0.0;
  const auto rows = independent::moved(
      joint, [](double time) { return 0.4 * std::sin(0.5 * std::numbers::pi * time); }, 8.0, 500.0, 1);
  const double beta = joint.motor_radius_m / joint.joint_radius_m;
  double half = 0.0;
  for (const std::size_t at : {2000U, 3000U}) {  // 4 and 6 s: through the middle, once up and once down
    half += 0.5 * std::abs(rows[at].q2_rad - beta * rows[at].q1_rad);
  }
  const double wanted =
      joint.pretension_n * std::tanh(0.5 * kEta) / (2.0 * joint.top.stiffness_n_per_m * joint.joint_radius_m);
  EXPECT_NEAR(half, wanted, 0.04 * wanted);
}

TEST(IndependentPlant, AHealthyJointLacksNothingAndAGapAndALeaningWeightAreNamedWithTheirSize) {
  constexpr std::uint64_t kJoint = 3;
  const independent::Parameters healthy = independent_joint(kJoint);
  LabExperiment experiment = drawn_experiment(kJoint);
  const Diagnosis before = diagnose({log_of(healthy, experiment)}, {});
  ASSERT_TRUE(before.base.has("tendon"));
  EXPECT_EQ(before.verdict, Verdict::kNothingMissing) << before.reason;
  EXPECT_LT(before.after.rmse, 1.1 * healthy.camera_noise_rad);
  experiment.noise_seed += 1;
  const auto asked = [&](double independent::Effects::*effect, double size) {
    independent::Parameters joint = healthy;
    joint.effects.weight_angle_rad = -0.5;
    joint.effects.*effect = size;
    DiagnoseOptions options;
    options.base_model = "healthy.toml";
    options.base_law = before.law;
    return diagnose({log_of(joint, experiment)}, options);
  };
  const Diagnosis gap = asked(&independent::Effects::play_rad, 0.01);
  ASSERT_EQ(gap.effects.size(), 1U) << gap.reason;
  EXPECT_EQ(gap.effects.front().name, "play");
  ASSERT_TRUE(gap.effects.front().size);
  EXPECT_NEAR(gap.effects.front().size->value, 0.01, 0.001);
  const Diagnosis weight = asked(&independent::Effects::weight_nm, 0.05);
  ASSERT_EQ(weight.effects.size(), 1U) << weight.reason;
  EXPECT_EQ(weight.effects.front().name, "gravity");
  ASSERT_TRUE(weight.effects.front().size);
  EXPECT_NEAR(weight.effects.front().size->value, 0.05 * std::cos(0.5), 0.1 * 0.05);
  EXPECT_TRUE(asked(&independent::Effects::sticky_nm, 0.02).effects.empty());
  const Diagnosis late = asked(&independent::Effects::camera_delay_s, 0.008);
  ASSERT_EQ(late.effects.size(), 1U) << late.reason;
  EXPECT_EQ(late.effects.front().name, "transport_delay");
  EXPECT_TRUE(late.law.has("transport_delay")) << "and no drag in its place";
  EXPECT_TRUE(std::any_of(late.sizes.begin(), late.sizes.end(), [](const std::string& sentence) {
    return sentence.find("ms later than at the healthy joint") != std::string::npos;
  }));
}

// Tendons fitted to each log alone exchange what a free tip does not tell apart.
TEST(IndependentPlant, NoParameterOfAHealthyJointHasMovedByTheNextLog) {
  constexpr std::uint64_t kJoint = 4;
  const independent::Parameters joint = independent_joint(kJoint);
  LabExperiment experiment = drawn_experiment(kJoint);
  const AxisLog monday = log_of(joint, experiment);
  experiment.noise_seed += 1;
  const Comparison both = compare({monday}, {log_of(joint, experiment)}, {});
  ASSERT_NE(std::find(both.terms.begin(), both.terms.end(), "tendon"), both.terms.end());
  EXPECT_TRUE(both.moved.empty()) << both.moved.front().name;
}

/// The law of tendons from the joint's drawn experiment.
auto tendons_of(const independent::Parameters& joint, std::uint64_t seed) -> JointFile {
  LawForm form;
  form.terms = terms_of_model("tendon");
  return identify({log_of(joint, drawn_experiment(seed))}, form).joint;
}

// After each quick turn of the triangles the motor rings; sines, which the law is from, never ring. Peaks of torque
// that the motor's mass took must not stay in the tendons' tension.
TEST(IndependentPlant, ALawFromSinesHoldsWhereTheMotorRings) {
  constexpr std::uint64_t kJoint = 8004;
  const independent::Parameters joint = independent_joint(kJoint);
  const JointFile law = tendons_of(joint, kJoint);
  LabExperiment other = drawn_experiment(kJoint);
  ASSERT_EQ(other.motion, LabMotion::kSines);
  other.motion = LabMotion::kTriangles;
  const AxisLog log = log_of(joint, other);
  const Eigen::VectorXd error = log.q2_rad - simulate({log}, motion_parameters(law));
  EXPECT_LT(rms((error.array() - error.mean()).matrix()), 1.1 * joint.camera_noise_rad);
}

// A count of such an encoder is an acceleration of its own; tendons keep every peak of it.
TEST(IndependentPlant, ACoarseEncoderTakesASlowerFilterOfTheMotorsRate) {
  constexpr std::uint64_t kJoint = 8004;
  independent::Parameters joint = independent_joint(kJoint);
  const double fine = tendons_of(joint, kJoint).parameters.conditioner.rate_time_constant_s;
  joint.counts_per_turn = 2048.0;
  EXPECT_GT(tendons_of(joint, kJoint).parameters.conditioner.rate_time_constant_s, fine);
}

}  // namespace
}  // namespace capstan::tools::plant
