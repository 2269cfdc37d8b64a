// SPDX-License-Identifier: Apache-2.0
// Motor position control at the shell and at the axis, on the motor without a transmission.
#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/firmware/loop/cycle_rig.hpp"

namespace capstan {
namespace {

using Bench = test::Bench<2>;
using test::has_line;
using test::verdict;

constexpr double kTorquePerCurrent = 0.1;

/// The joint turns half as far as its motor, the other way.
void halve(Bench& bench) {
  for (const char* line : {"begin", "set joint0.motor_angle.beta -0.5", "set joint0.control.torque_forward 0.03 Nm",
                           "set joint0.control.torque_backward -0.02 Nm", "commit", "arm"}) {
    ASSERT_EQ(verdict(bench.say(line)), "ok") << line;
  }
}

TEST(MotorPosition, MovesTheMotorToItsAngleExactlyAndNothingElse) {
  Bench bench;
  halve(bench);
  for (const auto& [line, target] : {std::pair{"move joint0 motor=1.5", 1.5},
                                     {"move joint0 motor=-30 deg", -0.5235988},
                                     {"move joint0 motor=-30deg", -0.5235988},
                                     {"move joint0 motor=0", 0.0}}) {
    ASSERT_EQ(verdict(bench.say(line)), "ok") << line;
    bench.ticks(3000);
    EXPECT_EQ(bench.joint().mode, ControlMode::kMotor);
    EXPECT_NEAR(bench.joint().q1_reference_rad.to_double(), target, 1e-6) << line;
    EXPECT_NEAR(bench.io.motors[0].angle_rad, target, 0.002) << "nothing is left of what friction takes";
    EXPECT_NEAR(bench.io.motors[1].angle_rad, 0.0, 1e-3);
    EXPECT_EQ(bench.state(), State::kHolding);
  }
  EXPECT_NE(bench.say("status").find(" motor reference 0 rad"), std::string::npos);
}

TEST(MotorPosition, JointGetsNoFasterAndAcceleratesNoMoreThanInItsOwnMoves) {
  Bench bench;
  halve(bench);
  bench.say("move joint0 motor=3");
  double last = -0.5 * bench.joint().q1_reference_rad.to_double();
  double last_speed = 0.0;
  double fastest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    bench.ticks(1);
    const double joint = -0.5 * bench.joint().q1_reference_rad.to_double();
    const double speed = (joint - last) * 1000.0;
    if (i > 0) {
      ASSERT_LE(std::fabs(speed - last_speed) * 1000.0, 10.0 + 0.5) << "rad/s2, and the rounding of 2^-24 rad";
    }
    fastest = std::max(fastest, std::fabs(speed));
    last = joint;
    last_speed = speed;
  }
  EXPECT_NEAR(fastest, 2.0, 1e-3) << "limits.joint_speed";
}

TEST(MotorPosition, EveryChangeOfModeIsWithoutAJumpOfTheTorque) {
  Bench bench;
  bench.io.drag_nms = 5e-3;
  ASSERT_NO_FATAL_FAILURE(halve(bench));
  double largest = 0.0;
  double last = bench.joint().drive_a.to_double() * kTorquePerCurrent;
  const auto run = [&](const char* line, ControlMode mode) {
    ASSERT_EQ(verdict(bench.say(line)), "ok") << line;
    for (int i = 0; i < 2500; ++i) {
      bench.ticks(1);
      const double now = bench.joint().drive_a.to_double() * kTorquePerCurrent;
      largest = std::max(largest, std::fabs(now - last));
      last = now;
    }
    EXPECT_EQ(bench.joint().mode, mode) << line;
  };
  run("move joint0 0.3", ControlMode::kPosition);
  run("move joint0 motor=0.2", ControlMode::kMotor);
  run("move joint0 0.4", ControlMode::kPosition);
  run("move joint0 motor=-1", ControlMode::kMotor);
  run("hold joint0", ControlMode::kMotor);
  run("move joint0 -0.2", ControlMode::kPosition);
  // The feedforward crosses from one branch to the other, 0.05 Nm, in reversal_time, 20 ms: a twentieth in a cycle.
  EXPECT_LT(largest, 0.05 / 20.0 + 0.002);
}

TEST(MotorPosition, GarbageAndTargetsOutsideTheTendonsTravelAreRefusedWithTheLimitAndNothingMoves) {
  Bench bench;
  EXPECT_EQ(verdict(bench.say("move joint0 motor=0.5")).rfind("error not_armed: ", 0), 0U);
  bench.say("arm");
  for (const auto& [line, name] : {std::pair{"move joint0 motor=6.01", "range"},
                                   {"move joint0 motor=-6.01", "range"},
                                   {"move joint0 motor=1e9", "range"},
                                   {"move joint0 motor=", "not_an_angle"},
                                   {"move joint0 motor", "not_an_angle"},
                                   {"move joint0 motor=nan", "not_an_angle"},
                                   {"move joint0 motor=1 Nm", "not_an_angle"},
                                   {"move joint0 motor=1 2", "not_an_angle"},
                                   {"move joint0 motor=1 force=0", "not_an_angle"},
                                   {"move joint0 engine=1", "not_a_torque"},
                                   {"move joint7 motor=1", "unknown_joint"}}) {
    EXPECT_EQ(verdict(bench.say(line)).rfind(std::string("error ") + name + ": ", 0), 0U) << line;
  }
  EXPECT_NE(bench.say("move joint0 motor=7").find("limits.motor_min -6 to limits.motor_max 6 rad"), std::string::npos);
  bench.ticks(500);
  EXPECT_NEAR(bench.io.motors[0].angle_rad, 0.0, 1e-3);
  EXPECT_EQ(bench.joint().mode, ControlMode::kPosition);
}

TEST(MotorPosition, ModeDoesNotChangeWhileTheJointMovesAndHoldBrakesIt) {
  Bench bench;
  halve(bench);
  bench.say("move joint0 1");
  bench.ticks(100);
  EXPECT_TRUE(has_line(bench.say("move joint0 motor=1"), "error moving: "));
  bench.ticks(2000);
  ASSERT_EQ(verdict(bench.say("move joint0 motor=2")), "ok");
  bench.ticks(300);
  EXPECT_TRUE(has_line(bench.say("move joint0 0.5"), "error moving: "));
  ASSERT_EQ(verdict(bench.say("hold joint0")), "ok");
  bench.ticks(1000);
  EXPECT_EQ(bench.state(), State::kHolding);
  EXPECT_LT(bench.io.motors[0].angle_rad, 1.9) << "it did not go on to its target";
  EXPECT_EQ(verdict(bench.say("move joint0 0.5")), "ok");
}

using Rig = test::CycleRig<1>;

auto to_motor(double target_rad, double speed_rad_s = 2.0) -> Command<1> {
  Command<1> command;
  command.axis[0] = {.kind = Request::Kind::kMoveMotor,
                     .position_rad = Q24::from_double(target_rad),
                     .speed_rad_s = Q24::from_double(speed_rad_s)};
  return command;
}

TEST(MotorPosition, StreamAndMoveDoNotTakeAMotorThatIsOnItsWay) {
  Rig rig;
  rig.arm();
  rig.tick(to_motor(1.5));
  rig.ticks(200);
  rig.move(-1.0);
  rig.follow(-1.0);
  EXPECT_EQ(rig.joint().mode, ControlMode::kMotor);
  rig.ticks(2000);
  EXPECT_NEAR(rig.io.motors[0].angle_rad, 1.5, 0.01);
  EXPECT_EQ(rig.now(), State::kHolding);
}

TEST(MotorPosition, JointThatLeavesItsRangeIsHeldThereInPositionControl) {
  Config<1> config;
  config[0].limits.joint_max_rad = Q24::from_double(0.5);
  Rig rig(config);
  rig.arm();
  rig.tick(to_motor(3.0));
  rig.ticks(4000);
  EXPECT_EQ(rig.joint().mode, ControlMode::kPosition);
  EXPECT_EQ(rig.now(), State::kHolding);
  EXPECT_GT(rig.io.motors[0].angle_rad, 0.49);
  EXPECT_LT(rig.io.motors[0].angle_rad, 0.6);
}

/// A law whose zero is 3 rad off, of a joint that may go from -2 to 2 rad.
TEST(MotorPosition, AJointThatIsFarOutsideItsLimitsByItsLawIsNotTakenBackIntoThem) {
  Bench bench;
  bench.say("set joint0.joint_offset.offset 3");
  ASSERT_EQ(verdict(bench.say("arm")), "ok");
  for (const char* line : {"move joint0 0.1", "move joint0 motor=0.1"}) {
    const std::string answer = bench.say(line);
    EXPECT_EQ(verdict(answer).rfind("error outside: by its law the joint is at ", 0), 0U) << answer;
    EXPECT_NE(answer.find("limits.joint_min -2 to limits.joint_max 2 rad"), std::string::npos) << answer;
  }
  Rig rig;
  AxisConfig config;
  set_raw_value(config, *find_parameter("joint_offset.offset"), Q24::from_int(3).raw());
  rig.state.axis[0].rt_configure(config);
  rig.arm();
  rig.move(0.1);
  rig.follow(0.1);
  rig.ticks(2000);
  EXPECT_NEAR(rig.io.motors[0].angle_rad, 0.0, 1e-3);
}

TEST(MotorPosition, AJointALittleOutsideItsLimitsMovesBackIntoThem) {
  Bench bench;
  bench.say("set joint0.joint_offset.offset 2.2");
  ASSERT_EQ(verdict(bench.say("arm")), "ok");
  EXPECT_EQ(verdict(bench.say("move joint0 motor=-1")).rfind("error outside: ", 0), 0U) << "it would be held at once";
  EXPECT_EQ(verdict(bench.say("move joint0 1.9")), "ok");
  bench.ticks(2000);
  EXPECT_NEAR(bench.io.motors[0].angle_rad, -0.3, 0.01);
}

TEST(MotorPosition, BlockedMotorIsAFollowingErrorAndADeadEncoderIsFoundAsInPositionControl) {
  {
    Rig rig;
    rig.arm();
    rig.io.blocked = true;
    rig.disturb = [count = 0](Sensed<1>& sensed) mutable { sensed.axis[0].encoder_counts += ++count % 2; };  // it lives
    rig.tick(to_motor(3.0));
    for (int i = 0; i < 2000 && rig.now() != State::kFaulted; ++i) {
      rig.tick();
    }
    EXPECT_EQ(rig.state.telemetry.first_fault, Fault::kFollowingError);
  }
  Rig rig;
  rig.arm();
  rig.disturb = [](Sensed<1>& sensed) { sensed.axis[0].encoder_counts = 0; };
  rig.tick(to_motor(3.0));
  for (int i = 0; i < 2000 && rig.now() != State::kFaulted; ++i) {
    rig.tick();
  }
  EXPECT_EQ(rig.state.telemetry.first_fault, Fault::kEncoderFrozen);
  EXPECT_TRUE(rig.torque_off());
}

TEST(MotorPosition, CommandsWithoutSpeedOrOutsideTheTravelChangeNothing) {
  Rig rig;
  rig.arm();
  rig.tick(to_motor(1.0, 0.0));
  rig.tick(to_motor(1.0, -1.0));
  rig.tick(to_motor(6.1));
  EXPECT_EQ(rig.joint().mode, ControlMode::kPosition);
  EXPECT_EQ(rig.now(), State::kHolding);
}

}  // namespace
}  // namespace capstan
