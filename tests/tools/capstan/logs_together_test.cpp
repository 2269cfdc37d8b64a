// SPDX-License-Identifier: Apache-2.0
// Several logs of one joint that do not show the same: another axis rests in one of them, or a column is missing.
#include <nlohmann/json.hpp>

#include "capstan/tests/tools/capstan/command_fixture.hpp"
#include "capstan/tests/tools/capstan/made_up_joint.hpp"

namespace capstan::tools {
namespace {

constexpr double kTwiceTheNoise = 1e-3;

class LogsTogether : public Command {
 protected:
  auto write(const std::string& name, const std::string& text) const -> std::string {
    write_text_file(path(name), text);
    return "\"" + path(name) + "\" ";
  }
  auto joint(const std::string& name, const test::MadeUpJoint& joint,
             const std::vector<std::string>& without = {}) const -> std::string {
    return write(name, test::joint_log(joint, without));
  }
  auto json_of(const std::string& arguments) const -> nlohmann::json {
    const Outcome outcome = run(arguments + " --json \"" + path("answer.json") + "\"");
    EXPECT_NE(outcome.status, 2) << outcome.output;
    return nlohmann::json::parse(read_text_file(path("answer.json")));
  }
  void expect_bad(const std::string& arguments, const std::string& sentence) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << "\n" << outcome.output;
    EXPECT_NE(outcome.output.find(sentence), std::string::npos) << arguments << "\n" << outcome.output;
  }
};

TEST_F(LogsTogether, AnAxisThatRestsInOneLogKeepsItsSlotThere) {
  const std::string both = joint("both.csv", {.seed = 1, .of_axis2 = 0.2});
  const std::string second = joint("second.csv", {.seed = 2, .axis1_moves = false, .of_axis2 = 0.2});
  const auto fitted = json_of("diagnose " + both + second);
  EXPECT_LT(fitted["after"]["rmse"], kTwiceTheNoise) << fitted["reason"];
  const auto tested = json_of("diagnose " + both + "--test " + second);
  EXPECT_LT(tested["test"][0]["after"]["rmse"], 0.005) << "50 mrad by the other axis";
}

TEST_F(LogsTogether, ACouplingIsThatOfOneAxis) {
  const std::string both = joint("both.csv", {.seed = 1, .of_axis1 = 0.2, .others_torque = true});
  const std::string second =
      joint("second.csv", {.seed = 2, .axis1_moves = false, .of_axis1 = 0.2, .others_torque = true});
  const std::string law = path("joint.toml");
  const Outcome outcome = run("identify " + second + both + "--model multi_dof -o \"" + law + "\"");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(read_text_file(law).find("[coupling]\njoint = 1"), std::string::npos) << read_text_file(law);
}

TEST_F(LogsTogether, AnAxisThatMovesInOneHasToBeInAll) {
  const std::string both = joint("both.csv", {.seed = 1});
  const std::string without = joint("without.csv", {.seed = 2}, {"axis2/q1_rad"});
  const std::string sentence = "axis 2 moves in another of the logs, and the log has no axis2/q1_rad; record that axis";
  expect_bad("diagnose " + both + without, sentence);
  expect_bad("diagnose " + both + "--test " + without, sentence);
  expect_bad("identify " + both + without, sentence);
  expect_bad("compare " + both + "-- " + without, sentence);
}

TEST_F(LogsTogether, AnAxisThatRestsInOneLogCouplesAnEffortInTheOthers) {
  const std::string moving = write("moving.csv", test::effort_log({.seed = 1}));
  const std::string resting = write("resting.csv", test::effort_log({.seed = 2, .axis1_moves = false}));
  const std::string unseen = write("unseen.csv", test::effort_log({.seed = 3}));
  const auto answer = json_of("diagnose " + moving + resting + "--target axis0/tau_Nm --test " + unseen);
  EXPECT_LT(answer["after"]["rmse"], kTwiceTheNoise);
  EXPECT_LT(answer["test"][0]["after"]["rmse"], kTwiceTheNoise);
}

TEST_F(LogsTogether, TorqueThatOneLogHasIsNotTakenForNothingInAnother) {
  const std::string with = joint("with.csv", {.seed = 1, .friction_nm = 0.3});
  const std::string without = joint("without.csv", {.seed = 2, .friction_nm = 0.3}, {"axis0/tau_Nm"});
  const std::string sentence = "without.csv:1: there is no column axis0/tau_Nm, which other logs have";
  expect_bad("diagnose " + with + without, sentence);
  expect_bad("diagnose " + with + "--test " + without, sentence);
  expect_bad("compare " + with + "-- " + without, sentence);
  expect_bad("compare " + without + "-- " + with, sentence);
  EXPECT_EQ(run("identify " + with + without + "--model kinematic").status, 0) << "which reads none";
}

TEST_F(LogsTogether, ALawOfTendonsSaysNothingWithoutTorque) {
  const std::string log = joint("log.csv", {}, {"axis0/tau_Nm"});
  expect_bad("identify " + log + "--model tendon", "there is no column axis0/tau_Nm");
  expect_bad("diagnose " + log + "--base tendon", "there is no column axis0/tau_Nm");
  const std::string law = write("tendon.toml", R"(schema = "capstan.joint/1"
[conditioner]
direction_threshold = { value = 0.001, unit = "rad" }
rate_time_constant = { value = 0.002, unit = "s" }
[terms.motor_angle]
beta = { value = 0.9, unit = "1" }
[terms.tendon]
compliance = { value = 0.15, unit = "rad/Nm" }
eta_top = { value = 1.0, unit = "1" }
eta_bottom = { value = 1.0, unit = "1" }
pretension = { value = 1.0, unit = "Nm" }
top_share = { value = 0.5, unit = "1" }
friction = { value = 0.1, unit = "Nm" }
viscous = { value = 0.02, unit = "Nms/rad" }
inertia = { value = 1.5, unit = "gm2" }
)");
  expect_bad("replay " + log + "--arithmetic double --model " + law + "-o \"" + path("out.csv") + "\"",
             "there is no column axis0/tau_Nm");
}

TEST_F(LogsTogether, ASlideBesideMayBeLoggedLessOften) {
  std::string text;
  const std::string effort = test::effort_log({.seed = 1});
  std::size_t row = 0;
  for (std::size_t begin = 0; begin < effort.size(); ++row) {
    const std::size_t end = effort.find('\n', begin);
    const std::string line = effort.substr(begin, end - begin);
    text += row == 0 ? "time_s,axis0/q1_rad,axis0/tau_Nm,axis1/q1_m"
                     : (row % 2 == 0 ? line.substr(0, line.rfind(',') + 1) : line);
    text += "\n";
    begin = end + 1;
  }
  const Outcome outcome = run("diagnose " + write("rates.csv", text) + "--target axis0/tau_Nm");
  EXPECT_NE(outcome.status, 2) << outcome.output;
  EXPECT_NE(outcome.output.find("the channels have different rates"), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace capstan::tools
