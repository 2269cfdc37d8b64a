// SPDX-License-Identifier: Apache-2.0
// Every fault of the table by its cause, in every state.
#include <gtest/gtest.h>

#include <vector>

#include "capstan/tests/firmware/loop/cycle_rig.hpp"

namespace capstan {
namespace {

using Rig = test::CycleRig<1>;

/// A way to provoke a fault, and the most cycles until it must be detected.
struct Cause {
  const char* name;
  Fault fault;
  int cycles;
  bool needs_torque;
  std::function<void(Rig&)> begin;
};

auto sensed_as(void (*change)(Sensed<1>&)) -> std::function<void(Rig&)> {
  return [change](Rig& rig) { rig.disturb = change; };
}

void watch_supply(Rig& rig) {
  AxisConfig config;
  config.limits.supply_min_v = Q24::from_int(12);
  rig.state.axis[0].rt_configure(config);
}

const std::vector<Cause> kCauses = {
    {"encoder missing", Fault::kSensorMissing, 1, false,
     sensed_as([](Sensed<1>& s) { s.axis[0].encoder = Quality::kMissing; })},
    {"current missing", Fault::kSensorMissing, 1, false,
     sensed_as([](Sensed<1>& s) { s.axis[0].current = Quality::kMissing; })},
    {"nothing read at all", Fault::kSensorMissing, 1, false, sensed_as([](Sensed<1>& s) { s = {}; })},
    {"encoder not a number", Fault::kSensorInvalid, 1, false,
     sensed_as([](Sensed<1>& s) { s.axis[0].encoder = Quality::kInvalid; })},
    {"current not a number", Fault::kSensorInvalid, 1, false,
     sensed_as([](Sensed<1>& s) { s.axis[0].current = Quality::kInvalid; })},
    {"encoder jumps", Fault::kEncoderJump, 1, false, [](Rig& rig) { rig.io.encoder_shift += 1000; }},
    {"encoder jumps far", Fault::kEncoderJump, 1, false, [](Rig& rig) { rig.io.encoder_shift -= 1LL << 30; }},
    {"joint blocked", Fault::kEncoderFrozen, 400, true,
     [](Rig& rig) {
       rig.io.blocked = true;
       rig.move(rig.joint().q2_rad.to_double() > 0.0 ? -1.5 : 1.5);
     }},
    {"joint in treacle", Fault::kFollowingError, 700, true,
     [](Rig& rig) {
       rig.io.drag_nms = 20.0;
       rig.move(rig.joint().q2_rad.to_double() > 0.0 ? -1.5 : 1.5);
     }},
    {"too much current", Fault::kOverCurrent, 20, false, [](Rig& rig) { rig.io.current_shift_a = 3.8; }},
    {"too much current the other way", Fault::kOverCurrent, 20, false, [](Rig& rig) { rig.io.current_shift_a = -3.8; }},
    {"the law leaves its range", Fault::kEstimatorRange, 1, false,
     [](Rig& rig) {
       AxisConfig config;
       config.law.coefficients[1] = Q24::max();
       rig.state.axis[0].rt_configure(config);
     }},
    {"references stop", Fault::kLinkLost, 99, true, [](Rig& rig) { rig.follow(rig.joint().q2_rad.to_double()); }},
    {"emergency stop", Fault::kEmergencyStop, 1, false, [](Rig& rig) { rig.io.estop = true; }},
    {"supply too low", Fault::kSupplyLow, 10, false,
     [](Rig& rig) {
       watch_supply(rig);
       rig.disturb = [](Sensed<1>& s) {
         s.axis[0].supply = Quality::kOk;
         s.axis[0].supply_v = Q24::from_double(11.9);
       };
     }},
    {"supply not measured", Fault::kSupplyLow, 10, false, watch_supply},
    {"three late cycles at once", Fault::kOverrun, 1, false, [](Rig& rig) { rig.io.overruns += 3; }},
    {"a flood of late cycles", Fault::kOverrun, 1, false, [](Rig& rig) { rig.io.overruns += 4'000'000'000U; }},
    {"model invalid", Fault::kModelInvalid, 1, false,
     [](Rig& rig) { rig.state.model_faults = bit(Fault::kModelInvalid); }},
    {"amplifier fails", Fault::kDriveFailed, 1, false,
     [](Rig& rig) { rig.state.drive_faults = bit(Fault::kDriveFailed); }},
    {"the amplifier gives too little", Fault::kCurrentMismatch, 50, false,
     [](Rig& rig) { rig.disturb = [](Sensed<1>& s) { s.axis[0].current_a -= Q24::from_double(0.52); }; }},
    {"the winding is overloaded", Fault::kWindingHot, 6500, false,
     [](Rig& rig) {
       AxisConfig config;
       config.limits.current_mismatch_a = Q24::from_int(100);
       rig.state.axis[0].rt_configure(config);
       rig.disturb = [](Sensed<1>& s) { s.axis[0].current_a = Q24::from_double(2.5); };
       Command<1> stop;  // ends a stream, whose silence would be the earlier fault
       stop.axis[0].kind = Request::Kind::kStop;
       rig.tick(stop);
     }},
    {"the memory is not readable", Fault::kStorageFailed, 1, false,
     [](Rig& rig) { rig.state.model_faults = bit(Fault::kStorageFailed); }},
    {"the crystal does not start", Fault::kBoardClock, 1, false,
     [](Rig& rig) { rig.state.board_faults = bit(Fault::kBoardClock); }},
    {"the encoder turns round and no torque did it", Fault::kEncoderMotion, 10, true,
     [](Rig& rig) {
       AxisConfig config;
       config.observer = {.inertia_gm2 = Q24::from_double(0.02),
                          .coulomb_nm = Q24::from_double(0.003),
                          .against_nm = Q24::from_double(0.01),
                          .noise_a = Q24::from_double(0.01)};
       rig.state.axis[0].rt_configure(config);
       rig.disturb = [cycle = 0, shift = 0](Sensed<1>& s) mutable {
         shift += cycle++ % 8 < 4 ? 100 : -100;
         s.axis[0].encoder_counts += shift;
       };
     }},
    {"the motor runs away", Fault::kOverspeed, 80, true,
     [](Rig& rig) {
       rig.disturb = [&motor = rig.io.motors[0], at = rig.io.motors[0].angle_rad](Sensed<1>&) mutable {
         motor.angle_rad = at += 0.02;  // 20 rad/s of the 60 that the encoder may
         motor.speed_rad_s = 0.0;
       };
     }},
    {"the watchdog ended the last run", Fault::kWatchdog, 1, false,
     [](Rig& rig) { rig.state.board_faults = bit(Fault::kWatchdog); }},
};

TEST(CycleFaults, EveryFaultOfTheTableHasACauseAmongTheTests) {
  for (const FaultInfo& entry : kFaultTable) {
    EXPECT_TRUE(
        entry.code == Fault::kNone || entry.code == Fault::kLimitCycle ||  // four seconds: limit_cycle_test
        std::any_of(kCauses.begin(), kCauses.end(), [&](const Cause& cause) { return cause.fault == entry.code; }))
        << entry.name;
  }
}

/// In cycles until the fault is among the conditions; -1 if that takes longer than it may.
auto detect(Rig& rig, const Cause& cause) -> int {
  cause.begin(rig);
  for (int cycles = 1; cycles <= cause.cycles; ++cycles) {
    if (rig.has(cause.fault)) {
      return cycles;
    }
    rig.tick();
  }
  return rig.has(cause.fault) ? cause.cycles : -1;
}

enum class Situation { kHolding, kMoving, kFollowing };

void bring_into(Rig& rig, Situation situation) {
  rig.arm();
  rig.ticks(5);
  if (situation == Situation::kMoving) {
    rig.move(1.5);
    rig.ticks(100);
  }
  if (situation == Situation::kFollowing) {
    for (int i = 0; i < 100; ++i) {
      rig.follow(0.001 * i);
    }
  }
  EXPECT_EQ(rig.now(), situation == Situation::kHolding ? State::kHolding : State::kMoving);
  EXPECT_TRUE(rig.drive.axis[0].enabled);
}

TEST(CycleFaults, EveryCauseTakesTorqueAwayInTheVeryCycleOfItsDetectionAndIsLatched) {
  for (const Situation situation : {Situation::kHolding, Situation::kMoving, Situation::kFollowing}) {
    for (const Cause& cause : kCauses) {
      SCOPED_TRACE(std::string(cause.name) + " in situation " + std::to_string(static_cast<int>(situation)));
      Rig rig;
      bring_into(rig, situation);
      ASSERT_GT(detect(rig, cause), 0) << "not detected in time";
      EXPECT_TRUE(rig.torque_off());
      EXPECT_EQ(rig.now(), State::kFaulted);
      EXPECT_EQ(rig.state.telemetry.first_fault, cause.fault);
    }
  }
}

TEST(CycleFaults, AFaultStaysLatchedWithoutItsCauseUntilTheOperatorDisarms) {
  for (const Cause& cause : kCauses) {
    SCOPED_TRACE(cause.name);
    Rig rig;
    bring_into(rig, Situation::kHolding);
    ASSERT_GT(detect(rig, cause), 0);
    rig.disturb = nullptr;
    rig.io.encoder_shift = 0;
    rig.io.estop = false;
    rig.io.current_shift_a = 0.0;
    rig.io.blocked = false;
    rig.io.drag_nms = 2.0e-3;
    rig.state.axis[0].rt_configure(AxisConfig{});
    rig.state.model_faults = 0;
    rig.state.drive_faults = 0;
    rig.state.board_faults = 0;
    rig.tick({.disarm = false, .axis = {Request{.kind = Request::Kind::kZero, .position_rad = rig.joint().q1_rad}}});
    for (int i = 0; i < 3500; ++i) {
      rig.tick({.arm = true});
      ASSERT_TRUE(rig.torque_off());
      ASSERT_EQ(rig.state.telemetry.first_fault, cause.fault);
    }
    EXPECT_EQ(rig.state.telemetry.conditions, 0U) << "the cause is gone";
    rig.tick({.disarm = true});
    EXPECT_EQ(rig.now(), State::kDisarmed);
    rig.arm();
    EXPECT_EQ(rig.now(), State::kHolding);
  }
}

TEST(CycleFaults, ALaterCauseDoesNotReplaceTheFirst) {
  for (const Cause& cause : kCauses) {
    if (cause.needs_torque) {
      continue;
    }
    Rig rig;
    bring_into(rig, Situation::kHolding);
    rig.io.estop = true;
    rig.tick();
    ASSERT_EQ(rig.state.telemetry.first_fault, Fault::kEmergencyStop);
    EXPECT_GT(detect(rig, cause), 0) << cause.name << " is shown though another fault is latched";
    EXPECT_EQ(rig.state.telemetry.first_fault, Fault::kEmergencyStop) << cause.name;
    EXPECT_TRUE(rig.torque_off());
  }
}

TEST(CycleFaults, ACauseThatIsPresentBeforeArmingBlocksItAndIsNamed) {
  for (const Cause& cause : kCauses) {
    if (cause.needs_torque) {
      continue;
    }
    SCOPED_TRACE(cause.name);
    Rig rig;
    ASSERT_GT(detect(rig, cause), 0);
    rig.arm();
    EXPECT_EQ(rig.now(), State::kDisarmed);
    EXPECT_TRUE(rig.torque_off());
    EXPECT_TRUE(rig.has(cause.fault));
    EXPECT_EQ(rig.state.telemetry.first_fault, Fault::kNone) << "what blocks is not a latched fault";
  }
}

TEST(CycleFaults, AJumpInTheVeryCycleOfArmingBlocksIt) {
  Rig rig;
  rig.io.encoder_shift = 1000;
  rig.arm();
  EXPECT_EQ(rig.now(), State::kDisarmed);
  EXPECT_TRUE(rig.torque_off());
}

TEST(CycleFaults, AfterAJumpThePositionIsUnknownSoArmingIsBlockedUntilTheOperatorSaysWhereTheMotorStands) {
  Rig rig;
  bring_into(rig, Situation::kHolding);
  rig.io.encoder_shift = 5000;  // counts that came from nowhere
  rig.tick();
  ASSERT_EQ(rig.state.telemetry.first_fault, Fault::kEncoderJump);
  rig.tick({.disarm = true});
  rig.ticks(1000);
  rig.arm();
  EXPECT_EQ(rig.now(), State::kDisarmed);
  EXPECT_TRUE(rig.has(Fault::kEncoderJump));
  EXPECT_FALSE(rig.joint().estimate_valid);

  Command<1> zero;
  zero.axis[0] = {.kind = Request::Kind::kZero, .position_rad = Q24::from_double(0.25)};
  rig.tick(zero);
  EXPECT_FALSE(rig.has(Fault::kEncoderJump));
  EXPECT_NEAR(rig.joint().q1_rad.to_double(), 0.25, 1e-4);
  rig.arm();
  EXPECT_EQ(rig.now(), State::kHolding);
  EXPECT_NEAR(rig.joint().q2_reference_rad.to_double(), 0.25, 1e-4) << "it holds where it was said to stand";
}

TEST(CycleFaults, TheOperatorsZeroIsNotTakenUnderTorque) {
  Rig rig;
  bring_into(rig, Situation::kHolding);
  Command<1> zero;
  zero.axis[0] = {.kind = Request::Kind::kZero, .position_rad = Q24::from_double(1.0)};
  rig.tick(zero);
  rig.ticks(10);
  EXPECT_NEAR(rig.joint().q1_rad.to_double(), 0.0, 1e-3);
  EXPECT_EQ(rig.now(), State::kHolding);
}

TEST(CycleFaults, ASingleMissingSampleTakesTorqueAway) {
  Rig rig;
  bring_into(rig, Situation::kMoving);
  rig.io.encoder = Quality::kMissing;
  rig.tick();
  rig.io.encoder = Quality::kOk;
  EXPECT_EQ(rig.now(), State::kFaulted);
  rig.ticks(10);
  EXPECT_TRUE(rig.torque_off());
}

TEST(CycleFaults, AMissingSampleLeavesTheEstimateMarkedAsNotValid) {
  Rig rig;
  ASSERT_TRUE(rig.joint().estimate_valid);
  rig.io.current = Quality::kMissing;
  rig.tick();
  EXPECT_FALSE(rig.joint().estimate_valid);
}

TEST(CycleFaults, FollowingErrorNeedsDistanceAndTime) {
  Rig rig;
  bring_into(rig, Situation::kHolding);
  rig.io.drag_nms = 20.0;
  rig.move(1.5);
  int beyond = 0;
  while (rig.now() != State::kFaulted) {
    ASSERT_LT(beyond, 300);
    const Q24 error = rig.joint().q2_reference_rad - rig.joint().q2_rad;
    beyond += abs(error) > Q24::from_double(0.35) ? 1 : 0;
    rig.tick();
  }
  EXPECT_NEAR(beyond, 250, 1) << "limits.following_time is 0.25 s";
}

TEST(CycleFaults, AShortFollowingErrorIsForgivenHoweverOften) {
  Rig rig;
  bring_into(rig, Situation::kHolding);
  rig.io.drag_nms = 20.0;
  for (int excursion = 0; excursion < 6; ++excursion) {
    rig.move(excursion % 2 == 0 ? 0.4 : -0.4);  // 0.05 rad beyond the limit: 0.1 s there and 0.1 s back
    while (rig.now() == State::kMoving) {
      rig.tick();
    }
    EXPECT_GT(abs(rig.joint().q2_reference_rad - rig.joint().q2_rad), Q24::from_double(0.35));
    rig.move(0.0);
    while (rig.now() == State::kMoving) {
      rig.tick();
    }
    ASSERT_TRUE(energised(rig.now())) << "excursion " << excursion;
  }
}

TEST(CycleFaults, OverCurrentForLessThanItsTimeIsForgiven) {
  Rig rig;
  bring_into(rig, Situation::kHolding);
  rig.disturb = [](Sensed<1>& s) { s.axis[0].current_a = Q24::from_double(3.7); };
  rig.ticks(19);
  EXPECT_TRUE(energised(rig.now()));
  rig.disturb = nullptr;
  rig.ticks(10);
  EXPECT_TRUE(energised(rig.now()));
}

TEST(CycleFaults, AStreamThatPausesForLessThanAHundredMillisecondsIsForgivenAndALongerOneIsNot) {
  Rig rig;
  bring_into(rig, Situation::kFollowing);
  rig.ticks(97);
  rig.follow(0.1);
  ASSERT_TRUE(energised(rig.now()));
  rig.ticks(97);
  ASSERT_TRUE(energised(rig.now()));
  rig.ticks(1);
  EXPECT_EQ(rig.state.telemetry.first_fault, Fault::kLinkLost);
  EXPECT_TRUE(rig.torque_off());
}

TEST(CycleFaults, AStopEndsTheStreamSoItsSilenceIsNoFault) {
  Rig rig;
  bring_into(rig, Situation::kFollowing);
  Command<1> stop;
  stop.axis[0].kind = Request::Kind::kStop;
  rig.tick(stop);
  rig.ticks(500);
  EXPECT_EQ(rig.now(), State::kHolding);
}

TEST(CycleFaults, TwoOverrunsASecondAreNoiseAndThreeAreAFault) {
  Rig noisy;
  noisy.arm();
  for (int i = 0; i < 20; ++i) {
    ++noisy.io.overruns;
    noisy.ticks(501);
    ASSERT_TRUE(energised(noisy.now())) << i;
  }
  EXPECT_EQ(noisy.state.telemetry.overruns, 20U);

  Rig late;
  late.arm();
  for (int i = 0; i < 2; ++i) {
    ++late.io.overruns;
    late.ticks(499);
    ASSERT_TRUE(energised(late.now())) << i;
  }
  ++late.io.overruns;
  late.tick();
  EXPECT_EQ(late.state.telemetry.first_fault, Fault::kOverrun);
  EXPECT_TRUE(late.torque_off());
}

TEST(CycleFaults, AfterAFloodOfOverrunsArmingIsBlockedForASecondAndNotLonger) {
  Rig rig;
  rig.io.overruns += 800;  // as after a save that stopped the processor
  rig.ticks(998);
  rig.arm();
  EXPECT_EQ(rig.now(), State::kDisarmed);
  rig.ticks(2);
  rig.arm();
  EXPECT_EQ(rig.now(), State::kHolding);
}

}  // namespace
}  // namespace capstan
