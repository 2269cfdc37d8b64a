// SPDX-License-Identifier: Apache-2.0
#include "tools/joint_file/joint_file.hpp"

#include <gtest/gtest.h>

#include "tools/identify/term_catalogue.hpp"
#include "tools/support/errors.hpp"

namespace capstan::tools {
namespace {

const std::string kHead =
    "schema = \"capstan.joint/1\"\n"
    "[conditioner]\n"
    "direction_threshold = { value = 0.001, unit = \"rad\" }\n"
    "rate_time_constant = { value = 0.005, unit = \"s\" }\n";
const std::string kRatio = "[terms.motor_angle]\nbeta = { value = 1.08, unit = \"1\", ci95 = [1.07, 1.09] }\n";

auto refusal_of(const std::string& text) -> std::string {
  try {
    parse_joint_file(text, "joint.toml");
  } catch (const BadInput& error) {
    return error.what();
  }
  return "accepted";
}

auto coefficient_of(const JointFile& joint, const std::string& term, std::size_t i = 0) -> double {
  return joint.parameters.coefficients[catalogue_term(term).first_coefficient + i];
}

TEST(JointFile, BytesThatAreNoTextAreRefusedWithTheirLineBeforeTheyReachTheParser) {
  const std::string refusal = refusal_of(kHead + std::string("[\0\0\0econdc:\0r]\n", 13));
  EXPECT_NE(refusal.find("joint.toml:5: there are bytes that are no text; "), std::string::npos) << refusal;
}

TEST(JointFile, LettersOutsideAsciiSurviveInNamesOfLogsAndAreRefusedAsKeys) {
  const std::string log = "\u00fcbung ~x41 30\u00b0.csv";
  JointFile joint = parse_joint_file("# \u00b0\n" + kHead + kRatio, "joint.toml");
  joint.fit = FitSummary{.rmse = 0.1, .gof_percent = 90.0, .samples = 5, .logs = {log}};
  const JointFile again = parse_joint_file(joint_file_text(joint), "joint.toml");
  ASSERT_TRUE(again.fit.has_value());
  EXPECT_EQ(again.fit->logs, std::vector<std::string>{log});
  EXPECT_EQ(refusal_of(kHead + "\u00fc = 1\n").rfind("joint.toml:5: ", 0), 0U) << refusal_of(kHead + "\u00fc = 1\n");
}

TEST(JointFile, AHeaderThatIsNoKeyIsRefusedWithItsLine) {
  const std::string refusal = refusal_of("schema = \"capstan.joint/1\"\n[$x]\ny = 1\n");
  EXPECT_EQ(refusal.rfind("joint.toml:2: this is not TOML: ", 0), 0U) << refusal;
}

TEST(JointFile, TheAxisThatPullsIsKept) {
  JointFile joint = parse_joint_file(kHead + kRatio + "[coupling]\njoint = 2\n", "joint.toml");
  EXPECT_EQ(joint.coupled_to, 2);
  joint = parse_joint_file(joint_file_text(joint), "joint.toml");
  EXPECT_EQ(joint.coupled_to, 2);
  for (const char* bad : {"joint = 4", "joint = -1", "joint = 0.5", "axis = 1"}) {
    const std::string refusal = refusal_of(kHead + kRatio + "[coupling]\n" + bad + "\n");
    EXPECT_EQ(refusal.rfind("joint.toml:", 0), 0U) << bad << ": " << refusal;
  }
}

TEST(JointFile, TermsThatAreMissingAreOff) {
  const JointFile joint = parse_joint_file(kHead + kRatio, "joint.toml");
  EXPECT_EQ(coefficient_of(joint, "motor_angle"), 1.08);
  EXPECT_EQ(coefficient_of(joint, "play"), 0.0);
  EXPECT_EQ(joint.parameters.shapes[catalogue_term("transport_delay").first_shape], 0.0);
  EXPECT_EQ(joint.terms, std::vector<std::string>{"motor_angle"});
}

TEST(JointFile, WhatIsWrittenReadsBackTheSame) {
  JointFile joint;
  for (const auto& term : term_catalogue()) {
    joint.terms.push_back(term.name);
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      const double size = 0.1 + 0.01 * static_cast<double>(term.first_coefficient + i) + 1.0 / 3.0;
      joint.parameters.coefficients[term.first_coefficient + i] =
          term.coefficients[i].sign == Sign::kNonPositive ? -size : size;
      joint.coefficient_ci95[term.first_coefficient + i] = Interval{-1.0 / 7.0, 2.0 / 3.0};
    }
    for (std::size_t i = 0; i < term.shapes.size(); ++i) {
      joint.parameters.shapes[term.first_shape + i] =
          term.shapes[i].minimum + (term.shapes[i].maximum - term.shapes[i].minimum) / 3.0;
    }
  }
  joint.parameters.conditioner.direction_threshold_rad = 1.0 / 3000.0;
  joint.steady_torque = SteadyTorque{0.02, -1.0 / 30.0};
  joint.fit = FitSummary{1.0 / 700.0, 97.0 / 3.0, 32000, {"a \"b\".csv", "c.csv"}};
  const JointFile again = parse_joint_file(joint_file_text(joint), "joint.toml");
  EXPECT_EQ(again.parameters.coefficients, joint.parameters.coefficients);
  EXPECT_EQ(again.parameters.shapes, joint.parameters.shapes);
  EXPECT_EQ(again.parameters.conditioner.direction_threshold_rad, joint.parameters.conditioner.direction_threshold_rad);
  EXPECT_EQ(again.coefficient_ci95, joint.coefficient_ci95);
  EXPECT_EQ(again.terms, joint.terms);
  EXPECT_EQ(again.steady_torque->backward_nm, joint.steady_torque->backward_nm);
  EXPECT_EQ(again.fit->logs, joint.fit->logs);
  EXPECT_EQ(again.fit->rmse, joint.fit->rmse);
}

TEST(JointFile, EveryMistakeGetsItsLineAndACure) {
  struct Case {
    std::string text, expected;
  };
  const std::vector<Case> cases = {
      {"schema = \"capstan.joint/2\"\n", "joint.toml:1: the schema is not capstan.joint/1"},
      {"not toml at all [", "joint.toml:1: this is not TOML"},
      {kHead, "the law has no ratio; write [terms.motor_angle]"},
      {kHead + kRatio + "gamma = 1\n", "joint.toml:7: unknown key gamma in [terms.motor_angle]; known are beta"},
      {kHead + kRatio + "[terms.wobble]\nx = 1\n", "joint.toml:7: unknown key wobble in [terms]; known are "},
      {kHead + kRatio + "[extra]\n", "joint.toml:7: unknown key extra in the file"},
      {kHead + "[terms.motor_angle]\nbeta = 1.08\n", "joint.toml:6: beta has no unit; write beta = { value"},
      {kHead + "[terms.motor_angle]\nbeta = { unit = \"1\" }\n", "joint.toml:6: beta has no value"},
      {kHead + "[terms.motor_angle]\nbeta = { value = nan, unit = \"1\" }\n",
       "joint.toml:6: beta is not a finite number"},
      {kHead + "[terms.motor_angle]\nbeta = { value = \"1\", unit = \"1\" }\n",
       "joint.toml:6: beta is not a finite number"},
      {kHead + "[terms.motor_angle]\nbeta = { value = 1.0, unit = \"rad\" }\n",
       "joint.toml:6: beta must be given in \"1\""},
      {kHead + "[terms.motor_angle]\nbeta = { value = 200, unit = \"1\" }\n",
       "joint.toml:6: beta = 200 1 is out of range"},
      {kHead + "[terms.motor_angle]\nbeta = { value = 0.0, unit = \"1\" }\n", "too near zero"},
      {kHead + kRatio + "[terms.tendon_elongation]\ntop = { value = -1, unit = \"rad/Nm\" }\n", "bottom is missing"},
      {kHead + kRatio + "[terms.pretension_offset]\ncontrast = { value = -0.1, unit = \"rad\" }\n",
       "joint.toml:8: contrast = -0.1 rad is out of range; it must be from 0 to"},
      {kHead + kRatio + "[terms.transport_delay]\ndelay = { value = 0.9, unit = \"s\" }\n",
       "joint.toml:8: delay = 0.9 s is out of range; it must be from 0 to 0.06"},
      {kHead + kRatio + "[feedforward]\ntorque_forward = { value = 1, unit = \"Nm\" }\n", "torque_backward is missing"},
      {"schema = \"capstan.joint/1\"\n" + kRatio, "[conditioner] is missing"},
  };
  for (const auto& one : cases) {
    const std::string message = refusal_of(one.text);
    EXPECT_NE(message.find(one.expected), std::string::npos)
        << "expected: " << one.expected << "\n     got: " << message;
  }
}

TEST(JointFile, FixedPointParametersAreTheNearestOnes) {
  LawParameters<double> law = rigid_law();
  law.coefficients[1] = -1.0 / 3.0;
  const LawParameters<Q24> fixed = to_fixed(law);
  for (std::size_t i = 0; i < law.coefficients.size(); ++i) {
    EXPECT_NEAR(fixed.coefficients[i].to_double(), law.coefficients[i], 0.51 / (1 << 24));
  }
  for (std::size_t i = 0; i < law.shapes.size(); ++i) {
    EXPECT_NEAR(fixed.shapes[i].to_double(), law.shapes[i], 0.51 / (1 << 24));
  }
}

}  // namespace
}  // namespace capstan::tools
