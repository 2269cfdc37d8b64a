// SPDX-License-Identifier: Apache-2.0
// Force control at the axis and at the shell, on a motor that is blocked as a held tip blocks it. What the plant makes
// of it is in tests/tools/run/force_control_test.cpp.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "capstan/firmware/telemetry/signals.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using Bench = test::Bench<2>;
using test::has_line;
using test::verdict;

constexpr double kTorquePerCurrent = 0.1;
// Pull-push of equal tendons: what it takes at the motor, by hand from (2.11), (2.16) and (2.19).
constexpr double kEta = 0.5;
constexpr double kPretension = 0.05;

struct Line {  // of one direction while both tendons move, output over motor torque
  double slope, base, slack_from, one_slope;
};
auto line_by_hand() -> Line {
  const double e = std::exp(-kEta);
  const double p = (1.0 - e) / kEta;
  // t - B e = x and p (t + B) = I: t = (x + I e / p) / (1 + e), B = (I / p - x) / (1 + e); output = e t - B.
  return {(e + 1.0) / (1.0 + e), (e * e - 1.0) * kPretension / p / (1.0 + e), kPretension / p, e};
}
/// Motor torque on the way up to a joint torque.
auto rise_to(double joint_nm) -> double {
  const Line line = line_by_hand();
  const double both = (joint_nm - line.base) / line.slope;
  return both < line.slack_from ? both : joint_nm / line.one_slope;
}

void give_law(Bench& bench) {
  bench.io.blocked = true;
  for (const char* line :
       {"begin", "set joint0.force.law 2", "set joint0.force.eta_top 0.5", "set joint0.force.eta_bottom 0.5",
        "set joint0.force.pretension 0.05 Nm", "set joint0.force.reversal_time 5 ms", "commit"}) {
    ASSERT_EQ(verdict(bench.say(line)), "ok") << line;
  }
}
void hold_still(Bench& bench) {
  give_law(bench);
  ASSERT_EQ(verdict(bench.say("arm")), "ok");
  bench.ticks(10);
  ASSERT_EQ(bench.state(), State::kHolding);
}
auto motor_torque(const Bench& bench) -> double {
  return bench.joint().drive_a.to_double() * kTorquePerCurrent;
}

TEST(ForceControlShell, BringsTheMotorToTheTorqueThatTheLawTurnedRoundSays) {
  Bench bench;
  hold_still(bench);
  for (const double wanted : {0.02, 0.04, 0.06}) {
    ASSERT_EQ(verdict(bench.say("move joint0 force=" + std::to_string(wanted) + " rate=0.2")), "ok");
    EXPECT_EQ(bench.state(), State::kMoving) << "its torque is still on its way";
    bench.ticks(500);
    EXPECT_NEAR(motor_torque(bench), rise_to(wanted), 2e-5) << wanted;
    EXPECT_NEAR(bench.joint().joint_torque_nm.to_double(), wanted, 1e-5);
    EXPECT_EQ(bench.state(), State::kHolding);
    EXPECT_EQ(bench.joint().mode, ControlMode::kForce);
  }
  // Down again on the other branch: equal tendons, so it is the rise of the opposite sign.
  ASSERT_EQ(verdict(bench.say("move joint0 force=0.01 rate=0.2")), "ok");
  bench.ticks(800);
  EXPECT_NEAR(motor_torque(bench), -rise_to(-0.01), 2e-5);
}

TEST(ForceControlShell, BlendWithoutAWeightIsRefusedWithItsCure) {
  Bench bench;
  give_law(bench);
  for (const char* line : {"begin", "set joint0.force.law 4", "set joint0.force.pull_push_weight 0"}) {
    ASSERT_EQ(verdict(bench.say(line)), "ok") << line;
  }
  EXPECT_NE(bench.say("commit").find("force.pull_weight"), std::string::npos);
  ASSERT_EQ(verdict(bench.say("set joint0.force.pull_weight 0.6")), "ok");
  EXPECT_EQ(verdict(bench.say("commit")), "ok");
  EXPECT_NE(bench.say("model joint0").find("blend (2.27), 0.6"), std::string::npos);
}

TEST(ForceControlShell, StandingTargetLeavesTheMotorAloneForEver) {
  Bench bench;
  hold_still(bench);
  bench.say("move joint0 force=0.033 rate=0.1");
  bench.ticks(2000);
  const Q24 there = bench.joint().drive_a;
  for (int i = 0; i < 20'000; ++i) {
    bench.ticks(1);
    ASSERT_EQ(bench.joint().drive_a, there) << "rounding crossed the hysteresis in cycle " << i;
  }
}

TEST(ForceControlShell, CrossingTheHysteresisAndEveryChangeOfModeAreWithoutAJump) {
  Bench bench;
  hold_still(bench);
  const double width = rise_to(0.05) + rise_to(-0.05);
  ASSERT_GT(width, 0.03);
  double last = motor_torque(bench);
  double largest = 0.0;
  const auto run = [&](const char* line, int cycles) {
    ASSERT_EQ(verdict(bench.say(line)), "ok") << line;
    for (int i = 0; i < cycles; ++i) {
      bench.ticks(1);
      largest = std::max(largest, std::fabs(motor_torque(bench) - last));
      last = motor_torque(bench);
    }
  };
  last = motor_torque(bench);
  run("move joint0 force=0.05 rate=0.1", 900);
  run("move joint0 force=-0.02 rate=0.1", 1200);
  run("hold joint0", 300);
  EXPECT_EQ(bench.joint().mode, ControlMode::kPosition);
  run("move joint0 force=0.03 rate=0.1", 900);
  EXPECT_EQ(bench.joint().mode, ControlMode::kForce);
  // Within 5 ms the crossing changes by a sixth of its width in the first cycle; nothing changes by more.
  EXPECT_LT(largest, 0.25 * width);
}

TEST(ForceControlShell, RefusesWithoutLawWithoutTorqueWhileMovingAndOutOfRangeAndChangesNothing) {
  Bench bench;
  bench.io.blocked = true;
  bench.say("arm");
  EXPECT_TRUE(has_line(bench.say("move joint0 force=0.01"), "error no_force_law: "));
  bench.say("disarm");
  give_law(bench);
  EXPECT_TRUE(has_line(bench.say("move joint0 force=0.01"), "error not_armed: "));
  bench.say("arm");
  bench.ticks(10);
  const Q24 before = bench.joint().drive_a;
  EXPECT_TRUE(has_line(bench.say("move joint0 force=0.21"), "error range: "));
  EXPECT_TRUE(has_line(bench.say("move joint0 force=0.01 rate=-1"), "error range: "));
  EXPECT_TRUE(has_line(bench.say("move joint0 force=much"), "error not_a_torque: "));
  EXPECT_TRUE(has_line(bench.say("move joint0 force=0.01 speed=1"), "error not_a_torque: "));
  EXPECT_TRUE(has_line(bench.say("move joint0 force=0.01 deg"), "error not_a_torque: "));
  EXPECT_TRUE(has_line(bench.say("move joint0 force=0.01 corridor=0.1Nm"), "error not_a_torque: "));
  EXPECT_TRUE(has_line(bench.say("move joint0 force=0.01 corridor=-5deg"), "error range: "));
  EXPECT_EQ(bench.joint().mode, ControlMode::kPosition);
  EXPECT_EQ(bench.joint().drive_a, before);
  bench.io.blocked = false;
  ASSERT_EQ(verdict(bench.say("move joint0 0.5")), "ok");
  bench.ticks(50);
  EXPECT_TRUE(has_line(bench.say("move joint0 force=0.01"), "error moving: "));
  EXPECT_EQ(bench.joint().mode, ControlMode::kPosition);
  EXPECT_TRUE(has_line(bench.say("set joint0.force.law 1"), "error armed: ")) << "a law does not change under torque";
}

TEST(ForceControlShell, SaturationIsFlaggedAndTheGateHoldsAsEver) {
  Bench bench;
  give_law(bench);
  for (const char* line : {"maintenance open", "set joint0.limits.current 0.5", "arm"}) {
    bench.say(line);
  }
  // 0.5 A are 0.05 N m: less than 0.15 N m at the joint takes.
  bench.say("set joint0.limits.current 0.5");
  bench.say("disarm");
  bench.say("begin");
  bench.say("set joint0.limits.continuous_current 0.4 A");
  bench.say("set joint0.limits.current 0.5 A");
  ASSERT_EQ(verdict(bench.say("commit")), "ok");
  bench.say("arm");
  ASSERT_EQ(verdict(bench.say("move joint0 force=0.15 rate=1")), "ok");
  bench.ticks(500);
  EXPECT_LE(std::fabs(bench.joint().drive_a.to_double()), 0.5);
  EXPECT_NE(bench.joint().limits & bit(Limit::kCurrent), 0);
  EXPECT_TRUE(has_line(bench.say("status"), "joint0")) << "and status says so";
  EXPECT_LT(bench.joint().joint_torque_nm.to_double(), 0.1) << "the law is told what the motor got, not what it should";
}

TEST(ForceControlShell, PastOfTheLawIsSaidUntilItDoesNotMatter) {
  Bench bench;
  hold_still(bench);
  EXPECT_NE(bench.say("status").find("(past unknown: "), std::string::npos);
  EXPECT_FALSE(bench.joint().joint_torque_known);
  bench.say("move joint0 force=0.06 rate=0.2");
  bench.ticks(500);
  EXPECT_TRUE(bench.joint().joint_torque_known);
  EXPECT_EQ(bench.say("status").find("(past unknown: "), std::string::npos);
}

TEST(ForceControlShell, ReversalTableThatFallsOrIsOutOfOrderIsRefusedWithRowAndColumn) {
  Bench bench;
  const auto commit = [&bench](const char* spoilt) {
    bench.say("begin");
    for (const char* line :
         {"set joint0.force.law 3", "set joint0.preisach.levels 3", "set joint0.preisach.input_0 -1 Nm",
          "set joint0.preisach.input_1 0 Nm", "set joint0.preisach.input_2 1 Nm", "set joint0.preisach.force_0_0 -1 Nm",
          "set joint0.preisach.force_1_0 -1 Nm", "set joint0.preisach.force_1_1 0 Nm",
          "set joint0.preisach.force_2_0 -1 Nm", "set joint0.preisach.force_2_1 0.5 Nm",
          "set joint0.preisach.force_2_2 1 Nm", spoilt}) {
      EXPECT_EQ(verdict(bench.say(line)), "ok") << line;
    }
    const std::string answer = bench.say("commit");
    bench.say("abandon");
    return answer;
  };
  EXPECT_NE(commit("set joint0.preisach.force_2_1 -1.5 Nm").find("at row 2, column 1 of the preisach grid "),
            std::string::npos);
  EXPECT_NE(commit("set joint0.preisach.force_1_1 -1.5 Nm").find("at row 1, column 1 of the preisach grid "),
            std::string::npos);
  EXPECT_NE(commit("set joint0.preisach.input_2 0 Nm").find("at row 2, column 0 of the preisach grid the input levels"),
            std::string::npos);
  EXPECT_EQ(verdict(commit("set joint0.preisach.force_2_1 0.5 Nm")), "ok") << "as it should be";
}

// Thesis 2.3, as scope, watch and record show it: from a past that nobody knows over both tendons to one, then rest.
TEST(ForceControlShell, PhaseOfTheLawIsASignal) {
  Bench bench;
  hold_still(bench);
  const Signal signal = find_signal("joint0.force_phase", 1);
  ASSERT_NE(signal.info, nullptr);
  std::vector<std::int32_t> phases;
  const double slack_at = line_by_hand().one_slope * line_by_hand().slack_from;
  ASSERT_EQ(verdict(bench.say("move joint0 force=" + std::to_string(1.5 * slack_at) + " rate=0.2")), "ok");
  for (int i = 0; i < 1000; ++i) {
    bench.ticks(1);
    const std::array now = {bench.joint()};
    const std::int32_t phase = rt_raw(signal, {}, now);
    if (phases.empty() || phase != phases.back()) {
      phases.push_back(phase);
    }
  }
  EXPECT_EQ(phases, (std::vector<std::int32_t>{0, 3, 4, 1}));
}

TEST(ForceControlShell, TipThatIsNotHeldIsHeldWhereItRunsAway) {
  Bench bench;
  give_law(bench);
  bench.io.blocked = false;
  bench.say("arm");
  ASSERT_EQ(verdict(bench.say("move joint0 force=0.15 rate=1")), "ok");
  bench.ticks(1500);
  EXPECT_EQ(bench.joint().mode, ControlMode::kPosition);
  EXPECT_LT(std::fabs(bench.io.motors[0].speed_rad_s), 0.1);
}

struct Axes {
  test::FakeIo<1> io;
  test::FlashBanks banks;
  Application<test::FakeIo<1>> application{io, banks};
};

TEST(ForceControlStream, EndsWithItsLinkAndIsCutToTheLimit) {
  Axes rig;
  rig.io.blocked = true;
  std::array<AxisConfig, 1> config;
  config[0].force.law = static_cast<std::int32_t>(ForceLawKind::kPull);
  config[0].force.eta_top = config[0].force.eta_bottom = Q24::from_double(0.5);
  ASSERT_TRUE(rig.application.configure(config, Rights::kMaintenance).taken());
  rig.application.rt_tick();
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kArm}));
  rig.application.rt_tick();
  Application<test::FakeIo<1>>::Streamed streamed{};
  streamed[0] = {.kind = Request::Kind::kFollowForce,
                 .joint_torque_nm = Q24::from_double(5.0),
                 .torque_rate_nm_s = Q24::from_int(100)};
  for (int i = 0; i < 200; ++i) {
    rig.application.rt_tick(streamed);
  }
  const AxisTelemetry joint = rig.application.axis_telemetry(0);
  EXPECT_EQ(joint.joint_torque_reference_nm, config[0].limits.joint_torque_nm);
  EXPECT_NE(joint.limits & bit(Limit::kJointTorque), 0);
  int cycles = 0;
  while (energised(rig.application.telemetry().state) && cycles < 500) {
    rig.application.rt_tick();
    ++cycles;
  }
  EXPECT_LE(cycles, 102);
  EXPECT_EQ(rig.application.telemetry().first_fault, Fault::kLinkLost);
}

// At the edge of a corridor position control holds the joint; the stream of torques goes on and is still its link.
TEST(ForceControlStream, GoesOnWhileAnEdgeOfTheCorridorHoldsTheJoint) {
  Axes rig;
  std::array<AxisConfig, 1> config;
  config[0].force.law = static_cast<std::int32_t>(ForceLawKind::kPull);
  config[0].force.eta_top = config[0].force.eta_bottom = Q24::from_double(0.5);
  ASSERT_TRUE(rig.application.configure(config, Rights::kMaintenance).taken());
  rig.application.rt_tick();
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kArm}));
  rig.application.rt_tick();
  Application<test::FakeIo<1>>::Streamed streamed{};
  streamed[0] = {.kind = Request::Kind::kFollowForce,
                 .joint_torque_nm = Q24::from_double(0.15),
                 .torque_rate_nm_s = Q24::from_int(1),
                 .corridor_rad = Q24::from_double(0.1)};
  for (int i = 0; i < 1500; ++i) {
    rig.application.rt_tick(streamed);
    ASSERT_TRUE(energised(rig.application.telemetry().state)) << i;
  }
  EXPECT_NE(rig.application.axis_telemetry(0).limits & bit(Limit::kCorridor), 0);
  int cycles = 0;
  while (energised(rig.application.telemetry().state) && cycles < 500) {
    rig.application.rt_tick();
    ++cycles;
  }
  EXPECT_LE(cycles, 102);
  EXPECT_EQ(rig.application.telemetry().first_fault, Fault::kLinkLost);
}

}  // namespace
}  // namespace capstan
