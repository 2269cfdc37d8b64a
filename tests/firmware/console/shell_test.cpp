// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/console/shell.hpp"

#include <gtest/gtest.h>

#include "capstan/firmware/console/shell_commands.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using Bench = test::Bench<2>;
using test::has_line;
using test::lines_of;
using test::verdict;

/// "error <name>: <sentence>; <cure>"
auto is_error(const std::string& line) -> bool {
  constexpr std::size_t kName = 6;
  const std::size_t colon = line.find(": ");
  const std::size_t semicolon = line.find("; ");
  return line.rfind("error ", 0) == 0 && colon != std::string::npos && colon > kName &&
         line.substr(kName, colon - kName).find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == std::string::npos &&
         semicolon != std::string::npos && semicolon > colon + 10 && line.size() > semicolon + 10;
}

/// The contract: exactly one final line, at the end.
auto keeps_contract(const std::string& answer) -> bool {
  const auto lines = lines_of(answer);
  const auto finals = std::count_if(lines.begin(), lines.end(), test::is_final);
  return finals == 1 && (lines.back() == "ok" || is_error(lines.back()));
}

TEST(Shell, EveryLineGetsOneAnswerByTheContract) {
  Bench bench;
  for (const char* line : {"help",
                           "version",
                           "status",
                           "faults",
                           "list",
                           "list joint0",
                           "list joint1.limits",
                           "list joint7",
                           "list joint0.nonsense",
                           "list joint0xlimits",
                           "list x",
                           "get joint0.control.kp",
                           "get joint0.control",
                           "get",
                           "get joint0.control.kp twice",
                           "set joint0.control.kp 1",
                           "set joint0.control.kp",
                           "set joint0.control.kp 99",
                           "set joint0.control.kp 1 Nm",
                           "set",
                           "dump",
                           "diff",
                           "begin",
                           "commit",
                           "commit",
                           "abandon",
                           "defaults",
                           "abandon",
                           "save",
                           "load",
                           "move joint0 1",
                           "move",
                           "hold joint0",
                           "hold",
                           "log joint0 5 2",
                           "log joint0",
                           "log",
                           "disarm",
                           "arm",
                           "move joint0 0.1",
                           "hold joint0",
                           "disarm",
                           "nonsense",
                           "",
                           "   ",
                           "# a remark",
                           "HELP",
                           "set joint0.limits.motor_min 9",
                           "maintenance",
                           "maintenance open",
                           "maintenance open wrong key",
                           "maintenance key",
                           "maintenance key short",
                           "maintenance key long-enough",
                           "maintenance open wrong-key",
                           "maintenance open long-enough",
                           "set joint0.limits.motor_min 9",
                           "maintenance key none",
                           "maintenance close",
                           "maintenance shut",
                           "reboot now",
                           "reboot",
                           "experiment joint0 multisine",
                           "experiment joint0 nonsense",
                           "experiment joint9 triangle",
                           "experiment joint0 triangle speeds=fast",
                           "experiment",
                           "palpate joint0",
                           "palpate",
                           "timing",
                           "model",
                           "zero joint0",
                           "scope",
                           "scope signals",
                           "scope channels joint0.q2",
                           "scope start 10 2",
                           "scope stop",
                           "scope dump",
                           "watch 1 joint0.q2",
                           "arm please",
                           "status all",
                           "log joint0 1 1 1"}) {
    const std::string answer = bench.say(line);
    EXPECT_TRUE(bench.answered) << line;
    EXPECT_TRUE(keeps_contract(answer)) << "'" << line << "' was answered by\n" << answer;
  }
}

TEST(Shell, HelpListsEveryCommandAndEveryListedCommandExists) {
  Bench bench;
  const std::string help = bench.say("help");
  for (const ShellCommand& command : shell_commands()) {
    EXPECT_TRUE(has_line(help, std::string("  ") + command.name + " ")) << command.name;
    EXPECT_EQ(bench.say(command.name).find("unknown_command"), std::string::npos) << command.name;
    bench.say("disarm");
  }
}

TEST(Shell, TheContractsCommandsOfThisVersionAreThere) {
  for (const char* name : {"help",  "status", "faults",   "get",    "set",     "list",   "diff",       "dump",
                           "save",  "load",   "defaults", "arm",    "disarm",  "move",   "hold",       "scope",
                           "watch", "log",    "model",    "timing", "version", "reboot", "experiment", "palpate"}) {
    const auto all = shell_commands();
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [name](const ShellCommand& c) {
      return std::string(name) == c.name;
    })) << name;
  }
}

TEST(Shell, VersionNamesTheBoardAndCountsJointsAndParameters) {
  Bench bench;
  const std::string answer = bench.say("version");
  EXPECT_NE(answer.find("capstan "), std::string::npos);
  EXPECT_NE(answer.find(" board bench "), std::string::npos) << answer;
  EXPECT_NE(answer.find("joints 2 parameters " + std::to_string(parameters().size())), std::string::npos) << answer;
}

TEST(Shell, StatusShowsStateFaultAndEveryJointWithUnits) {
  Bench bench;
  bench.io.motors[1].angle_rad = 0.5;
  bench.io.estop = true;
  bench.ticks(100);
  bench.say("zero joint1 0.5");  // it jumped there
  const std::string answer = bench.say("status");
  EXPECT_TRUE(has_line(answer, "state disarmed fault none cycles ")) << answer;
  EXPECT_TRUE(has_line(answer, "joint0 motor 0 rad torque 0 Nm joint 0 rad")) << answer;
  EXPECT_TRUE(has_line(answer, "joint1 motor 0.499")) << answer;
  bench.say("arm");
  bench.io.estop = false;
  bench.ticks(1);
  EXPECT_TRUE(has_line(bench.say("status"), "state disarmed"));
  bench.say("arm");
  EXPECT_TRUE(has_line(bench.say("status"), "state holding fault none")) << answer;
  bench.io.encoder = Quality::kMissing;
  bench.ticks(1);
  const std::string faulted = bench.say("status");
  EXPECT_TRUE(has_line(faulted, "state faulted fault sensor_missing")) << faulted;
  EXPECT_NE(faulted.find("(not valid)"), std::string::npos) << faulted;
  EXPECT_NE(faulted.find(" A (the last values of a sensor that is missing or invalid)"), std::string::npos) << faulted;
}

TEST(Shell, StatusNamesTheSettingBehindAnActiveLimit) {
  Bench bench;
  bench.io.motors[0].angle_rad = 0.0;
  bench.io.blocked = true;
  bench.say("set joint0.control.stiffness 100");
  bench.say("arm");
  bench.say("move joint0 0.3");
  bench.ticks(100);
  EXPECT_NE(bench.say("status").find("limited by limits.current"), std::string::npos);
}

TEST(Shell, FaultsShowsTheLatchedOneAndWhatIsPresentWithCauseAndCure) {
  Bench bench;
  bench.say("arm");
  bench.io.estop = true;
  bench.ticks(1);
  bench.io.current = Quality::kInvalid;
  bench.ticks(1);
  const std::string answer = bench.say("faults");
  const FaultInfo& stop = info(Fault::kEmergencyStop);
  const FaultInfo& invalid = info(Fault::kSensorInvalid);
  EXPECT_TRUE(has_line(answer, std::string("latched emergency_stop: ") + stop.cause + "; " + stop.cure)) << answer;
  EXPECT_TRUE(has_line(answer, std::string("present sensor_invalid: ") + invalid.cause + "; " + invalid.cure))
      << answer;
}

TEST(Shell, ArmGivesTorqueAndDisarmTakesIt) {
  Bench bench;
  EXPECT_EQ(verdict(bench.say("arm")), "ok");
  EXPECT_EQ(bench.state(), State::kHolding);
  EXPECT_TRUE(bench.io.has_torque());
  EXPECT_EQ(verdict(bench.say("disarm")), "ok");
  EXPECT_EQ(bench.state(), State::kDisarmed);
  EXPECT_FALSE(bench.io.has_torque());
}

TEST(Shell, ArmWithBlockersListsEachWithCauseAndCureAndGivesNoTorque) {
  Bench bench;
  bench.io.estop = true;
  bench.io.encoder = Quality::kMissing;
  bench.ticks(1);
  const std::string answer = bench.say("arm");
  for (const Fault fault : {Fault::kEmergencyStop, Fault::kSensorMissing}) {
    const FaultInfo& entry = info(fault);
    EXPECT_TRUE(has_line(answer, std::string("blocked by ") + entry.name + ": " + entry.cause + "; " + entry.cure))
        << answer;
  }
  EXPECT_EQ(verdict(answer).rfind("error blocked: ", 0), 0U) << answer;
  EXPECT_FALSE(bench.io.has_torque());
}

TEST(Shell, ArmInTheFaultedStateAsksForADisarmFirst) {
  Bench bench;
  bench.say("arm");
  bench.io.estop = true;
  bench.ticks(1);
  bench.io.estop = false;
  EXPECT_EQ(verdict(bench.say("arm")).rfind("error faulted: ", 0), 0U);
  EXPECT_EQ(verdict(bench.say("disarm")), "ok");
  EXPECT_EQ(verdict(bench.say("arm")), "ok");
}

TEST(Shell, ArmWithAWordTooManyDoesNotArmButDisarmAlwaysDisarms) {
  Bench bench;
  EXPECT_EQ(verdict(bench.say("arm joint0")).rfind("error usage: ", 0), 0U);
  EXPECT_EQ(bench.state(), State::kDisarmed);
  bench.say("arm");
  EXPECT_EQ(verdict(bench.say("disarm now, please!")), "ok");
  EXPECT_EQ(bench.state(), State::kDisarmed);
}

TEST(Shell, AWordThatNothingReadsIsRefusedAndNothingIsDone) {
  Bench bench;
  for (const char* line : {"frames off x", "scope signals x", "scope stop x", "scope dump x", "palpate map x",
                           "palpate clear x", "maintenance open x", "maintenance open x y", "maintenance close x",
                           "maintenance key none x", "faults second x", "help move x", "status x"}) {
    EXPECT_EQ(test::error_of(bench.say(line)), "usage") << line;
  }
  bench.say("frames 10 joint0.q2");
  EXPECT_EQ(test::error_of(bench.say("frames off now")), "usage");
  EXPECT_NE(bench.say("frames").find("frames on"), std::string::npos) << "they go on";
  bench.say("frames off");
  EXPECT_NE(bench.say("frames").find("frames off"), std::string::npos);
  EXPECT_EQ(test::error_of(bench.say("frames 10 joint0.q2 joint0.q2")), "unknown_signal");
  EXPECT_TRUE(test::has_line(bench.say("maintenance"), "maintenance closed"));
}

TEST(Shell, MoveBringsTheJointToItsTargetInRadOrDegrees) {
  Bench bench;
  bench.say("arm");
  for (const auto& [line, target] : {std::pair{"move joint1 0.5", 0.5},
                                     {"move joint1 -0.25 rad", -0.25},
                                     {"move joint1 30 deg", 0.5235988},
                                     {"move joint1 -114.5deg", -1.9984020},
                                     {"move\tjoint1\t100 mrad", 0.1}}) {
    EXPECT_EQ(verdict(bench.say(line)), "ok") << line;
    bench.ticks(3500);
    EXPECT_NEAR(bench.joint(1).q2_reference_rad.to_double(), target, 1e-6) << line;
    EXPECT_NEAR(bench.io.motors[1].angle_rad, target, 5e-3) << line;
    EXPECT_NEAR(bench.io.motors[0].angle_rad, 0.0, 1e-3) << "the other joint stays";
  }
}

TEST(Shell, MoveIsRefusedWithoutTorqueOutsideTheLimitsAndForGarbage) {
  Bench bench;
  EXPECT_EQ(verdict(bench.say("move joint0 0.5")).rfind("error not_armed: ", 0), 0U);
  bench.say("arm");
  for (const auto& [line, name] : {std::pair{"move joint0 2.01", "range"},
                                   {"move joint0 -2.01", "range"},
                                   {"move joint0 1000", "range"},
                                   {"move joint0 115 deg", "range"},
                                   {"move joint0 1e99", "range"},
                                   {"move joint0", "not_an_angle"},
                                   {"move joint0 nan", "not_an_angle"},
                                   {"move joint0 inf", "not_an_angle"},
                                   {"move joint0 0.5 Nm", "not_an_angle"},
                                   {"move joint0 0.5 rad deg", "not_an_angle"},
                                   {"move joint0 0.1 0.2", "not_an_angle"},
                                   {"move joint0 0,5", "not_an_angle"},
                                   {"move joint0 force=0.01 rate=1 rate=2", "option"},
                                   {"move joint2 0.5", "unknown_joint"},
                                   {"move joint 0.5", "unknown_joint"},
                                   {"move 0.5", "unknown_joint"},
                                   {"move joint0.x 0.5", "unknown_joint"},
                                   {"move joint-1 0.5", "unknown_joint"},
                                   {"move joint00 0.5", "unknown_joint"}}) {
    EXPECT_EQ(verdict(bench.say(line)).rfind(std::string("error ") + name + ": ", 0), 0U) << line;
  }
  const std::string range = bench.say("move joint0 2.01");
  EXPECT_NE(range.find("limits.joint_min -2 to limits.joint_max 2 rad"), std::string::npos) << range;
  EXPECT_EQ(bench.state(), State::kHolding);
  bench.ticks(500);
  EXPECT_NEAR(bench.io.motors[0].angle_rad, 0.0, 1e-3);
}

TEST(Shell, ArmAnswersWhenTheDrivesFollowSoThatALineBehindItMoves) {
  Bench bench;
  bench.io.cycles_to_follow = 400;
  EXPECT_EQ(verdict(bench.say("arm")), "ok");
  EXPECT_EQ(bench.state(), State::kHolding);
  EXPECT_EQ(verdict(bench.say("move joint0 0.5")), "ok");
  bench.ticks(2000);
  EXPECT_NEAR(bench.io.motors[0].angle_rad, 0.5, 5e-3);
}

TEST(Shell, AMoveFromAnotherConsoleBeforeTheDrivesFollowIsRefused) {
  Bench bench;
  bench.io.cycles_to_follow = 400;
  ASSERT_TRUE(bench.application.post({.kind = Request::Kind::kArm}));
  bench.ticks(2);
  EXPECT_EQ(verdict(bench.say("move joint0 0.5")).rfind("error not_holding: ", 0), 0U);
  bench.ticks(1000);
  EXPECT_EQ(bench.state(), State::kHolding);
  EXPECT_NEAR(bench.io.motors[0].angle_rad, 0.0, 1e-3);
}

TEST(Shell, HoldBrakesAMoveAndIsRefusedWithoutTorque) {
  Bench bench;
  EXPECT_EQ(verdict(bench.say("hold joint0")).rfind("error not_armed: ", 0), 0U);
  bench.say("arm");
  bench.say("move joint0 1.8");
  bench.ticks(300);
  EXPECT_EQ(verdict(bench.say("hold joint0")), "ok");
  EXPECT_EQ(bench.state(), State::kStopping);
  bench.ticks(500);
  EXPECT_EQ(bench.state(), State::kHolding);
  EXPECT_GT(bench.joint().q2_reference_rad, Q24::from_double(0.3));
  EXPECT_LT(bench.joint().q2_reference_rad, Q24::from_double(1.2));
  EXPECT_EQ(verdict(bench.say("hold joint5")).rfind("error unknown_joint: ", 0), 0U);
}

TEST(Shell, ALineThatComesBeforeTheLastAnswerIsRefusedAndTheAnswerStillComes) {
  Bench bench;
  for (const char c : std::string("arm\nmove joint0 1\n")) {
    bench.shell.receive(c);
  }
  EXPECT_EQ(bench.sink.take().rfind("error busy: ", 0), 0U);
  for (int i = 0; i < 2; ++i) {  // armed, and taken over
    bench.ticks(1);
    bench.shell.poll();
  }
  EXPECT_EQ(bench.sink.take(), "ok\r\n");
  EXPECT_EQ(bench.state(), State::kHolding) << "the refused move must not be carried out later";
}

}  // namespace
}  // namespace capstan
