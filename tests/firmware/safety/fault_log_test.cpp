// SPDX-License-Identifier: Apache-2.0
// The fault log over restarts: one firmware after the other on the same memory, as after a reset.
#include "capstan/firmware/safety/fault_log.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

constexpr std::size_t kAxes = 2;
using Io = test::FakeIo<kAxes>;
using test::has_line;
using test::lines_of;
using test::verdict;

/// A board whose firmware can be ended at any time and started again; only its memory lives on.
struct Board {
  Board() { start(); }
  void start() {
    shell.reset();
    application.reset();  // no destructor of it does anything about the log
    io = {};
    application = std::make_unique<Application<Io>>(io, banks, memory);
    shell = std::make_unique<Shell>(*application, sink, board, false);
    application->rt_tick();
  }
  void ticks(int count) {
    for (int i = 0; i < count; ++i) {
      application->rt_tick();
    }
  }
  auto say(const std::string& line) -> std::string {
    for (const char c : line + "\n") {
      shell->receive(c);
    }
    for (int i = 0; i < 5000 && shell->busy(); ++i) {
      application->rt_tick();
      shell->poll();
    }
    return sink.take();
  }
  /// Arms, lets some time pass and opens the emergency stop.
  void fault_after(int cycles) {
    say("arm");
    ticks(cycles);
    io.estop = true;
    ticks(1);
    io.estop = false;
  }
  auto log() -> FaultLog& { return application->fault_log(); }

  std::vector<std::uint32_t> memory = std::vector<std::uint32_t>(FaultLog::words_for(kAxes));
  test::FlashBanks banks;
  Io io;
  std::unique_ptr<Application<Io>> application;
  test::StringSink sink;
  test::FakeBoard board;
  std::unique_ptr<Shell> shell;
};

TEST(FaultLog, IsEmptyAtFirstWhateverPowerOnLeftInTheMemory) {
  std::mt19937 random(4);
  for (int i = 0; i < 100; ++i) {
    Board board;
    for (std::uint32_t& word : board.memory) {
      word = static_cast<std::uint32_t>(random());
    }
    board.start();
    EXPECT_EQ(board.log().count(), 0U);
    EXPECT_EQ(board.log().kept(), 0U);
    board.fault_after(100);
    EXPECT_EQ(board.log().entry(0).start, 1U);
  }
}

TEST(FaultLog, AMagicWithImpossibleIndicesIsNoLog) {
  for (const std::size_t head : {3U, 5U, 6U}) {
    Board board;
    board.fault_after(50);
    board.memory[head] = 100'000;
    board.start();
    EXPECT_EQ(board.log().count(), 0U) << head;
  }
}

TEST(FaultLog, AFaultIsThereAfterAResetWithAllThatWasKnown) {
  Board board;
  board.start();
  board.say("arm");
  board.say("move joint1 1");
  board.ticks(99);
  board.io.estop = true;
  board.ticks(1);
  const MachineTelemetry then = board.application->telemetry();
  board.start();
  ASSERT_EQ(board.log().count(), 1U);
  const FaultEntry entry = board.log().entry(0);
  EXPECT_EQ(entry.fault, Fault::kEmergencyStop);
  EXPECT_EQ(entry.state, State::kMoving);
  EXPECT_EQ(entry.start, 2U);
  EXPECT_EQ(entry.tick, then.tick);
  EXPECT_EQ(entry.conditions, bit(Fault::kEmergencyStop));
  EXPECT_EQ(entry.joints, 0U) << "the stop is the machine's";
}

TEST(FaultLog, TheJointThatShowedAFaultIsNamed) {
  Board board;
  board.say("arm");
  board.io.current_shift_a = 5.0;
  board.ticks(100);
  EXPECT_EQ(board.log().entry(0).joints, 3U);
  EXPECT_EQ(board.log().entry(0).fault, Fault::kOverCurrent);
}

TEST(FaultLog, ARunThatEndedBeforeItsFirstSampleKeepsNoSecondAndLeavesRoomForTheNext) {
  Board board;
  board.say("arm");
  board.ticks(3000);
  board.say("disarm");
  while (board.application->telemetry().tick % FaultLog::kEvery != 0) {
    board.ticks(1);
  }
  const std::uint32_t armed_at = board.application->telemetry().tick;
  ASSERT_TRUE(board.application->post({.kind = Request::Kind::kArm}));
  board.ticks(1);
  ASSERT_TRUE(energised(board.application->telemetry().state));
  board.start();  // the supply broke down in the first cycle of torque
  ASSERT_EQ(board.log().count(), 1U);
  EXPECT_EQ(board.log().entry(0).fault, Fault::kNone) << "that it ended under torque is told";
  EXPECT_NEAR(board.log().entry(0).tick, armed_at, 2) << "and when, not when the run before it ended";
  EXPECT_EQ(board.log().kept(), 0U);
  board.fault_after(2000);
  EXPECT_EQ(board.log().kept(), FaultLog::kSamples);
  EXPECT_EQ(board.log().kept_entry().fault, Fault::kEmergencyStop);
}

TEST(FaultLog, TheLastSecondIsKeptWithTheFaultsOwnCycleAtItsEnd) {
  Board board;
  board.say("arm");
  board.say("move joint0 1.5");
  std::vector<AxisTelemetry> seen;
  for (int i = 0; i < 2345; ++i) {
    board.ticks(1);
    seen.push_back(board.application->axis_telemetry(0));
  }
  board.io.estop = true;
  board.ticks(1);
  seen.push_back(board.application->axis_telemetry(0));
  const FaultEntry entry = board.log().entry(0);
  board.start();  // a reset between the fault and the reading
  ASSERT_EQ(board.log().kept(), FaultLog::kSamples);
  EXPECT_EQ(board.log().kept_entry().tick, entry.tick);
  for (std::size_t i = 0; i < FaultLog::kSamples; ++i) {
    const std::int32_t cycles = board.log().cycles_from_fault(i);
    const AxisTelemetry& then = seen[seen.size() - 1 - static_cast<std::size_t>(-cycles)];
    EXPECT_EQ(board.log().raw(i, 0, 0), then.q1_rad.raw() & ~0xFF) << cycles;
    EXPECT_EQ(board.log().raw(i, 0, 1), then.tau_nm.raw() & ~0xFF);
    EXPECT_EQ(board.log().raw(i, 0, 2), then.q2_rad.raw() & ~0xFF);
    EXPECT_EQ(board.log().raw(i, 0, 3), then.q2_reference_rad.raw() & ~0xFF);
    EXPECT_TRUE(i + 1 == FaultLog::kSamples ? cycles == 0 : cycles < 0);
  }
  EXPECT_LE(board.log().cycles_from_fault(0), -980);
  EXPECT_GE(board.log().cycles_from_fault(0), -1000);
}

TEST(FaultLog, AFirmwareThatEndsUnderTorqueLeavesItsLastSecond) {
  Board board;
  board.say("arm");
  board.ticks(500);
  board.start();  // by the watchdog
  ASSERT_EQ(board.log().count(), 1U);
  EXPECT_EQ(board.log().entry(0).fault, Fault::kNone);
  EXPECT_EQ(board.log().entry(0).start, 1U);
  EXPECT_NEAR(static_cast<double>(board.log().kept()), 50.0, 1.0);
  EXPECT_TRUE(has_line(board.say("faults"), "last start 1, 0 s: the firmware ended with torque on"));
  board.say("arm");
  board.say("disarm");
  board.start();
  EXPECT_EQ(board.log().count(), 1U) << "at rest a restart is no news";
}

TEST(FaultLog, AStateBeforeTheFirstCycleIsWithoutTorque) {
  Board board;
  board.say("arm");
  board.ticks(500);
  board.log().rt_step(MachineTelemetry{}, {});
  board.start();
  EXPECT_EQ(board.log().count(), 0U) << "so the torque had ended before the restart";
}

TEST(FaultLog, AnOperatorWhoDisarmsLeavesNothingAlsoOverARestart) {
  Board board;
  board.say("arm");
  board.ticks(300);
  board.say("disarm");
  EXPECT_EQ(board.log().count(), 0U);
  EXPECT_EQ(board.log().kept(), 0U);
  board.start();
  EXPECT_EQ(board.log().count(), 0U) << "the firmware did not end under torque";
  board.fault_after(300);
  EXPECT_GT(board.log().kept(), 0U) << "and the next second has room";
}

TEST(FaultLog, ASecondThatNobodyReadIsNotWrittenOverAndOneThatWasReadIs) {
  Board board;
  board.fault_after(300);
  board.say("disarm");
  board.fault_after(200);
  EXPECT_EQ(board.log().count(), 2U);
  EXPECT_EQ(board.log().kept_entry().tick, board.log().entry(1).tick) << "the first";
  EXPECT_NE(board.say("faults").find("'faults second' prints it"), std::string::npos);
  EXPECT_EQ(verdict(board.say("faults second")), "ok");
  EXPECT_EQ(verdict(board.say("faults second")).rfind("error nothing_kept: ", 0), 0U);
  board.say("disarm");
  board.fault_after(100);
  EXPECT_EQ(board.log().kept_entry().tick, board.log().entry(0).tick) << "the third";
  EXPECT_EQ(verdict(board.say("faults release")), "ok");
  EXPECT_EQ(board.log().kept(), 0U);
  EXPECT_EQ(board.log().count(), 3U);
}

TEST(FaultLog, OnlyTheLastEightAreListedNewestFirst) {
  Board board;
  for (int i = 1; i <= 20; ++i) {
    board.fault_after(10 * i);
    board.say("disarm");
  }
  EXPECT_EQ(board.log().count(), 20U);
  for (std::uint32_t age = 0; age + 1 < FaultLog::kEntries; ++age) {
    EXPECT_GT(board.log().entry(age).tick, board.log().entry(age + 1).tick);
  }
  const auto lines = lines_of(board.say("faults"));
  const auto listed = std::count_if(lines.begin(), lines.end(), [](const std::string& line) {
    return line.rfind("last start ", 0) == 0 || line.rfind("before start ", 0) == 0;
  });
  EXPECT_EQ(listed, 8);
}

TEST(FaultLog, TheSecondIsPrintedAsALogByTheContract) {
  Board board;
  board.fault_after(700);
  const auto lines = lines_of(board.say("faults second"));
  EXPECT_EQ(lines.front(),
            "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/q2_est_rad,axis0/q2_ref_rad,"
            "axis1/q1_rad,axis1/tau_Nm,axis1/q2_est_rad,axis1/q2_ref_rad");
  ASSERT_NEAR(static_cast<double>(lines.size()), 73.0, 1.0);
  double last = -1e9;
  for (std::size_t i = 1; i + 1 < lines.size(); ++i) {
    const double time = std::stod(lines[i]);
    EXPECT_GT(time, last);
    last = time;
    EXPECT_EQ(std::count(lines[i].begin(), lines[i].end(), ','), 8);
  }
  EXPECT_EQ(last, 0.0);
}

TEST(FaultLog, CancelWhilePrintingKeepsTheSecond) {
  Board board;
  board.fault_after(700);
  for (const char c : std::string("faults second\n")) {
    board.shell->receive(c);
  }
  board.shell->poll();
  board.shell->receive(0x03);
  board.shell->poll();
  EXPECT_FALSE(board.shell->busy());
  EXPECT_GT(board.log().kept(), 0U);
}

TEST(FaultLog, ARestartCoolsNoWinding) {
  Board board;
  const auto is_hot = [&board] { return (board.application->telemetry().conditions & bit(Fault::kWindingHot)) != 0; };
  board.io.current_shift_a = 3.0;  // through the winding, whoever drives it
  board.ticks(20'000);
  ASSERT_TRUE(is_hot());
  board.start();
  board.ticks(2);
  EXPECT_TRUE(is_hot());
  board.ticks(60'000);
  EXPECT_FALSE(is_hot());
  board.start();
  EXPECT_EQ(board.log().heat(0), Q24{}) << "it has cooled";
}

TEST(FaultLog, ARunThatEndsUnderTorqueLeavesAWindingThatCountsAsHot) {
  Board board;
  board.say("arm");
  board.ticks(10);
  board.start();
  EXPECT_EQ(board.log().heat(0), Q24::from_int(1));
  EXPECT_EQ(board.log().heat(1), Q24::from_int(1));
  EXPECT_EQ(board.application->telemetry().conditions, 0U) << "it may be armed";
  board.ticks(40'000);
  board.say("arm");
  board.say("disarm");
  board.ticks(2);
  board.start();
  EXPECT_EQ(board.log().heat(0), Q24{}) << "the operator's end is no surprise";
}

TEST(FaultLog, WithoutMemoryThereIsNoLogAndNothingElseChanges) {
  test::Bench<1> bench;
  bench.say("arm");
  bench.io.estop = true;
  bench.ticks(1);
  EXPECT_EQ(verdict(bench.say("faults")), "ok");
  EXPECT_EQ(verdict(bench.say("faults release")), "ok");
  EXPECT_EQ(verdict(bench.say("faults second")).rfind("error nothing_kept: ", 0), 0U);
  FaultLog& log = bench.application.fault_log();
  EXPECT_EQ(log.count(), 0U);
  EXPECT_EQ(log.entry(0).fault, Fault::kNone);
  EXPECT_EQ(log.kept_entry().fault, Fault::kNone);
}

TEST(FaultLog, AfterPowerOnAWindingCountsAsHotAndTheJointMayBeArmed) {
  for (const std::uint32_t left : {0U, 0x5A5A'5A5AU}) {
    Board board;
    std::fill(board.memory.begin(), board.memory.end(), left);
    board.start();
    EXPECT_EQ(board.log().heat(0), Q24::from_int(1));
    EXPECT_EQ(board.log().heat(1), Q24::from_int(1));
    EXPECT_EQ(board.application->telemetry().conditions, 0U);
    board.ticks(60'000);
    board.start();
    EXPECT_EQ(board.log().heat(0), Q24{}) << "it has cooled";
  }
}

TEST(FaultLog, ASecondThatAnotherConsoleReleasesEndsTheAnswer) {
  Board board;
  board.fault_after(700);
  for (const char c : std::string("faults second\n")) {
    board.shell->receive(c);
  }
  board.shell->poll();
  ASSERT_TRUE(board.shell->busy());
  board.log().release();
  board.shell->poll();
  EXPECT_FALSE(board.shell->busy());
  EXPECT_EQ(verdict(board.sink.take()), "ok");
}

}  // namespace
}  // namespace capstan
