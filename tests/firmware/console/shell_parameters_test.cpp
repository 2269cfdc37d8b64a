// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "capstan/firmware/parameters/parameter_text.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using Bench = test::Bench<2>;
using test::lines_of;
using test::verdict;

auto q(double value) -> Q24 {
  return Q24::from_double(value);
}

auto refused(const std::string& answer, const std::string& name) -> bool {
  return verdict(answer).rfind("error " + name + ": ", 0) == 0;
}
auto in_force(const Bench& bench, std::size_t axis = 0) -> const AxisConfig& {
  return bench.application.config()[axis];
}

TEST(ShellParameters, GetPrintsTheValueWithUnitAndRange) {
  Bench bench;
  EXPECT_EQ(lines_of(bench.say("get joint1.control.stiffness"))[0],
            "joint1.control.stiffness 1 Nm/rad (0 to 100 Nm/rad)");
  EXPECT_EQ(lines_of(bench.say("get joint0.motor.encoder_sign"))[0], "joint0.motor.encoder_sign 1 (-1 to 1)");
  for (const char* line : {"get joint0.control.nonsense", "get joint2.control.kp", "get control.kp", "get joint0",
                           "get joint0.", "get joint0.control.kp.x"}) {
    EXPECT_TRUE(refused(bench.say(line), "unknown_parameter")) << line;
  }
}

TEST(ShellParameters, ListPrintsEveryParameterOfTheChosenPart) {
  Bench bench;
  const std::size_t all = parameters().size();
  EXPECT_EQ(lines_of(bench.say("list")).size(), 2 * all + 1);
  EXPECT_EQ(lines_of(bench.say("list joint1")).size(), all + 1);
  const auto group = lines_of(bench.say("list joint1.motor"));
  ASSERT_EQ(group.size(), 5U + 1U);
  EXPECT_EQ(group[3], "joint1.motor.speed_limit 60 rad/s (0.1 to 120 rad/s) an encoder that moves faster is a fault");
  EXPECT_TRUE(refused(bench.say("list joint0.nonsense"), "unknown_group"));
  EXPECT_TRUE(refused(bench.say("list joint0motor"), "unknown_group"));
  EXPECT_TRUE(refused(bench.say("list joint0."), "unknown_group"));
  EXPECT_TRUE(refused(bench.say("list joint9"), "unknown_joint"));
}

TEST(ShellParameters, SetChangesThatParameterAndNoOther) {
  Bench bench;
  EXPECT_EQ(verdict(bench.say("set joint1.control.kp 1.5")), "ok");
  AxisConfig expected;
  expected.control.kp = q(1.5);
  EXPECT_TRUE(test::same(in_force(bench, 1), expected));
  EXPECT_TRUE(test::same(in_force(bench, 0), AxisConfig{}));
  EXPECT_EQ(lines_of(bench.say("get joint1.control.kp"))[0], "joint1.control.kp 1.5 (0 to 20)");
}

TEST(ShellParameters, SetReachesTheCycle) {
  Bench bench;
  bench.say("maintenance open");
  bench.say("set joint0.limits.joint_max 0.2");
  bench.say("arm");
  EXPECT_TRUE(refused(bench.say("move joint0 0.3"), "range"));
}

TEST(ShellParameters, UnitsThatPeopleTypeAreConverted) {
  Bench bench;
  bench.say("maintenance open");
  for (const auto& [line, value] : {std::pair{"joint0.limits.following_time 250 ms", 0.25},
                                    {"joint0.limits.following_time 300ms", 0.3},
                                    {"joint0.limits.following_time 0.5 s", 0.5},
                                    {"joint0.limits.following_time 1.5", 1.5},
                                    {"joint0.limits.following_time 9999 ms", 9.999}}) {
    EXPECT_EQ(verdict(bench.say(std::string("set ") + line)), "ok") << line;
    EXPECT_EQ(in_force(bench).limits.following_time_s, q(value)) << line;
  }
  EXPECT_EQ(verdict(bench.say("set joint0.control.torque_forward 60 mNm")), "ok");
  EXPECT_EQ(in_force(bench).control.torque_forward_nm, q(0.06));
  EXPECT_EQ(verdict(bench.say("set joint0.limits.current 2500 mA")), "ok");
  EXPECT_EQ(in_force(bench).limits.current_a, q(2.5));
  EXPECT_EQ(verdict(bench.say("set joint0.limits.joint_max 90 deg")), "ok");
  EXPECT_NEAR(in_force(bench).limits.joint_max_rad.to_double(), 1.5707963267948966, 1e-7);
  EXPECT_EQ(verdict(bench.say("set joint0.limits.joint_min -1800 mrad")), "ok");
  EXPECT_EQ(in_force(bench).limits.joint_min_rad, q(-1.8));
  EXPECT_EQ(verdict(bench.say("set joint0.limits.joint_speed 180 deg/s")), "ok");
  EXPECT_NEAR(in_force(bench).limits.joint_speed_rad_s.to_double(), 3.141592653589793, 1e-7);
  EXPECT_EQ(verdict(bench.say("set joint0.limits.joint_acceleration 360 deg/s2")), "ok");
  EXPECT_NEAR(in_force(bench).limits.joint_acceleration_rad_s2.to_double(), 6.283185307179586, 2e-7);
}

TEST(ShellParameters, AnotherUnitIsRefusedAndNothingChanges) {
  Bench bench;
  for (const char* line :
       {"set joint0.control.stiffness 4 Nm", "set joint0.control.stiffness 4 rad", "set joint0.control.kp 1 rad",
        "set joint0.limits.current 1 V", "set joint0.limits.joint_max 1 ms", "set joint0.limits.joint_max 1 rad rad",
        "set joint0.limits.joint_max 1 Rad", "set joint0.limits.joint_max 1Rad", "set joint0.control.kp 1%"}) {
    EXPECT_TRUE(refused(bench.say(line), "unit")) << line;
  }
  EXPECT_TRUE(test::same(in_force(bench), AxisConfig{}));
}

TEST(ShellParameters, OutOfRangeChangesNothingAndNamesParameterRangeAndUnit) {
  Bench bench;
  for (const char* value : {"100.1", "-0.001", "1e9", "128", "-1e30"}) {
    const std::string answer = bench.say(std::string("set joint0.control.stiffness ") + value);
    EXPECT_TRUE(refused(answer, "range")) << value;
    EXPECT_NE(answer.find("control.stiffness takes 0 to 100 Nm/rad"), std::string::npos) << answer;
  }
  EXPECT_TRUE(refused(bench.say("set joint0.motor.encoder_counts 15"), "range"));
  EXPECT_TRUE(refused(bench.say("set joint0.motor.encoder_counts 99999999999999999999"), "range"));
  EXPECT_TRUE(refused(bench.say("set joint0.limits.following_time 99999 ms"), "range"));
  EXPECT_TRUE(test::same(in_force(bench), AxisConfig{}));
}

TEST(ShellParameters, WhatIsNoNumberIsRefused) {
  Bench bench;
  for (const char* value : {"", "nan", "inf", "-", "rad", "four", "--1", "0x10 "}) {
    EXPECT_NE(verdict(bench.say(std::string("set joint0.control.kp ") + value)), "ok") << value;
  }
  for (const char* value : {"1.0", "1e3", "4096 counts", "0x1000", "1 1"}) {
    EXPECT_TRUE(refused(bench.say(std::string("set joint0.motor.encoder_counts ") + value), "not_a_number")) << value;
  }
  EXPECT_TRUE(test::same(in_force(bench), AxisConfig{}));
}

TEST(ShellParameters, WhatBeginsAsANumberAndIsNoneIsNotSaidToHaveAnotherUnit) {
  Bench bench;
  for (const char* value : {"0x10", "0X1F", "1,5", "1e", "1E", "1.2.3", "1'000", "1_000", "12:30", "1-2", "1e+"}) {
    EXPECT_TRUE(refused(bench.say(std::string("set joint0.control.kp ") + value), "not_a_number")) << value;
  }
  EXPECT_TRUE(test::same(in_force(bench), AxisConfig{}));
  EXPECT_EQ(verdict(bench.say("set joint0.control.kp 1e1")), "ok");
  EXPECT_EQ(in_force(bench).control.kp, q(10.0));
}

// Numbers of a choice and counts, by the names and meanings in docs/reference.md.
TEST(ShellParameters, WhatCountsOrChoosesTakesNoFractions) {
  Bench bench;
  bench.say("maintenance open");
  for (const char* name :
       {"motor.encoder_counts", "motor.encoder_sign", "motor.fitted", "axis_coupling.joint", "axis_coupling.joint_2",
        "axis_coupling.joint_3", "tip.pitch", "law.status", "force.law", "effort.feedforward", "effort.status",
        "observer.answer_gains", "preisach.levels", "table.signal", "table.knots", "table.factor"}) {
    const std::string answer = bench.say(std::string("set joint0.") + name + " 0.5");
    EXPECT_TRUE(refused(answer, "not_a_number")) << name << ": " << answer;
    EXPECT_NE(answer.find("give a whole number"), std::string::npos) << answer;
  }
  EXPECT_TRUE(test::same(in_force(bench), AxisConfig{}));
  EXPECT_EQ(verdict(bench.say("set joint0.table.knots 9.00000000")), "ok") << "as 'capstan apply' writes it";
  EXPECT_EQ(lines_of(bench.say("get joint0.table.knots"))[0], "joint0.table.knots 9 (0 to 17)");
  EXPECT_EQ(verdict(bench.say("set joint0.angle_periodic.order 2.5")), "ok") << "gears have such periods";
}

TEST(ShellParameters, AJointIsNamedOnlyToAnotherThatTheBoardHas) {
  Bench bench;
  for (const char* name : {"axis_coupling.joint", "axis_coupling.joint_2", "axis_coupling.joint_3", "tip.pitch"}) {
    const std::string stem = std::string("set joint1.") + name + " ";
    for (const char* nobody : {"1", "2", "3"}) {  // itself, and two that a board of two has not
      const std::string answer = bench.say(stem + nobody);
      EXPECT_TRUE(refused(answer, "inconsistent")) << answer;
      EXPECT_NE(answer.find(name), std::string::npos) << answer;
    }
    EXPECT_TRUE(test::same(in_force(bench, 1), AxisConfig{})) << name;
    EXPECT_EQ(verdict(bench.say(stem + "0")), "ok");
    EXPECT_EQ(verdict(bench.say(stem + "-1")), "ok");
  }
  test::Bench<1> alone;
  EXPECT_TRUE(refused(alone.say("set joint0.axis_coupling.joint 1"), "inconsistent"));
  bench.say("begin");
  EXPECT_EQ(verdict(bench.say("set joint0.axis_coupling.joint 0")), "ok") << "judged together at the commit";
  EXPECT_TRUE(refused(bench.say("commit"), "inconsistent"));
}

TEST(ShellParameters, BlanksAndTabsMaySeparateWords) {
  Bench bench;
  EXPECT_EQ(verdict(bench.say("  set \t joint0.control.kp\t 2 ")), "ok");
  EXPECT_EQ(in_force(bench).control.kp, q(2.0));
}

TEST(ShellParameters, StagedChangesComeIntoForceTogetherAtCommit) {
  Bench bench;
  bench.say("maintenance open");
  EXPECT_EQ(verdict(bench.say("begin")), "ok");
  EXPECT_EQ(verdict(bench.say("set joint0.limits.motor_min 7")), "ok") << "above motor_max for the moment";
  EXPECT_EQ(verdict(bench.say("set joint0.limits.motor_max 9")), "ok");
  EXPECT_TRUE(test::same(in_force(bench), AxisConfig{})) << "not before commit";
  EXPECT_EQ(verdict(bench.say("commit")), "ok");
  EXPECT_EQ(in_force(bench).limits.motor_min_rad, Q24::from_int(7));
  EXPECT_EQ(in_force(bench).limits.motor_max_rad, Q24::from_int(9));
  EXPECT_TRUE(refused(bench.say("commit"), "not_staging"));
}

// 3 A of 0.1 Nm/A are 0.3 Nm.
TEST(ShellParameters, AFeedforwardThatTheMotorCanNotGiveIsRefused) {
  Bench bench;
  for (const char* line : {"set joint0.control.torque_forward 10", "set joint0.control.torque_forward 0.301",
                           "set joint0.control.torque_backward -10"}) {
    const std::string answer = bench.say(line);
    EXPECT_TRUE(refused(answer, "inconsistent")) << line;
    EXPECT_NE(answer.find("more than limits.current gives"), std::string::npos) << answer;
  }
  EXPECT_TRUE(test::same(in_force(bench), AxisConfig{}));
  EXPECT_EQ(verdict(bench.say("set joint0.control.torque_forward 0.299")), "ok");
}

TEST(ShellParameters, AnInconsistentCommitChangesNothingAndCanBeMended) {
  Bench bench;
  bench.say("maintenance open");
  bench.say("begin");
  bench.say("set joint1.control.kp 3");
  bench.say("set joint1.limits.joint_min 5");
  const std::string answer = bench.say("commit");
  EXPECT_TRUE(refused(answer, "inconsistent"));
  EXPECT_NE(answer.find("limits.joint_min is not below limits.joint_max"), std::string::npos) << answer;
  EXPECT_TRUE(test::same(in_force(bench, 1), AxisConfig{}));
  bench.say("set joint1.limits.joint_min -1");
  EXPECT_EQ(verdict(bench.say("commit")), "ok");
  EXPECT_EQ(in_force(bench, 1).control.kp, q(3.0));
}

TEST(ShellParameters, AnInconsistentSetOutsideATransactionChangesNothing) {
  Bench bench;
  EXPECT_TRUE(refused(bench.say("set joint0.motor.encoder_sign 0"), "inconsistent"));
  EXPECT_TRUE(refused(bench.say("set joint0.motor_angle.beta 0"), "inconsistent"));
  EXPECT_TRUE(test::same(in_force(bench), AxisConfig{}));
}

TEST(ShellParameters, ABadLineInATransactionStagesNothingAndTheRestStays) {
  Bench bench;
  bench.say("begin");
  bench.say("set joint0.control.kp 3");
  EXPECT_TRUE(refused(bench.say("set joint0.control.kp 999"), "range"));
  EXPECT_EQ(verdict(bench.say("commit")), "ok");
  EXPECT_EQ(in_force(bench).control.kp, q(3.0));
}

TEST(ShellParameters, AbandonForgetsWhatWasStaged) {
  Bench bench;
  bench.say("begin");
  bench.say("set joint0.control.kp 3");
  EXPECT_EQ(verdict(bench.say("abandon")), "ok");
  EXPECT_TRUE(refused(bench.say("commit"), "not_staging"));
  EXPECT_EQ(verdict(bench.say("set joint0.control.ki 5")), "ok");
  EXPECT_EQ(in_force(bench).control.kp, AxisConfig{}.control.kp);
}

TEST(ShellParameters, GainsChangeUnderTorqueAndTheModelDoesNot) {
  Bench bench;
  bench.say("arm");
  EXPECT_EQ(verdict(bench.say("set joint0.control.kp 0.3")), "ok");
  EXPECT_EQ(in_force(bench).control.kp, q(0.3));
  for (const char* line :
       {"set joint0.motor_angle.beta 1.1", "set joint0.limits.current 2", "set joint1.motor.encoder_sign -1",
        "set joint0.conditioner.direction_threshold 0.01", "set joint0.transport_delay.delay 10 ms"}) {
    EXPECT_TRUE(refused(bench.say(line), "armed")) << line;
  }
  bench.say("begin");
  bench.say("set joint0.control.kp 0.7");
  bench.say("set joint0.play.gain 0.5");
  EXPECT_TRUE(refused(bench.say("commit"), "armed"));
  EXPECT_EQ(in_force(bench).control.kp, q(0.3)) << "all or none";
  EXPECT_EQ(bench.state(), State::kHolding);
  bench.say("disarm");
  EXPECT_EQ(verdict(bench.say("commit")), "ok") << "what was staged is still there";
  EXPECT_EQ(in_force(bench).law.coefficients, [] {
    AxisConfig wanted;
    set_raw_value(wanted, *find_parameter("play.gain"), q(0.5).raw());
    return wanted.law.coefficients;
  }());
}

TEST(ShellParameters, DefaultsAreStagedAndTakenByCommit) {
  Bench bench;
  bench.say("set joint0.control.kp 3");
  EXPECT_EQ(verdict(bench.say("defaults")), "ok");
  EXPECT_EQ(in_force(bench).control.kp, q(3.0));
  EXPECT_EQ(verdict(bench.say("commit")), "ok");
  EXPECT_TRUE(test::same(in_force(bench), AxisConfig{}));
}

/// Puts sets of every parameter in force by way of the machine, not the shell.
void put_in_force(Bench& bench, std::uint32_t seed) {
  const Config<2> config = {test::distinct_config(seed), test::distinct_config(seed + 1)};
  ASSERT_TRUE(bench.application.configure(config, Rights::kMaintenance).taken());
  bench.ticks(1);
}

TEST(ShellParameters, ADumpPastedBackRestoresEveryParameterExactly) {
  Bench bench;
  bench.say("maintenance open");
  for (std::uint32_t seed = 0; seed < 20; seed += 2) {
    put_in_force(bench, seed);
    const auto dump = lines_of(bench.say("dump"));
    ASSERT_EQ(dump.size(), 2 * parameters().size() + 3);
    put_in_force(bench, seed + 50);
    for (std::size_t i = 0; i + 1 < dump.size(); ++i) {
      ASSERT_EQ(verdict(bench.say(dump[i])), "ok") << dump[i];
    }
    EXPECT_TRUE(test::same(in_force(bench, 0), test::distinct_config(seed)));
    EXPECT_TRUE(test::same(in_force(bench, 1), test::distinct_config(seed + 1)));
  }
}

TEST(ShellParameters, DiffShowsOnlyWhatDiffersFromTheDefaults) {
  Bench bench;
  EXPECT_EQ(lines_of(bench.say("diff")), (std::vector<std::string>{"begin", "commit", "ok"}));
  bench.say("set joint1.control.stiffness 4");
  EXPECT_EQ(lines_of(bench.say("diff")),
            (std::vector<std::string>{"begin", "set joint1.control.stiffness 4 Nm/rad", "commit", "ok"}));
}

TEST(ShellParameters, SaveAndLoadKeepASetAndAreRefusedUnderTorque) {
  Bench bench;
  EXPECT_TRUE(refused(bench.say("load"), "storage_empty"));
  bench.say("set joint0.control.kp 3");
  EXPECT_EQ(verdict(bench.say("save")), "ok");
  bench.say("set joint0.control.kp 4");
  bench.say("arm");
  EXPECT_TRUE(refused(bench.say("save"), "armed"));
  EXPECT_TRUE(refused(bench.say("load"), "armed"));
  EXPECT_EQ(in_force(bench).control.kp, q(4.0));
  bench.say("disarm");
  EXPECT_EQ(verdict(bench.say("load")), "ok");
  EXPECT_EQ(in_force(bench).control.kp, q(3.0));
}

TEST(ShellParameters, StorageThatFailsOrIsCorruptIsToldAndChangesNothing) {
  Bench bench;
  bench.say("set joint0.control.kp 3");
  bench.banks.write_fails = true;
  EXPECT_TRUE(refused(bench.say("save"), "storage"));
  bench.banks.write_fails = false;
  EXPECT_EQ(verdict(bench.say("save")), "ok");
  bench.banks.memory[0][50] ^= 1U;
  bench.banks.memory[1][50] ^= 1U;
  bench.say("set joint0.control.kp 4");
  EXPECT_TRUE(refused(bench.say("load"), "storage_corrupt"));
  EXPECT_EQ(in_force(bench).control.kp, q(4.0));
}

}  // namespace
}  // namespace capstan
