// SPDX-License-Identifier: Apache-2.0
// The firmware behind a CAN controller that behaves as RM0090 says: heartbeat, telemetry, setpoints and a shell.
#include "capstan/boards/stm32f405/can_node.hpp"

#include <gtest/gtest.h>

#include <string>

#include "capstan/tests/boards/stm32f405/can_bench.hpp"

namespace capstan::stm32f405 {
namespace {

/// Four bytes of a frame from one on.
auto little_endian(const CanFrame& frame, std::size_t first) -> std::uint32_t {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) {
    value = value << 8U | frame.data[first + i];
  }
  return value;
}

class Node : public testing::Test, protected CanBench {
 protected:
  void SetUp() override { ASSERT_TRUE(start()); }
};

TEST_F(Node, HeartbeatHasTheFaultWordTenTimesASecond) {
  steps(1000);
  EXPECT_NEAR(static_cast<double>(sent(0x705).size()), 10.0, 1.0);
  io.estop = true;
  io.encoder = Quality::kMissing;
  steps(150);
  const CanFrame last = sent(0x705).back();
  EXPECT_EQ(last.size, 8);
  EXPECT_EQ(last.data[0], 0) << "disarmed";
  const std::uint32_t faults = little_endian(last, 2);
  EXPECT_EQ(faults, (1U << 9U) | (1U << 2U)) << "emergency stop and missing sensor, by their numbers";
  EXPECT_EQ(static_cast<std::uint8_t>(last.data[7] - sent(0x705).front().data[7]), sent(0x705).size() - 1);
}

TEST_F(Node, HeartbeatNamesTheStateAndTheFirstFault) {
  EXPECT_NE(ask("arm").find("ok"), std::string::npos);
  steps(120);
  EXPECT_EQ(sent(0x705).back().data[0], static_cast<int>(State::kHolding));
  io.estop = true;
  steps(120);
  EXPECT_EQ(sent(0x705).back().data[0], static_cast<int>(State::kFaulted));
  EXPECT_EQ(sent(0x705).back().data[1], 9);
}

TEST_F(Node, TelemetryOfEveryAxisComesAHundredTimesASecond) {
  for (std::size_t axis = 0; axis < 4; ++axis) {
    io.motors[axis].angle_rad = 0.1 * static_cast<double>(axis + 1);
  }
  steps(1000);
  for (std::size_t axis = 0; axis < 4; ++axis) {
    const auto frames = sent(static_cast<std::uint16_t>(0x185 + 0x100 * axis));
    EXPECT_NEAR(static_cast<double>(frames.size()), 100.0, 2.0);
    const auto raw = static_cast<std::int32_t>(little_endian(frames.back(), 0));
    EXPECT_NEAR(Q24::from_raw(raw).to_double(), 0.1 * static_cast<double>(axis + 1), 2e-4);
    EXPECT_EQ(frames.back().data[6], 0x80) << "a valid angle and no limit";
  }
  EXPECT_EQ(troubles.count(CanTrouble::kSendFull), 0U);
}

TEST_F(Node, CurrentIsInMilliampereWithItsSign) {
  io.current_shift_a = -0.25;
  steps(50);
  const CanFrame last = sent(0x185).back();
  EXPECT_NEAR(static_cast<std::int16_t>(last.data[4] | last.data[5] << 8U), -250, 1);
}

TEST_F(Node, ShellReadsAndSetsParameters) {
  EXPECT_NE(ask("version").find("board on_can joints 4"), std::string::npos);
  EXPECT_NE(ask("set joint2.control.kp 0.35").find("ok"), std::string::npos);
  EXPECT_NE(ask("get joint2.control.kp").find("0.35"), std::string::npos);
  EXPECT_NE(ask("move joint0 0.2").find("error not_armed"), std::string::npos);
}

TEST_F(Node, LongAnswerComesWholeAndInOrder) {
  const std::string help = ask("help");
  steps(3000);
  std::string text;
  std::uint8_t expected = sent(0x585).front().data[0];
  for (const CanFrame& frame : sent(0x585)) {
    EXPECT_EQ(frame.data[0], expected++);
    text.append(frame.data.begin() + 1, frame.data.begin() + frame.size);
  }
  EXPECT_GT(text.size(), 1000U);
  EXPECT_NE(text.find("version"), std::string::npos);
  EXPECT_EQ(text.substr(text.size() - 4), "ok\r\n") << text.substr(text.size() - 40);
}

TEST_F(Node, LineWithALostFrameIsRefusedAndTheNextIsFine) {
  CanFrame frame{.id = 0x605, .size = 8, .data = {41, 's', 'e', 't', ' ', 'j', 'o', 'i'}};
  chip.arrive(frame);
  step();
  sequence = 42;  // frame 42 is lost
  EXPECT_NE(ask("nt0.control.kp 3").find("error not_text"), std::string::npos);
  EXPECT_EQ(troubles.count(CanTrouble::kShellLost), 1U);
  EXPECT_NE(ask("version").find("ok"), std::string::npos);
}

TEST_F(Node, DuplicateShellFrameIsTakenOnce) {
  EXPECT_NE(ask("version").find("ok"), std::string::npos);
  CanFrame frame{.id = 0x605, .size = 8, .data = {++sequence, 'v', 'e', 'r', 's', 'i', 'o', 'n'}};
  chip.arrive(frame);
  chip.arrive(frame);
  step();
  EXPECT_NE(ask("").find("board on_can"), std::string::npos);
  EXPECT_EQ(troubles.count(CanTrouble::kShellDuplicate), 1U);
  CanFrame end{.id = 0x605, .size = 2, .data = {++sequence, '\r'}};
  chip.arrive(end);
  end.data[2] = 7;  // what an earlier frame left in the mailbox
  chip.arrive(end);
  steps(40);
  EXPECT_EQ(troubles.count(CanTrouble::kShellDuplicate), 2U);
}

TEST_F(Node, DisarmOfANewHostIsTakenWhateverNumberItBeginsWith) {
  const auto from = [this](std::uint8_t number, const std::string& line) {
    CanFrame frame{.id = 0x605, .size = 1, .data = {number}};
    for (const char c : line) {
      frame.data.at(frame.size++) = static_cast<std::uint8_t>(c);
    }
    chip.arrive(frame);
    steps(40);
  };
  from(2, "arm\r");
  ASSERT_TRUE(io.has_torque());
  from(2, "disarm\r");
  EXPECT_FALSE(io.has_torque()) << "the number is that of the last host's frame";
  from(3, "arm\r");
  from(4, "disarm\r");
  ASSERT_TRUE(application.post({.kind = Request::Kind::kArm}));  // over the other console
  steps(40);
  ASSERT_TRUE(io.has_torque());
  from(4, "disarm\r");
  EXPECT_FALSE(io.has_torque()) << "the whole frame is that of the last host";
}

TEST_F(Node, OtherLineOfANewHostWithTheLastNumberIsRefusedAsAWhole) {
  EXPECT_NE(ask("version").find("ok"), std::string::npos);
  --sequence;
  EXPECT_NE(ask("set joint0.control.kp 3").find("error not_text"), std::string::npos);
  EXPECT_NE(ask("version").find("ok"), std::string::npos);
}

TEST_F(Node, ShellFrameOfAWrongLengthIsNotTaken) {
  for (const std::uint8_t size : std::initializer_list<std::uint8_t>{0, 1, 9, 15}) {
    chip.arrive({.id = 0x605, .size = size, .data = {1, 'x'}});
    step();
  }
  EXPECT_EQ(troubles.count(CanTrouble::kShellLength), 4U);
}

TEST_F(Node, HostThatDoesNotWaitIsToldAndDamagesNoOtherLine) {
  static_cast<void>(ask("log joint0 1000000 1000"));  // the shell is busy with it until Ctrl-C
  for (int i = 0; i < 60; ++i) {
    chip.arrive({.id = 0x605, .size = 8, .data = {++sequence, 's', 'a', 'v', 'e', ' ', ' ', ' '}});
    step();
  }
  EXPECT_GT(troubles.count(CanTrouble::kShellCrowded), 0U);
  EXPECT_EQ(troubles.count(CanTrouble::kShellLost), 0U);
  static_cast<void>(ask("\x03"));
  EXPECT_NE(ask("version").find("ok"), std::string::npos);
}

TEST_F(Node, DisarmOfAHostThatDoesNotWaitTakesTheTorque) {
  ASSERT_NE(ask("arm").find("ok"), std::string::npos);
  static_cast<void>(ask("log joint0 1000000 1000"));
  for (int i = 0; i < 60; ++i) {
    chip.arrive({.id = 0x605, .size = 8, .data = {++sequence, 's', 'a', 'v', 'e', ' ', ' ', '\n'}});
    step();
  }
  ASSERT_TRUE(io.has_torque());
  chip.arrive({.id = 0x605, .size = 8, .data = {++sequence, 'd', 'i', 's', 'a', 'r', 'm', '\n'}});
  step();
  step();
  EXPECT_FALSE(io.has_torque());
}

TEST_F(Node, StreamMovesTheJointAndItsEndTakesTheTorqueWithinATenthOfASecond) {
  ASSERT_NE(ask("arm").find("ok"), std::string::npos);
  std::uint8_t number = 0;
  for (int i = 0; i < 500; ++i) {
    chip.arrive(setpoint(1, number++, 0.3 * std::min(1.0, i / 400.0)));
    step();
  }
  EXPECT_NEAR(application.axis_telemetry(1).q2_rad.to_double(), 0.3, 0.05);
  EXPECT_NEAR(application.axis_telemetry(0).q2_rad.to_double(), 0.0, 0.01);
  EXPECT_TRUE(io.has_torque());
  int silent = 0;
  while (io.has_torque() && silent < 300) {
    step();
    ++silent;
  }
  // Cycles from the one that took the last setpoint; that one may have waited for one more.
  EXPECT_EQ(silent, 98);
  EXPECT_EQ(application.telemetry().first_fault, Fault::kLinkLost);
  for (int i = 0; i < 300; ++i) {  // a sender that comes back finds no torque
    chip.arrive(setpoint(1, number++, 0.0));
    step();
  }
  EXPECT_FALSE(io.has_torque());
}

TEST_F(Node, StreamWithoutTorqueMovesNothing) {
  std::uint8_t number = 0;
  for (int i = 0; i < 200; ++i) {
    chip.arrive(setpoint(0, number++, 0.5));
    step();
  }
  EXPECT_EQ(state(), State::kDisarmed);
  EXPECT_FALSE(io.has_torque());
}

TEST_F(Node, BusOffTakesTheTorqueOfWhoeverCameOverTheBus) {
  ASSERT_NE(ask("arm").find("ok"), std::string::npos);
  ASSERT_TRUE(io.has_torque());
  chip.go_bus_off();
  steps(2);
  EXPECT_FALSE(io.has_torque()) << "within two cycles";
  steps(110);
  chip.bus_is_idle();
  steps(10);
  EXPECT_FALSE(io.has_torque()) << "the bus is back, the torque is not";
  EXPECT_NE(report().find("can bus_off 1: "), std::string::npos) << report();
  EXPECT_NE(report().find("on the bus"), std::string::npos);
  EXPECT_NE(ask("version").find("ok"), std::string::npos);
}

TEST_F(Node, BusOffOfABusThatNobodyUsesDisturbsNothing) {
  ASSERT_TRUE(application.post({.kind = Request::Kind::kArm}));
  steps(5);
  ASSERT_TRUE(io.has_torque());
  chip.go_bus_off();
  steps(300);
  EXPECT_TRUE(io.has_torque());
}

TEST_F(Node, PulledCableTakesTheTorqueOfWhoeverCameOverTheBus) {
  ASSERT_NE(ask("arm").find("ok"), std::string::npos);
  ASSERT_NE(ask("move joint0 0.2 rad").find("ok"), std::string::npos);
  bus_works = false;
  int held = 0;
  while (io.has_torque() && held < 1000) {
    step();
    ++held;
  }
  EXPECT_LE(held, 150);
  EXPECT_NE(report().find("can alone 1: "), std::string::npos) << report();
  EXPECT_FALSE(port.bus_off()) << "a bus without acknowledges makes no controller leave it";
  ASSERT_TRUE(application.post({.kind = Request::Kind::kArm}));  // over the other console
  steps(500);
  EXPECT_TRUE(io.has_torque()) << "the same loss does not count twice";
  bus_works = true;
  steps(100);
  EXPECT_NE(ask("version").find("ok"), std::string::npos);
  bus_works = false;
  steps(150);
  EXPECT_FALSE(io.has_torque()) << "the next one does";
}

TEST_F(Node, PulledCableClosesWhatItsHostHadOpenedBegunAndTaken) {
  ASSERT_NE(ask("maintenance open").find("ok"), std::string::npos);
  ASSERT_NE(ask("begin").find("ok"), std::string::npos);
  ASSERT_NE(ask("frames 50 joint0.q2").find("ok"), std::string::npos);
  bus_works = false;
  steps(300);
  const int someone = 0;
  EXPECT_FALSE(application.staging(&someone).empty()) << "the other console may set parameters";
  EXPECT_TRUE(application.recorder().start(&someone, {.signals = {find_signal("joint0.q1", 4)}, .count = 1}))
      << "and record";
  bus_works = true;
  steps(200);
  EXPECT_EQ(ask("maintenance").find("open for"), std::string::npos) << "the next host has to open it itself";
}

TEST_F(Node, BusThatIsBusyForAWhileIsNotTakenForAPulledCable) {
  ASSERT_NE(ask("arm").find("ok"), std::string::npos);
  for (int i = 0; i < 20; ++i) {
    bus_works = false;
    steps(80);
    bus_works = true;
    steps(1);
  }
  EXPECT_TRUE(io.has_torque());
  EXPECT_EQ(port.errors().alone, 0U);
}

TEST_F(Node, PulledCableThatNobodyUsedDisturbsNothing) {
  ASSERT_TRUE(application.post({.kind = Request::Kind::kArm}));
  bus_works = false;
  steps(500);
  EXPECT_TRUE(io.has_torque());
}

TEST_F(Node, BusWithoutAnotherNodeIsReportedAndTheFirmwareGoesOn) {
  bus_works = false;
  steps(500);
  EXPECT_GT(troubles.count(CanTrouble::kSendLost), 0U);
  EXPECT_NE(report().find("no node acknowledged"), std::string::npos) << report();
  EXPECT_EQ(application.telemetry().tick, 500U);
  bus_works = true;
  steps(200);
  EXPECT_GT(sent(0x705).size(), 0U);
}

TEST_F(Node, EveryCounterOfTheControllerReachesTheReportWithItsSentence) {
  for (std::uint8_t i = 0; i < 5; ++i) {
    chip.arrive(setpoint(0, i, 0.0));  // five before one interrupt
  }
  chip.deliver(1, {.id = 0x605, .size = 8}, 4U);
  chip.registers.esr.value = stm32f4::can::kEsrPassive;
  step();
  for (const char* name : {"fifo_overrun 1", "foreign 1", "error_passive 1"}) {
    EXPECT_NE(report().find(std::string("can ") + name + ": "), std::string::npos) << report();
  }
}

TEST_F(Node, RefusedFramesShowInTheHeartbeat) {
  steps(150);
  const int before = sent(0x705).back().data[6];
  CanFrame bad = setpoint(0, 1, 0.0);
  bad.data[7] ^= 1;
  chip.arrive(bad);
  steps(110);
  EXPECT_EQ(sent(0x705).back().data[6], before + 1);
}

}  // namespace
}  // namespace capstan::stm32f405
