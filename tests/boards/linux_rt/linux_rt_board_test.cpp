// SPDX-License-Identifier: Apache-2.0
#include "boards/linux_rt/linux_rt_board.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>

#include "boards/common/file_banks.hpp"

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
static_assert(JointIo<CountedIo<StillIo>>);

TEST(CountedIo, AddsTheOverrunsAndPassesEverythingElseOn) {
  StillIo still;
  CountedIo<StillIo> io(still);
  Sensed<1> sensed;
  io.rt_set_overruns(12);
  EXPECT_EQ(io.read(sensed), Status::kTimeout);
  EXPECT_EQ(sensed.overruns, 12U);
  EXPECT_EQ(sensed.axis[0].encoder_counts, 7);
  EXPECT_EQ(io.write({}), Status::kOk);
  io.release();
  EXPECT_EQ(still.releases, 1);
}

TEST(LinuxRtBoard, RunsTheFirmwareAndCountsWhatItRan) {
  FileBanks banks = FileBanks::temporary();
  LinuxRtBoard board({}, banks);
  EXPECT_FALSE(board.running());
  board.start();
  EXPECT_TRUE(eventually([&] { return board.application().telemetry().tick >= 20; }));
  EXPECT_TRUE(board.running());
  const RtReport report = board.stop();
  EXPECT_FALSE(board.running());
  EXPECT_EQ(board.application().telemetry().tick, report.cycles);
  EXPECT_GE(report.overruns, board.application().telemetry().overruns)
      << "the firmware is told of every one but the last";
}

TEST(LinuxRtBoard, StoppingTakesTheTorqueAway) {
  FileBanks banks = FileBanks::temporary();
  LinuxRtBoard board({}, banks);
  board.start();
  // A loaded machine may miss cycles, and the firmware then rightly drops the torque: ask until it holds.
  EXPECT_TRUE(eventually([&] {
    board.application().post({.kind = Request::Kind::kDisarm});
    static_cast<void>(eventually([&] { return board.application().settled(); }));
    board.application().post({.kind = Request::Kind::kArm});
    static_cast<void>(eventually([&] { return board.application().settled(); }));
    return energised(board.application().telemetry().state);
  }));
  static_cast<void>(board.stop());
  EXPECT_FALSE(energised(board.application().telemetry().state));
}

TEST(LinuxRtBoard, AMachineThatDoesNotGrantWhatIsInsistedOnIsAnError) {
  FileBanks banks = FileBanks::temporary();
  LinuxRtBoard board({.insist = true}, banks);  // this program has not locked its memory
  board.start();
  EXPECT_TRUE(eventually([&] { return !board.running(); }));
  EXPECT_THROW(static_cast<void>(board.stop()), std::runtime_error);
}

}  // namespace
}  // namespace capstan
