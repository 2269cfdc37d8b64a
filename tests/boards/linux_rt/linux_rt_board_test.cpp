// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/linux_rt/linux_rt_board.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/boards/linux_rt/lined_io.hpp"
#include "capstan/firmware/loop/application.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

auto eventually(const std::function<bool()>& holds) -> bool {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!holds() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return holds();
}

/// Sensors that always read the same.
struct StillIo {
  static constexpr std::size_t kAxes = 1;
  int releases = 0;
  auto read(Sensed<kAxes>& sensed) noexcept -> Status {
    sensed.axis[0] = {.encoder_counts = 7, .current_a = {}, .encoder = Quality::kOk, .current = Quality::kOk};
    return Status::kTimeout;
  }
  auto write(const Drive<kAxes>& /*drive*/) noexcept -> Status { return Status::kOk; }
  void release() noexcept { ++releases; }
};
static_assert(JointIo<StillIo>);

/// Lines that remember what they were told.
struct FakeLines {
  struct Log {
    bool open = false;
    bool works = true;
    std::vector<bool> enabled;
    std::vector<bool> brake_open;
    int offs = 0;
  };
  Log* log;
  auto rt_estop() -> bool { return log->open; }
  auto rt_drive(bool enabled, bool brake_open) -> bool {
    log->enabled.push_back(enabled);
    log->brake_open.push_back(brake_open);
    return log->works;
  }
  void rt_off() { ++log->offs; }
};
static_assert(JointIo<LinedIo<StillIo, FakeLines>>);

TEST(LinedIo, AddsOverrunsAndEmergencyStopAndPassesEverythingElseOn) {
  StillIo still;
  FakeLines::Log log;
  LinedIo<StillIo, FakeLines> io(still, {&log});
  Sensed<1> sensed;
  io.rt_set_overruns(12);
  EXPECT_EQ(io.read(sensed), Status::kTimeout);
  EXPECT_EQ(sensed.overruns, 12U);
  EXPECT_FALSE(sensed.estop);
  EXPECT_EQ(sensed.axis[0].encoder_counts, 7);
  log.open = true;
  Sensed<1> stopped;
  static_cast<void>(io.read(stopped));
  EXPECT_TRUE(stopped.estop);
}

TEST(LinedIo, EnableFollowsTheDriveAndReleaseTurnsItOff) {
  StillIo still;
  FakeLines::Log log;
  LinedIo<StillIo, FakeLines> io(still, {&log});
  EXPECT_EQ(io.write({}), Status::kOk);
  Drive<1> on;
  on.axis[0].enabled = true;
  EXPECT_EQ(io.write(on), Status::kOk);
  EXPECT_EQ(log.enabled, (std::vector<bool>{false, true})) << "in every cycle, for the watchdog";
  io.release();
  EXPECT_EQ(log.offs, 1);
  EXPECT_EQ(still.releases, 1);
  log.works = false;
  EXPECT_EQ(io.write(on), Status::kFailed) << "a chip that does not take its lines is a failed drive";
}

/// Two amplifiers that follow or do not.
struct TwoIo {
  static constexpr std::size_t kAxes = 2;
  std::array<bool, 2> follows{};
  auto read(Sensed<kAxes>& sensed) noexcept -> Status {
    sensed.axis[0].follows = follows[0];
    sensed.axis[1].follows = follows[1];
    return Status::kOk;
  }
  auto write(const Drive<kAxes>& /*drive*/) noexcept -> Status { return Status::kOk; }
  void release() noexcept {}
};

TEST(LinedIo, BrakeIsOpenOnlyWhileEveryEnabledAmplifierFollows) {
  TwoIo two;
  FakeLines::Log log;
  LinedIo<TwoIo, FakeLines> io(two, {&log});
  const auto open = [&](bool enabled_0, bool enabled_1, std::array<bool, 2> follows) {
    two.follows = follows;
    Sensed<2> sensed;
    static_cast<void>(io.read(sensed));
    Drive<2> drive;
    drive.axis[0].enabled = enabled_0;
    drive.axis[1].enabled = enabled_1;
    EXPECT_EQ(io.write(drive), Status::kOk);
    EXPECT_EQ(log.enabled.back(), enabled_0 || enabled_1);
    return static_cast<bool>(log.brake_open.back());
  };
  EXPECT_FALSE(open(false, false, {true, true})) << "nobody holds the joints";
  EXPECT_FALSE(open(true, true, {false, false}));
  EXPECT_FALSE(open(true, true, {true, false})) << "the second joint would fall";
  EXPECT_TRUE(open(true, true, {true, true}));
  EXPECT_TRUE(open(true, false, {true, false})) << "the second one is not fitted";
  EXPECT_FALSE(open(true, true, {true, false})) << "one that stops to follow under torque";
}

TEST(LinedIo, BrakeOpensInTheCycleThatHoldsTheJointAndClosesInTheOneThatDoesNot) {
  test::FakeIo<1> drive;
  drive.cycles_to_follow = 180;
  FakeLines::Log log;
  LinedIo<test::FakeIo<1>, FakeLines> io(drive, {&log});
  test::FlashBanks banks;
  Application<LinedIo<test::FakeIo<1>, FakeLines>> application(io, banks);
  for (int i = 0; i < 5; ++i) {
    application.rt_tick();
  }
  application.post({.kind = Request::Kind::kArm});
  application.rt_tick();
  EXPECT_TRUE(log.enabled.back()) << "the drive needs it to get ready";
  for (int i = 0; application.telemetry().state != State::kHolding && i < 300; ++i) {
    ASSERT_FALSE(log.brake_open.back()) << "cycle " << i << " after arming";
    application.rt_tick();
  }
  ASSERT_EQ(application.telemetry().state, State::kHolding);
  EXPECT_TRUE(log.brake_open.back());
  application.post({.kind = Request::Kind::kDisarm});
  application.rt_tick();
  EXPECT_FALSE(log.brake_open.back());
}

TEST(LinuxRtBoard, RunsTheFirmwareAndCountsWhatItRan) {
  FileBanks banks = FileBanks::temporary();
  LinuxRtBoard board({}, simulated_joints(banks));
  EXPECT_FALSE(board.running());
  board.start();
  EXPECT_TRUE(eventually([&] { return board.machine().telemetry().tick >= 20; }));
  EXPECT_TRUE(board.running());
  const RtReport report = board.stop();
  EXPECT_FALSE(board.running());
  EXPECT_EQ(board.machine().telemetry().tick, report.cycles);
  EXPECT_GE(report.overruns, board.machine().telemetry().overruns) << "the firmware is told of every one but the last";
}

TEST(LinuxRtBoard, StoppingTakesTheTorqueAway) {
  FileBanks banks = FileBanks::temporary();
  LinuxRtBoard board({}, simulated_joints(banks));
  board.start();
  // A loaded machine may miss cycles, and the firmware then rightly drops the torque: ask until it holds.
  EXPECT_TRUE(eventually([&] {
    board.machine().post({.kind = Request::Kind::kDisarm});
    static_cast<void>(eventually([&] { return board.machine().requests_taken(); }));
    board.machine().post({.kind = Request::Kind::kArm});
    static_cast<void>(eventually([&] { return board.machine().requests_taken(); }));
    return energised(board.machine().telemetry().state);
  }));
  static_cast<void>(board.stop());
  EXPECT_FALSE(energised(board.machine().telemetry().state));
}

TEST(LinuxRtBoard, AMachineThatDoesNotGrantWhatIsInsistedOnIsAnError) {
  FileBanks banks = FileBanks::temporary();
  LinuxRtBoard board({.insist = true}, simulated_joints(banks));  // this program has not locked its memory
  board.start();
  EXPECT_TRUE(eventually([&] { return !board.running(); }));
  EXPECT_THROW(static_cast<void>(board.stop()), std::runtime_error);
}

}  // namespace
}  // namespace capstan
