// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/loop/cycle.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <vector>

#include "capstan/tests/firmware/loop/cycle_rig.hpp"

namespace capstan {
namespace {

using Rig = test::CycleRig<1>;

TEST(Cycle, CommandsBeforeArmingDoNotMoveAnything) {
  Rig rig;
  rig.move(1.0);
  rig.follow(0.5);
  EXPECT_EQ(rig.now(), State::kDisarmed);
  Command<1> both{.arm = true};
  both.axis[0] = {.kind = Request::Kind::kMove, .position_rad = Q24::from_int(1), .speed_rad_s = Q24::from_int(1)};
  rig.tick(both);
  rig.ticks(1000);
  EXPECT_EQ(rig.now(), State::kHolding);
  EXPECT_NEAR(rig.io.motors[0].angle_rad, 0.0, 1e-3);
}

TEST(Cycle, AMoveIsForgottenByDisarming) {
  Rig rig;
  rig.arm();
  rig.move(1.5);
  rig.ticks(100);
  rig.tick({.disarm = true});
  rig.ticks(500);
  const double rest = rig.io.motors[0].angle_rad;
  rig.arm();
  rig.ticks(1000);
  EXPECT_EQ(rig.now(), State::kHolding);
  EXPECT_NEAR(rig.io.motors[0].angle_rad, rest, 2e-3);
}

// Neither direction's steady motion has the torque that is kept.
TEST(Cycle, AMoveOutOfTorqueControlBeginsWithTheTorqueThatTheMotorHasAndRunsFromTheNextCycleOn) {
  Config<1> config;
  config[0].control.torque_forward_nm = Q24::from_double(0.02);
  config[0].control.torque_backward_nm = Q24::from_double(-0.01);
  Rig rig(config);
  rig.io.blocked = true;
  rig.arm();
  EXPECT_NEAR(rig.drive.axis[0].current_a.to_double(), 0.05, 1e-5) << "the mean of both directions, 0.1 N m/A";
  Command<1> torque;
  torque.axis[0] = {.kind = Request::Kind::kTorque, .torque_nm = Q24::from_double(0.04)};
  rig.tick(torque);
  EXPECT_NEAR(rig.drive.axis[0].current_a.to_double(), 0.4, 1e-5);
  rig.move(1.0);
  EXPECT_NEAR(rig.drive.axis[0].current_a.to_double(), 0.4, 1e-5);
  EXPECT_EQ(rig.joint().mode, ControlMode::kPosition);
  EXPECT_EQ(rig.joint().q2_reference_rad, rig.joint().q2_rad);
  rig.tick();
  // From the mean towards the forward torque within 20 ms: a 21st of 0.015 N m in the first of them.
  EXPECT_NEAR(rig.drive.axis[0].current_a.to_double(), 0.4, 0.15 / 21.0 + 1e-3) << "it sets out without a jump";
  EXPECT_GT(rig.joint().q2_reference_rad, rig.joint().q2_rad);
}

TEST(Cycle, AMoveEndsAtItsTargetAndThenHolds) {
  Rig rig;
  rig.arm();
  rig.tick();
  rig.move(1.0);
  EXPECT_EQ(rig.now(), State::kMoving);
  rig.ticks(3000);
  EXPECT_EQ(rig.now(), State::kHolding);
  EXPECT_EQ(rig.joint().q2_reference_rad, Q24::from_int(1));
  EXPECT_NEAR(rig.io.motors[0].angle_rad, 1.0, 2e-3);
}

TEST(Cycle, AFaultOfOneJointTakesTheTorqueOfAll) {
  test::CycleRig<2> rig;
  rig.arm();
  rig.tick();
  ASSERT_TRUE(rig.drive.axis[0].enabled && rig.drive.axis[1].enabled);
  rig.disturb = [](Sensed<2>& s) { s.axis[1].current = Quality::kInvalid; };
  rig.tick();
  EXPECT_TRUE(rig.torque_off());
  EXPECT_EQ(rig.state.telemetry.first_fault, Fault::kSensorInvalid);
}

// Shaft of 9 mm, jaw of 10 mm, 2 mm to the side, pitched by a quarter turn with the jaw bent by another: 9 mm along y,
// 2 mm back along x, 10 mm down.
TEST(Cycle, AJawSaysWhereItsTipIsWhileBothOfItsAnglesAreKnown) {
  constexpr double kQuarter = 1.5707963267948966;
  Config<2> config;
  config[1].tip.pitch = 0;
  config[1].tip.links = {Q24::from_double(0.009), Q24::from_double(0.01), Q24::from_double(0.002)};
  test::CycleRig<2> rig(config);
  for (int i = 1; i <= 100; ++i) {
    rig.io.motors[0].angle_rad = kQuarter * i / 100.0;
    rig.io.motors[1].angle_rad = kQuarter * i / 100.0;
    rig.tick();
  }
  const auto expect_tip = [&rig](std::size_t axis, const std::array<double, 3>& tip_m) {
    for (std::size_t i = 0; i < tip_m.size(); ++i) {
      EXPECT_NEAR(rig.joint(axis).tip_m[i].to_double(), tip_m[i], 5e-6) << axis << ", " << i;
    }
  };
  ASSERT_TRUE(rig.joint(0).estimate_valid && rig.joint(1).estimate_valid);
  expect_tip(1, {-0.002, 0.009, -0.01});
  expect_tip(0, {0.0, 0.0, 0.0});
  rig.disturb = [](Sensed<2>& s) { s.axis[0].encoder = Quality::kInvalid; };
  rig.ticks(30);
  ASSERT_FALSE(rig.joint(0).estimate_valid);
  expect_tip(1, {0.0, 0.0, 0.0});
}

TEST(Cycle, AJawOnAPitchThatIsNotThereHasNoTip) {
  for (const std::int32_t pitch : {-1, 1, 3}) {
    Config<2> config;
    config[1].tip.pitch = pitch;
    config[1].tip.links.jaw_m = Q24::from_double(0.01);
    const test::CycleRig<2> rig(config);
    EXPECT_EQ(rig.joint(1).tip_m, (std::array<Q24, 3>{})) << pitch;
  }
}

/// What a cycle gives, without padding.
auto bytes_of(const CycleState<2>& state, const Drive<2>& drive) -> std::vector<std::int64_t> {
  const MachineTelemetry& machine = state.telemetry;
  std::vector<std::int64_t> all = {machine.tick, static_cast<std::int64_t>(machine.state),
                                   static_cast<std::int64_t>(machine.first_fault), machine.conditions,
                                   machine.overruns};
  for (std::size_t i = 0; i < 2; ++i) {
    const AxisTelemetry& axis = state.axis[i].telemetry();
    for (const Q24 value : {drive.axis[i].current_a, axis.q1_rad, axis.tau_nm, axis.q2_rad, axis.q2_reported_rad,
                            axis.q2_reference_rad, axis.current_a, axis.drive_a}) {
      all.push_back(value.raw());
    }
    all.insert(all.end(), {drive.axis[i].enabled, axis.limits, axis.estimate_valid});
  }
  return all;
}

TEST(Cycle, ARecordedRunReplaysBitForBitIntoAnyFreshState) {
  const Config<2> config = {test::lossy_config(), AxisConfig{}};
  test::CycleRig<2> rig(config);
  std::vector<std::pair<Sensed<2>, Command<2>>> run;
  std::vector<std::vector<std::int64_t>> results;
  run.emplace_back(rig.sensed, Command<2>{});  // the rig's own first cycle
  results.push_back(bytes_of(rig.state, rig.drive));
  for (int i = 0; i < 6000; ++i) {
    Command<2> command;
    command.arm = i % 1000 == 10;
    command.disarm = i % 1000 == 990;
    if (i % 300 == 100) {
      command.axis[0] = {.kind = Request::Kind::kMove,
                         .position_rad = Q24::from_double(-0.15 * (i % 5)),
                         .speed_rad_s = Q24::from_int(1)};
      command.axis[1] = {.kind = Request::Kind::kMove,
                         .position_rad = Q24::from_double(0.1 * (i % 7)),
                         .speed_rad_s = Q24::from_int(2)};
    }
    rig.io.encoder = i % 1700 == 1600 ? Quality::kMissing : Quality::kOk;
    rig.tick(command);
    run.emplace_back(rig.sensed, command);
    results.push_back(bytes_of(rig.state, rig.drive));
  }
  EXPECT_NE(results[20], results[200]) << "a run in which nothing happens would prove nothing";
  for (int copy = 0; copy < 2; ++copy) {
    CycleState<2> fresh(config);
    for (std::size_t i = 0; i < run.size(); ++i) {
      const Drive<2> drive = cycle(fresh, run[i].first, run[i].second);
      ASSERT_EQ(bytes_of(fresh, drive), results[i]) << "cycle " << i;
    }
  }
}

RC_GTEST_PROP(Cycle, NoInputWhateverGivesTorqueBeyondTheLimitOrWithoutArming, ()) {
  const Config<1> config{};
  CycleState<1> state(config);
  bool armed = false;
  const int length = *rc::gen::inRange(1, 400);
  std::int32_t counts = 0;
  Q24 last;
  for (int i = 0; i < length; ++i) {
    Sensed<1> sensed;
    const auto quality = [] { return *rc::gen::inRange(0, 100) == 0 ? Quality::kInvalid : Quality::kOk; };
    counts += *rc::gen::inRange(-300, 301);
    sensed.axis[0] = {counts, Q24::from_raw(*rc::gen::inRange(-(1 << 26), 1 << 26)), quality(), quality()};
    sensed.estop = *rc::gen::inRange(0, 200) == 0;
    Command<1> command;
    command.arm = *rc::gen::inRange(0, 10) == 0;
    command.disarm = *rc::gen::inRange(0, 100) == 0;
    command.axis[0] = {.kind = static_cast<Request::Kind>(*rc::gen::inRange(0, 4)),
                       .position_rad = Q24::from_raw(*rc::gen::arbitrary<std::int32_t>()),
                       .speed_rad_s = Q24::from_raw(*rc::gen::arbitrary<std::int32_t>())};
    const Drive<1> drive = cycle(state, sensed, command);
    armed = (armed || command.arm) && !command.disarm;
    RC_ASSERT(!drive.axis[0].enabled || armed);
    RC_ASSERT(!drive.axis[0].enabled || state.telemetry.conditions == 0);
    RC_ASSERT(drive.axis[0].enabled || drive.axis[0].current_a == Q24{});
    RC_ASSERT(abs(drive.axis[0].current_a) <= config[0].limits.current_a);
    RC_ASSERT(abs(drive.axis[0].current_a) <= abs(last) + config[0].limits.current_rate_a_per_cycle);
    last = drive.axis[0].current_a;
  }
}

}  // namespace
}  // namespace capstan
