// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/joint_file/joint_file.hpp"

#include <gtest/gtest.h>

#include "capstan/tools/identify/term_catalogue.hpp"
#include "capstan/tools/support/errors.hpp"

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

TEST(JointFile, AByteOrderMarkIsNoPartOfTheText) {
  EXPECT_TRUE(parse_joint_file("\xEF\xBB\xBF" + kHead + kRatio, "joint.toml").has("motor_angle"));
}

TEST(JointFile, AHeaderThatIsNoKeyIsRefusedWithItsLine) {
  const std::string refusal = refusal_of("schema = \"capstan.joint/1\"\n[$x]\ny = 1\n");
  EXPECT_EQ(refusal.rfind("joint.toml:2: this is not TOML: ", 0), 0U) << refusal;
}

TEST(JointFile, ANumberOfEitherSignThatIsNothingWasLeftOutAndOneOfASignIsAtItsBound) {
  JointFile joint;
  const CatalogueTerm& weight = joint.catalogue->term("gravity");
  EXPECT_TRUE(joint.left_out(weight, 0));
  joint.coefficient_ci95[weight.first_coefficient] = Interval{-0.1, 0.1};
  EXPECT_FALSE(joint.left_out(weight, 0));
  joint.parameters.coefficients[weight.first_coefficient + 1] = 0.2;
  EXPECT_FALSE(joint.left_out(weight, 1));
  for (const auto& term : *joint.catalogue) {
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      EXPECT_TRUE(term.coefficients[i].sign == Sign::kAny || !joint.left_out(term, i)) << term.name;
    }
  }
}

TEST(JointFile, TheAxisThatPullsIsKept) {
  JointFile joint = parse_joint_file(kHead + kRatio + "[coupling]\njoint = 2\n", "joint.toml");
  EXPECT_EQ(joint.coupled_to, std::vector<int>{2});
  joint = parse_joint_file(joint_file_text(joint), "joint.toml");
  EXPECT_EQ(joint.coupled_to, std::vector<int>{2});
  for (const char* bad : {"joint = 16", "joint = -1", "joint = 0.5", "axis = 1"}) {
    const std::string refusal = refusal_of(kHead + kRatio + "[coupling]\n" + bad + "\n");
    EXPECT_EQ(refusal.rfind("joint.toml:", 0), 0U) << bad << ": " << refusal;
  }
}

TEST(JointFile, SeveralAxesThatPullKeepTheirOrder) {
  JointFile joint = parse_joint_file(kHead + kRatio + "[coupling]\njoints = [2, 0, 9]\n", "joint.toml");
  EXPECT_EQ(joint.coupled_to, (std::vector<int>{2, 0, 9}));
  joint = parse_joint_file(joint_file_text(joint), "joint.toml");
  EXPECT_EQ(joint.coupled_to, (std::vector<int>{2, 0, 9}));
  for (const char* bad : {"joints = [1, 1]", "joints = [0, 1, 2, 3]", "joints = [16]", "joints = [1, -1]"}) {
    EXPECT_NE(refusal_of(kHead + kRatio + "[coupling]\n" + bad + "\n").find("[coupling] does not name axes; write"),
              std::string::npos)
        << bad;
  }
  const std::string third =
      "[terms.coupled_hysteresis_3]\nangle = { value = 0.1, unit = \"1\" }\n"
      "lost = { value = 0.1, unit = \"1\" }\nhalf_width = { value = 0.1, unit = \"rad\" }\n";
  EXPECT_NE(refusal_of(kHead + kRatio + third + "[coupling]\njoints = [1, 2]\n").find("reads 3 coupled axes"),
            std::string::npos);
}

TEST(JointFile, TheStatusOfALawIsKeptAndAnOldFileIsConfirmed) {
  EXPECT_EQ(parse_joint_file(kHead + kRatio, "joint.toml").status, LawStatus::kConfirmed);
  for (const auto status : {LawStatus::kConfirmed, LawStatus::kProvisional, LawStatus::kBase}) {
    JointFile joint;
    joint.terms = {"motor_angle"};
    joint.status = status;
    EXPECT_EQ(parse_joint_file(joint_file_text(joint), "joint.toml").status, status);
  }
  EXPECT_NE(refusal_of("status = \"sure\"\n" + kHead + kRatio).find("joint.toml:1: unknown status; "),
            std::string::npos);
}

TEST(JointFile, PlaysThatALawDoesNotHaveNeedNoLines) {
  const std::string text = kHead + kRatio + "[terms.hysteresis]\nhalf_width_2 = { value = 0.1, unit = \"rad\" }\n" +
                           "weight_2 = { value = 0.5, unit = \"1\" }\n";
  JointFile joint = parse_joint_file(text, "joint.toml");
  const auto written = joint_file_text(joint);
  EXPECT_EQ(written.find("weight_1"), std::string::npos);
  EXPECT_NE(written.find("weight_2"), std::string::npos);
  EXPECT_EQ(parse_joint_file(written, "joint.toml").parameters.shapes, joint.parameters.shapes);
}

const std::string kTable = "[terms.table]\nsignal = \"torque\"\n";

TEST(JointFile, ATableIsListsOfKnotsAndValues) {
  const JointFile joint = parse_joint_file(
      kHead + kRatio + kTable + "knots = [-1, 0.5, 2]\nforward = [0.1, 0, -0.2]\nbackward = [0.3, 0.25, 0.5]\n",
      "joint.toml");
  const auto& term = catalogue_term("table");
  const auto shape = [&](std::size_t i) { return joint.parameters.shapes[term.first_shape + i]; };
  EXPECT_EQ(shape(0), 1.0);
  EXPECT_EQ(shape(1), 3.0);
  EXPECT_EQ(shape(2), -1.0);
  EXPECT_EQ(shape(3), 2.0);
  EXPECT_EQ(coefficient_of(joint, "table", 2), -0.2);
  EXPECT_EQ(coefficient_of(joint, "table", Table<double>::kKnots + 1), 0.25);
  const JointFile again = parse_joint_file(joint_file_text(joint), "joint.toml");
  EXPECT_EQ(again.parameters.coefficients, joint.parameters.coefficients);
  EXPECT_EQ(again.parameters.shapes, joint.parameters.shapes);
}

TEST(JointFile, ATableHasAFactorWhereOneIsWritten) {
  const std::string lists = "knots = [-1, 0.5, 2]\nforward = [0.1, 0, -0.2]\nbackward = [0.3, 0.25, 0.5]\n";
  const std::size_t factor = catalogue_term("table").first_shape + 4;
  const auto read = [&](const std::string& line) {
    return parse_joint_file(kHead + kRatio + kTable + lists + line, "");
  };
  EXPECT_EQ(read("").parameters.shapes[factor], 0.0) << "as in files of versions without factors";
  EXPECT_EQ(joint_file_text(read("")).find("factor = "), std::string::npos) << "which read it then";
  const JointFile joint = read("factor = \"rate\"\n");
  EXPECT_EQ(joint.parameters.shapes[factor], 2.0);
  const std::string text = joint_file_text(joint);
  EXPECT_NE(text.find("factor = \"rate\""), std::string::npos);
  EXPECT_NE(text.find("motor torque, Nm, times motor rate, rad/s"), std::string::npos);
  EXPECT_EQ(parse_joint_file(text, "").parameters.shapes, joint.parameters.shapes);
  EXPECT_NE(refusal_of(kHead + kRatio + kTable + lists + "factor = \"mood\"\n").find("the table's factor is none"),
            std::string::npos);
}

TEST(JointFile, ATableThatIsNoneIsRefusedWithTheCure) {
  const auto refusal = [](const std::string& lines) { return refusal_of(kHead + kRatio + lines); };
  const std::string two = "forward = [0, 1]\nbackward = [0, 1]\n";
  const std::string three = "forward = [0, 1, 2]\nbackward = [0, 1, 2]\n";
  EXPECT_NE(refusal(kTable + "knots = [1, 0.5]\n" + two).find("is not above the one before, 1; put the knots in"),
            std::string::npos);
  EXPECT_NE(refusal(kTable + "knots = [0, 1, 1.5]\n" + three).find("is not evenly spaced; interpolate"),
            std::string::npos);
  EXPECT_NE(refusal(kTable + "knots = [0, 1, 2]\n" + two).find("give one for each knot"), std::string::npos);
  EXPECT_NE(refusal(kTable + "knots = [0]\nforward = [0]\nbackward = [0]\n").find("1 knots; give 2 to 17"),
            std::string::npos);
  EXPECT_NE(refusal(kTable + "knots = 3\n" + two).find("knots is not a list of numbers; write"), std::string::npos);
  EXPECT_NE(refusal("[terms.table]\nsignal = \"mood\"\nknots = [0, 1]\n" + two).find("the table's signal is none"),
            std::string::npos);
  EXPECT_NE(refusal(kTable + "knots = [0, 1]\nforward = [0, 200]\nbackward = [0, 0]\n").find("out of range"),
            std::string::npos);
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
  joint.coupled_to = {1, 2, 3};
  // A table is lists: what its unused knots have is not kept, nor intervals, and its choices are whole.
  const auto& table = catalogue_term("table");
  const auto shape = joint.parameters.shapes.begin() + static_cast<std::ptrdiff_t>(table.first_shape);
  shape[0] = 2.0;
  shape[1] = static_cast<double>(Table<double>::kKnots);
  shape[3] = shape[2] + 8.0;
  for (std::size_t i = 0; i < table.coefficients.size(); ++i) {
    joint.coefficient_ci95[table.first_coefficient + i] = {};
  }
  joint.parameters.conditioner.direction_threshold_rad = 1.0 / 3000.0;
  joint.steady_torque = SteadyTorque{0.02, -1.0 / 30.0};
  joint.fit = FitSummary{.rmse = 1.0 / 700.0,
                         .gof_percent = 97.0 / 3.0,
                         .samples = 32000,
                         .motor_range = Interval{-1.0 / 3.0, 2.0},
                         .loop_half_width = 1.0 / 19.0,
                         .loop_torque = 1.0 / 23.0,
                         .late = 1.0 / 2100.0,
                         .torque = TorqueParts{{1.0 / 3.0, -0.02, 1e-4, 1.0 / 7e4, 0.05, -1.0 / 9.0, 0.0, 2.0}},
                         .friction_rms = 1.0 / 900.0,
                         .error_bar = ErrorBarNumbers{{0.01, 1.0 / 30.0, 0.2, -4.0 / 3.0, 2.1, 1.0 / 3.0}},
                         .pretension = PretensionNumbers{{0.05, 0.01, 0.07, 1e-3, 1.1, 0.03, 2.6e-3, 270.5, 3.5}},
                         .joint_range = 2.2,
                         .logs = {"a \"b\".csv", "c.csv"}};
  const JointFile again = parse_joint_file(joint_file_text(joint), "joint.toml");
  EXPECT_EQ(again.parameters.coefficients, joint.parameters.coefficients);
  EXPECT_EQ(again.parameters.shapes, joint.parameters.shapes);
  EXPECT_EQ(again.parameters.conditioner.direction_threshold_rad, joint.parameters.conditioner.direction_threshold_rad);
  EXPECT_EQ(again.coefficient_ci95, joint.coefficient_ci95);
  EXPECT_EQ(again.terms, joint.terms);
  EXPECT_EQ(again.steady_torque->backward_nm, joint.steady_torque->backward_nm);
  EXPECT_EQ(again.fit->logs, joint.fit->logs);
  EXPECT_EQ(again.fit->rmse, joint.fit->rmse);
  EXPECT_EQ(again.fit->motor_range, joint.fit->motor_range);
  EXPECT_EQ(again.fit->joint_range, joint.fit->joint_range);
  EXPECT_EQ(again.fit->loop_half_width, joint.fit->loop_half_width);
  EXPECT_EQ(again.fit->loop_torque, joint.fit->loop_torque);
  EXPECT_EQ(again.fit->late, joint.fit->late);
  EXPECT_EQ(again.fit->friction_rms, joint.fit->friction_rms);
  ASSERT_TRUE(again.fit->error_bar);
  EXPECT_EQ(again.fit->error_bar->values, joint.fit->error_bar->values);
  ASSERT_TRUE(again.fit->pretension);
  EXPECT_EQ(again.fit->pretension->values, joint.fit->pretension->values);
  ASSERT_TRUE(again.fit->torque);
  EXPECT_EQ(again.fit->torque->values, joint.fit->torque->values);
}

TEST(JointFile, EveryMistakeGetsItsLineAndACure) {
  struct Case {
    std::string text, expected;
  };
  const std::vector<Case> cases = {
      {"schema = \"capstan.joint/2\"\n", "joint.toml:1: the law is of a newer version, capstan.joint/2, and this "},
      {"schema = \"capstan.joint/x\"\n", "joint.toml:1: the schema is not capstan.joint/1"},
      {"not toml at all [", "joint.toml:1: this is not TOML"},
      {kHead, "the law has no ratio; write [terms.motor_angle]"},
      {kHead + kRatio + "gamma = 1\n", "joint.toml:7: unknown key gamma in [terms.motor_angle]; known are beta"},
      {kHead + kRatio + "[terms.wobble]\nx = 1\n", "joint.toml:7: unknown key wobble in [terms]; known are "},
      {kHead + kRatio + "[[terms.play]]\n", "joint.toml:7: terms.play is not a table; write [terms.play]"},
      {kHead + kRatio + "[fit]\nrmse = { value = 0.1, unit = \"rad\" }\nerror_bar = 1\n",
       "joint.toml:9: fit.error_bar is not a table; write [fit.error_bar]"},
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
       "joint.toml:6: beta = 200 is out of range"},
      {kHead + "[terms.motor_angle]\nbeta = { value = 0.0, unit = \"1\" }\n", "too near zero"},
      {kHead + kRatio + "[terms.tendon_elongation]\ntop = { value = -1, unit = \"rad/Nm\" }\n", "bottom is missing"},
      {kHead + kRatio + "[terms.play]\ngain = { value = -0.1, unit = \"1\" }\n",
       "joint.toml:8: gain = -0.1 is out of range; it must be from 0 to"},
      {kHead + kRatio + "[terms.transport_delay]\ndelay = { value = 0.9, unit = \"s\" }\n",
       "joint.toml:8: delay = 0.9 s is out of range; it must be from 0 to 0.12"},
      {kHead + kRatio + "[feedforward]\ntorque_forward = { value = 1, unit = \"Nm\" }\n", "torque_backward is missing"},
      {"schema = \"capstan.joint/1\"\n" + kRatio, "[conditioner] is missing"},
      {"schema = \"capstan.joint/1\"\n[force]\nmodel = \"pull_push\"\n", "[force] alone, a law of the joint's torque"},
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
