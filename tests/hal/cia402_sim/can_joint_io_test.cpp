// SPDX-License-Identifier: Apache-2.0
// The firmware's whole cycle against simulated drives over a local bus.
#include "capstan/hal/linux/can_joint_io.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/tests/hal/cia402_sim/can_rig.hpp"

namespace capstan {
namespace {

using cia402::Anomaly;
using Rig = test::CanRig;

TEST(CanJointIo, MovesAJointAndTheOtherStands) {
  Rig rig;
  rig.arm();
  rig.application().post({.kind = Request::Kind::kMove,
                          .axis = 0,
                          .position_rad = Q24::from_double(0.4),
                          .speed_rad_s = Q24::from_int(1)});
  rig.cycles(1500);
  EXPECT_EQ(rig.state(), State::kHolding);
  EXPECT_NEAR(rig.drive(0).truth().q1_rad, rig.application().axis_telemetry(0).q1_rad.to_double(), 2e-3)
      << "what the firmware sees is where the motor is";
  EXPECT_NEAR(rig.drive(0).truth().q2_rad, 0.4, 0.1);
  EXPECT_NEAR(rig.drive(1).truth().q2_rad, 0.0, 0.02);
  for (std::size_t i = 0; i < cia402::kAnomalies; ++i) {
    EXPECT_EQ(rig.count(static_cast<Anomaly>(i)), 0U) << cia402::info(static_cast<Anomaly>(i)).name;
  }
}

TEST(CanJointIo, PackedSetValuesMoveTheRightJointToo) {
  Rig rig({}, cia402::PdoLayout::kPacked);
  rig.arm();
  rig.application().post({.kind = Request::Kind::kMove,
                          .axis = 1,
                          .position_rad = Q24::from_double(-0.3),
                          .speed_rad_s = Q24::from_int(1)});
  rig.cycles(1500);
  EXPECT_EQ(rig.state(), State::kHolding);
  EXPECT_NEAR(rig.drive(1).truth().q2_rad, -0.3, 0.1);
  EXPECT_NEAR(rig.drive(0).truth().q2_rad, 0.0, 0.02);
}

TEST(CanJointIo, DisarmingTakesTheTorqueWithinTwoCycles) {
  Rig rig;
  rig.arm();
  rig.disarm();
  rig.cycles(2);
  EXPECT_FALSE(rig.drive(0).enabled());
  EXPECT_FALSE(rig.drive(1).enabled());
}

struct Case {
  const char* incident;
  std::vector<Fault> faults;
  Anomaly anomaly;
};

/// Every incident ends with both drives without torque, in the cycle after it is seen, and is counted.
class Incidents : public testing::TestWithParam<Case> {};

TEST_P(Incidents, EndWithoutTorqueOnAnyDrive) {
  Rig rig({std::string("0.1:") + GetParam().incident});
  rig.arm();
  int cycles = 0;
  while (rig.state() != State::kFaulted && cycles < 400) {
    rig.cycle();
    ++cycles;
  }
  ASSERT_EQ(rig.state(), State::kFaulted);
  rig.cycle();
  EXPECT_FALSE(rig.drive(0).enabled() && std::string(GetParam().incident) != "silence:1");
  EXPECT_FALSE(rig.drive(1).enabled()) << "one cycle after the fault the sound one is off too";
  EXPECT_NE(std::find(GetParam().faults.begin(), GetParam().faults.end(), rig.fault()), GetParam().faults.end())
      << info(rig.fault()).name;
  EXPECT_GT(rig.count(GetParam().anomaly), 0U);
}

INSTANTIATE_TEST_SUITE_P(
    All, Incidents,
    testing::Values(Case{"silence:1", {Fault::kSensorMissing}, Anomaly::kStatusMissing},
                    Case{"no-heartbeat:1", {Fault::kDriveFailed}, Anomaly::kHeartbeatLost},
                    Case{"short-status:1", {Fault::kSensorMissing}, Anomaly::kStatusLength},
                    Case{"double-status:1", {Fault::kSensorInvalid}, Anomaly::kStatusContradicts},
                    Case{"bad-status:1", {Fault::kDriveFailed}, Anomaly::kStatusUnknown},
                    Case{"fault:1", {Fault::kDriveFailed}, Anomaly::kEmergency},
                    Case{"restart:1", {Fault::kDriveFailed, Fault::kSensorMissing}, Anomaly::kRestarted},
                    Case{"short-heartbeat:1", {Fault::kDriveFailed}, Anomaly::kHeartbeatLength},
                    Case{"bad-heartbeat:1", {Fault::kDriveFailed}, Anomaly::kHeartbeatState},
                    Case{"foreign-sync:1",
                         {Fault::kDriveFailed, Fault::kSensorInvalid, Fault::kSensorMissing},
                         Anomaly::kForeignSync},
                    Case{"flood:1", {Fault::kSensorInvalid}, Anomaly::kStatusContradicts}),
    [](const testing::TestParamInfo<Case>& test) {
      std::string name = test.param.incident;
      std::replace_if(
          name.begin(), name.end(), [](char c) { return c == '-' || c == ':'; }, '_');
      return name;
    });

TEST(CanJointIo, ADriveInFaultIsResetAndCanBeArmedAgainOneThatRestartedCanNot) {
  for (const auto& [incident, again] : {std::pair{"0.1:fault:1", true}, {"0.1:restart:1", false}}) {
    Rig rig({incident});
    rig.arm();
    rig.cycles(200);
    ASSERT_EQ(rig.state(), State::kFaulted);
    rig.disarm();
    rig.cycles(600);
    rig.application().post({.kind = Request::Kind::kArm});
    rig.cycles(20);
    EXPECT_EQ(rig.state() == State::kHolding, again) << incident;
    EXPECT_EQ(rig.drive(0).enabled(), again) << incident;
  }
}

TEST(CanJointIo, WhatWaitedInTheSocketIsNotReplayed) {
  Rig rig;
  rig.arm();
  // The program stands still for 50 ms; what the drives said meanwhile is of the past.
  const cia402::Frame old{.id = 0x181, .size = 8, .data = {0x37, 0x12, 0xFF, 0xFF, 0xFF, 0x7F}};
  rig.cycle([&] { rig.send(std::vector<cia402::Frame>(50, old)); });
  EXPECT_EQ(rig.state(), State::kFaulted);
  EXPECT_EQ(rig.fault(), Fault::kSensorInvalid);
  EXPECT_EQ(rig.count(Anomaly::kFlood), 1U);
  EXPECT_LT(std::abs(rig.application().axis_telemetry(0).q1_rad.to_double()), 0.1) << "it never became a position";
}

TEST(CanJointIo, WhatTheKernelHasNoRoomForIsAFailedWriteInTheSameCycle) {
  Rig rig;
  rig.arm();
  for (int writes = 0; rig.io().write({}) == Status::kOk; ++writes) {  // and nobody reads the other end
    ASSERT_LT(writes, 100'000);
    ASSERT_EQ(rig.count(Anomaly::kSendQueueFull), 0U);
  }
  EXPECT_EQ(rig.count(Anomaly::kSendQueueFull), 1U);
}

TEST(CanBus, ASignalIsHeardWhileDrivesAreSetUpAndLeavesNoneInOperation) {
  static int asked = 0;
  asked = 0;
  auto [near, far] = CanSocket::pair(test::test_clock);
  const CanSetup setup{.buses = {{"unix:local", {1, 2}}}, .interrupted = [] { return ++asked > 5; }};
  std::ostringstream said;
  EXPECT_THROW(CanBus(std::move(near), setup.buses[0], setup, said), SetUpInterrupted) << "nobody answers there";
  std::vector<cia402::Frame> frames;
  for (cia402::Received received; far.rt_receive(received);) {
    if (received.kind == cia402::Received::Kind::kFrame) {
      frames.push_back(received.frame);
    }
  }
  ASSERT_GE(frames.size(), 2U);
  EXPECT_EQ(frames[frames.size() - 2], cia402::nmt_frame(cia402::NmtCommand::kPreOperational, 1));
  EXPECT_EQ(frames.back(), cia402::nmt_frame(cia402::NmtCommand::kPreOperational, 2));
}

TEST(CanJointIo, ABusThatIsGoneIsAFailedDrive) {
  Rig rig;
  rig.arm();
  rig.hang_up();
  ++test::time_ms;
  rig.application().rt_tick();
  rig.application().rt_tick();
  EXPECT_EQ(rig.state(), State::kFaulted);
  EXPECT_EQ(rig.count(Anomaly::kLinkDown), 1U);
}

}  // namespace
}  // namespace capstan
