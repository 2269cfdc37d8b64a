// SPDX-License-Identifier: Apache-2.0
// Laws as tendons of MuJoCo: a simulated motor moves a simulated joint through them, slowly, and the joint goes where
// the law says.
#include "capstan/tools/mjcf/mjcf.hpp"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "capstan/tools/replay/replay.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kPeriod_s = 0.001;
constexpr double kFriction_nm = 0.045;  // at the motor

auto law(const std::vector<std::string>& terms) -> JointFile {
  JointFile joint;
  joint.terms = terms;
  const auto put = [&](const char* term, std::size_t i, double value) {
    joint.parameters.coefficients[joint.catalogue->term(term).first_coefficient + i] = value;
  };
  put("motor_angle", 0, 0.9);
  put("joint_offset", 0, 0.02);
  put("tendon_elongation", 0, joint.has("tendon_elongation") ? -0.4 : 0.0);
  put("tendon_elongation", 1, joint.has("tendon_elongation") ? -0.4 : 0.0);
  if (joint.has("play")) {
    put("play", 0, 0.9);
    joint.parameters.shapes[joint.catalogue->term("play").first_shape] = 0.03;
  }
  joint.steady_torque = SteadyTorque{kFriction_nm, -kFriction_nm};
  return joint;
}

/// Angles of motor and joint while the motor goes to and fro, after the first turn.
struct Motion {
  Eigen::VectorXd motor, joint;
};

auto simulate(const JointFile& joint) -> Motion {
  const auto folder = std::filesystem::path(testing::TempDir()) /
                      ("capstan_mjcf_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  std::filesystem::create_directories(folder);
  write_text_file((folder / "tendon.xml").string(), mjcf_of(joint, {.joint = "finger \"2\""}).text);
  write_text_file((folder / "model.xml").string(), R"(<mujoco>
    <compiler angle="radian"/>
    <option timestep="0.001" gravity="0 0 0"/>
    <worldbody>
      <body><joint name="motor" type="hinge" damping="0.05" armature="0.001"/>
        <geom type="sphere" size="0.02" mass="0.05" contype="0" conaffinity="0"/></body>
      <body><joint name="finger &quot;2&quot;" type="hinge" damping="0.002"/>
        <geom type="capsule" fromto="0 0 0 0.1 0 0" size="0.01" mass="0.02" contype="0" conaffinity="0"/></body>
    </worldbody>
    <actuator><position joint="motor" kp="20"/></actuator>
    <include file="tendon.xml"/>
  </mujoco>)");
  std::array<char, 500> error{};
  mjModel* model = mj_loadXML((folder / "model.xml").c_str(), nullptr, error.data(), error.size());
  EXPECT_NE(model, nullptr) << error.data();
  Motion motion;
  if (model == nullptr) {
    return motion;
  }
  mjData* data = mj_makeData(model);
  constexpr Eigen::Index kBefore = 10'000;
  constexpr Eigen::Index kSamples = 20'000;
  motion.motor.resize(kSamples);
  motion.joint.resize(kSamples);
  for (Eigen::Index i = -kBefore; i < kSamples; ++i) {
    data->ctrl[0] = 0.8 * std::sin(2.0 * M_PI * 0.1 * static_cast<double>(i) * kPeriod_s);
    mj_step(model, data);
    if (i >= 0) {
      motion.motor[i] = data->qpos[0];
      motion.joint[i] = data->qpos[1];
    }
  }
  mj_deleteData(data);
  mj_deleteModel(model);
  std::filesystem::remove_all(folder);
  return motion;
}

/// What the law says of that motion, the torque being friction's.
auto said(const JointFile& joint, const Motion& motion) -> Eigen::VectorXd {
  AxisLog log;
  log.name = "simulated";
  log.period_s = kPeriod_s;
  log.q1_rad = motion.motor;
  log.time_s =
      Eigen::VectorXd::LinSpaced(motion.motor.size(), 0.0, static_cast<double>(motion.motor.size() - 1) * kPeriod_s);
  log.tau_nm = Eigen::VectorXd::Zero(motion.motor.size());
  for (Eigen::Index i = 1; i < motion.motor.size(); ++i) {
    log.tau_nm[i] = motion.motor[i] > motion.motor[i - 1] ? kFriction_nm : -kFriction_nm;
  }
  return replay(log, motion_parameters(joint), Arithmetic::kDouble).q2;
}

/// Largest and mean difference of joint and law, where the motor moves at more than half of its speed.
void expect_follows(const JointFile& joint, double mean_rad) {
  const Motion motion = simulate(joint);
  ASSERT_GT(motion.motor.size(), 0);
  ASSERT_GT(motion.motor.maxCoeff(), 0.7);
  const Eigen::VectorXd law = said(joint, motion);
  double sum = 0.0;
  int count = 0;
  for (Eigen::Index i = 5'000; i + 1 < law.size(); ++i) {
    if (std::abs(motion.motor[i + 1] - motion.motor[i]) > 0.25 * kPeriod_s) {
      sum += std::abs(motion.joint[i] - law[i]);
      ++count;
    }
  }
  ASSERT_GT(count, 3'000);
  EXPECT_LT(sum / count, mean_rad);
}

/// Half the width of the loop that the joint makes over the motor, at the motor's zero, and the middle there.
auto loop_at_zero(const Motion& motion) -> std::pair<double, double> {
  double up = 0.0;
  double down = 0.0;
  for (Eigen::Index i = 5'000; i + 1 < motion.motor.size(); ++i) {
    if (motion.motor[i] <= 0.0 && motion.motor[i + 1] > 0.0) {
      up = motion.joint[i];
    } else if (motion.motor[i] >= 0.0 && motion.motor[i + 1] < 0.0) {
      down = motion.joint[i];
    }
  }
  return {(down - up) / 2.0, (down + up) / 2.0};
}

// The joint's own drag, 0.002 Nm s/rad at 0.45 rad/s, is 2 % of the friction: the law does not know it.
TEST(Mjcf, ElasticTendonLagsBehindByTheLawsElongation) {
  const JointFile joint = law({"motor_angle", "joint_offset", "tendon_elongation"});
  const auto [half_width, middle] = loop_at_zero(simulate(joint));
  EXPECT_NEAR(half_width, 0.4 * kFriction_nm, 0.05 * 0.4 * kFriction_nm);
  EXPECT_NEAR(middle, 0.02, 0.001);
  expect_follows(joint, 0.001);
}

TEST(Mjcf, JointBehindAGapStaysUntilTheGapIsCrossed) {
  const JointFile joint = law({"motor_angle", "joint_offset", "play"});
  const auto [half_width, middle] = loop_at_zero(simulate(joint));
  EXPECT_NEAR(half_width, 0.9 * 0.03, 0.002);
  EXPECT_NEAR(middle, 0.02, 0.001);
  expect_follows(joint, 0.002);
}

TEST(Mjcf, StiffTendonKeepsTheRatio) {
  const JointFile joint = law({"motor_angle", "joint_offset"});
  const auto [half_width, middle] = loop_at_zero(simulate(joint));
  EXPECT_NEAR(half_width, 0.0, 0.002);
  EXPECT_NEAR(middle, 0.02, 0.001);
  expect_follows(joint, 0.002);
}

// The law that `diagnose` writes by default, with the numbers of the demo's healthy joint.
auto law_of_tendons() -> JointFile {
  JointFile joint = law({"motor_angle", "joint_offset", "tendon"});
  const CatalogueTerm& term = joint.catalogue->term("tendon");
  joint.parameters.coefficients[term.first_coefficient] = -6.16;
  const std::array<double, 4> shapes = {1.19, 1.14, 0.067 / 2.0, 0.51};  // etas, pretension, share
  std::copy(shapes.begin(), shapes.end(),
            joint.parameters.shapes.begin() + static_cast<std::ptrdiff_t>(term.first_shape));
  return joint;
}

TEST(Mjcf, TendonsWithFrictionLagBehindAsFarAsTheLawSays) {
  const JointFile joint = law_of_tendons();
  const Mjcf made = mjcf_of(joint, {});
  EXPECT_TRUE(made.left_out.empty());
  EXPECT_TRUE(made.warnings.empty());
  EXPECT_EQ(made.text.find("<equality>"), std::string::npos) << "a stiff joint";
  const Motion motion = simulate(joint);
  const auto [half_width, middle] = loop_at_zero(motion);
  const auto [half_width_said, middle_said] = loop_at_zero({motion.motor, said(joint, motion)});
  EXPECT_GT(half_width_said, 0.01);
  EXPECT_NEAR(half_width, half_width_said, 0.05 * half_width_said);
  EXPECT_NEAR(middle, middle_said, 0.002);
  expect_follows(joint, 0.002);
}

TEST(Mjcf, TendonsWithFrictionNeedTheTorqueOfSteadyMotion) {
  JointFile joint = law_of_tendons();
  joint.steady_torque.reset();
  try {
    static_cast<void>(mjcf_of(joint, {}));
    ADD_FAILURE() << "a joint that is as soft as nobody knows";
  } catch (const Refusal& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("--model pseudo_kinematic"), std::string::npos) << refusal.what();
  }
  joint = law_of_tendons();
  joint.parameters.coefficients[joint.catalogue->term("tendon").first_coefficient] *= -1.0;
  const Mjcf pushes = mjcf_of(joint, {});
  EXPECT_EQ(pushes.left_out, std::vector<std::string>{"tendon"});
  ASSERT_EQ(pushes.warnings.size(), 1U);
  EXPECT_NE(pushes.warnings.front().find("Count the joint the other way"), std::string::npos)
      << pushes.warnings.front();
}

TEST(Mjcf, WhatHasNoCounterpartIsNamed) {
  JointFile joint = law({"motor_angle", "joint_offset", "tendon_elongation", "gravity"});
  EXPECT_EQ(mjcf_of(joint, {}).left_out, std::vector<std::string>{"gravity"});
  EXPECT_NE(mjcf_of(joint, {}).text.find("without gravity"), std::string::npos);
  joint.terms = {"motor_angle", "play"};
  joint.parameters.coefficients[joint.catalogue->term("play").first_coefficient] = 0.4;  // follows half-way in the gap
  EXPECT_EQ(mjcf_of(joint, {}).left_out, std::vector<std::string>{"play"});
}

// A spring that pushes is no tendon: it is a joint that is counted against its motor.
TEST(Mjcf, ElongationOfTheOtherSignIsToldWithItsCure) {
  JointFile joint = law({"motor_angle", "joint_offset", "tendon_elongation"});
  EXPECT_TRUE(mjcf_of(joint, {}).warnings.empty());
  joint.parameters.coefficients[joint.catalogue->term("motor_angle").first_coefficient] *= -1.0;
  const auto warnings = mjcf_of(joint, {}).warnings;
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings.front().find("Count the joint the other way"), std::string::npos) << warnings.front();
  EXPECT_EQ(warnings.front().find("no counterpart"), std::string::npos) << warnings.front();
  const std::size_t elongation = joint.catalogue->term("tendon_elongation").first_coefficient;
  joint.parameters.coefficients[elongation] = joint.parameters.coefficients[elongation + 1] = 0.0;
  EXPECT_TRUE(mjcf_of(joint, {}).warnings.empty()) << "a tendon that does not stretch is stiff";
}

TEST(Mjcf, ATendonJoinsTwoHingesThatHaveNames) {
  const JointFile joint = law({"motor_angle"});
  EXPECT_THROW(mjcf_of(joint, {.motor = ""}), BadInput);
  EXPECT_THROW(mjcf_of(joint, {.tendon = ""}), BadInput);
  EXPECT_THROW(mjcf_of(joint, {.motor = "m", .joint = "m"}), BadInput);
}

TEST(Mjcf, LawWithoutARatioIsRefused) {
  JointFile joint = law({"motor_angle"});
  joint.parameters.coefficients[joint.catalogue->term("motor_angle").first_coefficient] = 0.0;
  EXPECT_THROW(mjcf_of(joint, {}), Refusal);
}

}  // namespace
}  // namespace capstan::tools
