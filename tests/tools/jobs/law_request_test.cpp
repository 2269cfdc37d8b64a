// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/jobs/law_request.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/tools/own_folder.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Three rows of columns that move or rest.
auto log_of(const std::string& name, const std::vector<std::string>& moving,
            const std::vector<std::string>& resting = {}) -> CsvLog {
  std::string text = "time_s";
  for (const auto* columns : {&moving, &resting}) {
    for (const auto& column : *columns) {
      text += "," + column;
    }
  }
  text += "\n";
  for (int row = 0; row < 3; ++row) {
    text += std::to_string(row);
    for (std::size_t i = 0; i < moving.size(); ++i) {
      text += "," + std::to_string(row);
    }
    for (std::size_t i = 0; i < resting.size(); ++i) {
      text += ",7";
    }
    text += "\n";
  }
  return CsvLog::parse(text, name);
}

auto sentence_of(const auto& act) -> std::string {
  try {
    act();
  } catch (const BadInput& error) {
    return error.what();
  }
  return "";
}

TEST(LawRequest, ALawIsGivenTheTorqueThatItReads) {
  for (const char* model : {"pseudo_kinematic", "pretensioned", "dynamic", "multi_dof", "tendon"}) {
    EXPECT_TRUE(request_for(model, "", {}).columns.needs_torque) << model;
  }
  for (const char* model : {"", "kinematic", "rigid_dynamics", "inertia"}) {
    EXPECT_FALSE(request_for(model, "", {}).columns.needs_torque) << model;
  }
  // An effort's law for a joint angle is refused by who knows the logs, not for the want of its terms.
  EXPECT_FALSE(request_for("rigid_dynamics", "axis0/q2_rad", {}).columns.needs_torque);
}

TEST(LawRequest, WhatALawExplainsFollowsFromItsNameAndTheTarget) {
  EXPECT_TRUE(request_for("rigid_dynamics", "", {}).columns.effort);
  EXPECT_TRUE(request_for("", "axis0/tau_Nm", {}).columns.effort);
  EXPECT_FALSE(request_for("pseudo_kinematic", "", {}).columns.effort);
  EXPECT_TRUE(request_for("pull_push", "", {}).columns.force);
  EXPECT_FALSE(request_for("pull_push", "axis0/tau_out_Nm", {}).columns.effort);
  EXPECT_THROW(request_for("", "motor_A", {}), Refusal);
  EXPECT_NE(sentence_of([] { request_for("", "axis3/q1_rad", {}); }).find("name the joint's, axis3/q2_rad"),
            std::string::npos);
  EXPECT_NE(sentence_of([] {
              request_for("", "", {.files = {}, .axis = 2, .coupled_to = {2}});
            }).find("--coupled-to 2 is the axis itself"),
            std::string::npos);
}

class LawRequestFile : public test::OwnFolder {};

TEST_F(LawRequestFile, AFilesLawSaysWhatItIsCoupledToAndReads) {
  JointFile joint;
  joint.terms = {"motor_angle", "axis_coupling"};
  joint.parameters.coefficients[catalogue_term("motor_angle").first_coefficient] = 0.9;
  joint.coupled_to = {2};
  const std::string file = path("joint.toml");
  write_joint_file(file, joint);
  const LawRequest asked = request_for(file, "", {});
  ASSERT_TRUE(asked.law);
  EXPECT_EQ(asked.columns.other_axes, std::vector<int>{2});
  EXPECT_FALSE(asked.columns.needs_torque) << "another axis's torque is not this one's";
  const JobLogs others{.files = {}, .axis = 0, .coupled_to = {1}};
  EXPECT_NE(sentence_of([&] { request_for(file, "", others); }).find("is coupled to axis 2; leave --coupled-to out"),
            std::string::npos);
  EXPECT_NE(sentence_of([&] { request_for(file, "axis0/tau_Nm", {}); }).find("explains a joint angle"),
            std::string::npos);
  joint.coupled_to.clear();
  joint.terms = {"motor_angle", "tendon_elongation"};
  EXPECT_TRUE(columns_of_law(joint, 3).needs_torque);
  EXPECT_EQ(columns_of_law(joint, 3).axis, 3);
}

TEST(LawRequest, AxesThatMoveInAnyLogTakeTheirSlotsInAll) {
  AxisRequest request;
  add_moving_axes({log_of("a", {"axis0/q1_rad", "axis3/q1_rad"}, {"axis1/q1_rad"}),
                   log_of("b", {"axis0/q1_rad", "axis2/q1_m"}, {"axis3/q1_rad"})},
                  request);
  EXPECT_EQ(request.moving_axes, (std::vector<int>{2, 3}));
  add_moving_axes({log_of("c", {"axis1/q1_rad", "axis3/q1_rad"})}, request);
  EXPECT_EQ(request.moving_axes, (std::vector<int>{2, 3, 1})) << "a law that is there keeps its slots";
}

TEST(LawRequest, TorqueIsNeededOfAllLogsOrOfNone) {
  const CsvLog with = log_of("with", {"axis0/q1_rad", "axis0/tau_Nm"});
  const CsvLog without = log_of("without", {"axis0/q1_rad"});
  AxisRequest request;
  need_torque_of_all({without}, {with}, request);
  EXPECT_FALSE(request.needs_torque) << "a law of logs without reads none";
  need_torque_of_all({with}, {with}, request);
  EXPECT_TRUE(request.needs_torque);
  EXPECT_NE(sentence_of([&] { need_torque_of_all({with}, {without}, request); }).find("without:1: there is no column"),
            std::string::npos);
  EXPECT_NE(sentence_of([&] {
              need_torque_of_all({without, with}, {}, request);
            }).find("without:1: there is no column"),
            std::string::npos);
  AxisRequest beside;
  beside.moving_axes = {1};
  const std::string sentence = sentence_of([&] {
    need_torque_of_all({log_of("a", {"axis0/q1_rad", "axis1/q1_rad", "axis1/tau_Nm"})},
                       {log_of("b", {"axis0/q1_rad", "axis1/q1_rad"})}, beside);
  });
  EXPECT_NE(sentence.find("b:1: there is no column axis1/tau_Nm"), std::string::npos) << sentence;
  EXPECT_FALSE(beside.needs_torque);
  AxisRequest effort{.effort = true};
  need_torque_of_all({with, without}, {}, effort);
  EXPECT_FALSE(effort.needs_torque) << "it is explained, or none of the law's business";
}

}  // namespace
}  // namespace capstan::tools
