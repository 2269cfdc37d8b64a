// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/capstan/command_fixture.hpp"
#include "capstan/tests/tools/capstan/made_up_joint.hpp"

namespace capstan::tools {
namespace {

class CompareCommand : public Command {
 protected:
  auto write(const std::string& name, const std::string& text) const -> std::string {
    write_text_file(path(name), text);
    return "\"" + path(name) + "\" ";
  }
  auto joint(const std::string& name, const test::MadeUpJoint& joint) const -> std::string {
    return write(name, test::joint_log(joint));
  }
};

auto says(const Outcome& outcome, const std::string& part) -> bool {
  return outcome.output.find(part) != std::string::npos;
}

TEST_F(CompareCommand, AnAxisThatRestsNowHasNotCome) {
  const std::string healthy = joint("healthy.csv", {.seed = 1, .of_axis1 = 0.3, .of_axis2 = 0.2});
  const std::string now = joint("now.csv", {.seed = 2, .axis1_moves = false, .of_axis1 = 0.3, .of_axis2 = 0.2});
  const Outcome outcome = run("compare " + healthy + "-- " + now);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_FALSE(says(outcome, "has come")) << outcome.output;
}

TEST_F(CompareCommand, AJointsOwnLawIsCoupledToTheAxisThatItNames) {
  const std::string healthy = joint("healthy.csv", {.seed = 1, .of_axis2 = 0.2, .others_torque = true});
  const std::string now = joint("now.csv", {.seed = 2, .of_axis2 = 0.25, .others_torque = true});
  const std::string law = "\"" + path("joint.toml") + "\" ";
  ASSERT_EQ(run("identify " + healthy + "--model multi_dof --coupled-to 2 -o " + law).status, 0);
  const Outcome moved = run("compare " + healthy + "--base " + law + "-- " + now);
  EXPECT_TRUE(says(moved, "axis_coupling.angle moved from ")) << moved.output;
  const Outcome effort = run("compare " + healthy + "--base " + law + "--target axis0/tau_Nm -- " + now);
  EXPECT_EQ(effort.status, 2) << effort.output;
  EXPECT_TRUE(says(effort, "explains a joint angle, and axis0/tau_Nm is an effort")) << effort.output;
  const Outcome other = run("compare " + healthy + "--base " + law + "--coupled-to 1 -- " + now);
  EXPECT_EQ(other.status, 2) << other.output;
  EXPECT_TRUE(says(other, "is coupled to axis 2; leave --coupled-to out")) << other.output;
}

TEST_F(CompareCommand, ARatioThatMovedIsSeenBesideZerosThatDiffer) {
  const std::string healthy = joint("h1.csv", {.seed = 1}) + joint("h2.csv", {.seed = 2, .zero_rad = 0.15});
  const std::string now =
      joint("n1.csv", {.seed = 3, .ratio = 0.905}) + joint("n2.csv", {.seed = 4, .ratio = 0.905, .zero_rad = 0.15});
  const Outcome outcome = run("compare " + healthy + "-- " + now);
  EXPECT_TRUE(says(outcome, "motor_angle.beta moved from ")) << outcome.output;
}

// Without the gap in the law the ratio would make up for it.
TEST_F(CompareCommand, WhereAGapHasComeTheRatioHasNotMoved) {
  const std::string healthy = joint("healthy.csv", {.seed = 1});
  const std::string now = joint("now.csv", {.seed = 2, .play_rad = 0.03});
  const Outcome outcome = run("compare " + healthy + "-- " + now);
  EXPECT_TRUE(says(outcome, "play has come")) << outcome.output;
  EXPECT_FALSE(says(outcome, "motor_angle.beta moved")) << outcome.output;
}

TEST_F(CompareCommand, FrictionThatAnAxisAlwaysHadHasNotCome) {
  const std::string healthy = write("healthy.csv", test::effort_log({.seed = 1, .axis1_moves = false}));
  const std::string now = write("now.csv", test::effort_log({.seed = 2, .axis1_moves = false}));
  const Outcome outcome = run("compare " + healthy + "--target axis0/tau_Nm -- " + now);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(says(outcome, "\nrigid_dynamics on the logs of now: effect")) << outcome.output;
  EXPECT_FALSE(says(outcome, "has come")) << outcome.output;
}

TEST_F(CompareCommand, ALogIsNotOfBothTimes) {
  const std::string log = joint("log.csv", {});
  const Outcome outcome = run("compare " + log + "-- " + log);
  EXPECT_EQ(outcome.status, 2) << outcome.output;
  EXPECT_TRUE(says(outcome, "log.csv is given twice")) << outcome.output;
}

}  // namespace
}  // namespace capstan::tools
