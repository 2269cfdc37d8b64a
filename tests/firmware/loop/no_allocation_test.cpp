// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>

#include "capstan/tests/firmware/loop/allocation_watch.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using test::Watch;
using FakeIo = test::FakeIo<4>;
using Firmware = Application<FakeIo>;

struct Rig {
  test::FlashBanks banks;
  FakeIo io;
  Firmware application{io, banks};

  auto allocations_of(int ticks, const Firmware::Streamed& streamed = {}) -> long {
    const Watch watch;
    for (int i = 0; i < ticks; ++i) {
      application.rt_tick(streamed);
    }
    return watch.count();
  }
};

TEST(NoAllocation, TheWatchItselfSeesNewMallocAndTheStandardLibrary) {
  ASSERT_TRUE(kHooked);
  const Watch watch;
  long before = watch.count();
  auto* number = new int(3);
  EXPECT_GT(watch.count(), before);
  delete number;
  before = watch.count();
  void* memory = std::malloc(100);
  EXPECT_NE(memory, nullptr);
  EXPECT_GT(watch.count(), before);
  std::free(memory);
  before = watch.count();
  const std::string text(1000, 'x');
  EXPECT_GT(watch.count(), before) << text.size();
}

TEST(NoAllocation, NotInAnyCycleAtRestArmedMovingHoldingOrFaulted) {
  Rig rig;
  EXPECT_EQ(rig.allocations_of(1000), 0) << "disarmed";
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kArm}));
  EXPECT_EQ(rig.allocations_of(1000), 0) << "arming and holding";
  ASSERT_EQ(rig.application.telemetry().state, State::kHolding);
  for (std::uint8_t axis = 0; axis < 4; ++axis) {
    ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kMove,
                                      .axis = axis,
                                      .position_rad = Q24::from_int(1),
                                      .speed_rad_s = Q24::from_int(2)}));
    EXPECT_EQ(rig.allocations_of(100), 0) << "moving";
  }
  ASSERT_EQ(rig.application.telemetry().state, State::kMoving);
  ASSERT_TRUE(rig.application.recorder().start(&rig, {.signals = {find_signal("joint2.q1", 4)}, .count = 1}));
  EXPECT_EQ(rig.allocations_of(3000), 0) << "recording, and dropping what nobody fetches";
  Firmware::Streamed streamed{};
  streamed.fill({.kind = Request::Kind::kFollow, .position_rad = Q24::from_double(0.3)});
  EXPECT_EQ(rig.allocations_of(1000, streamed), 0) << "following";
  EXPECT_EQ(rig.allocations_of(1000), 0) << "link lost";
  ASSERT_EQ(rig.application.telemetry().first_fault, Fault::kLinkLost);
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kDisarm}));
  EXPECT_EQ(rig.allocations_of(1000), 0) << "disarming";
}

TEST(NoAllocation, NotInTheCyclesOfAnyFault) {
  for (int fault = 0; fault < 8; ++fault) {
    Rig rig;
    rig.application.rt_tick();
    ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kArm}));
    EXPECT_EQ(rig.allocations_of(10), 0);
    rig.io.encoder = fault == 0 ? Quality::kMissing : Quality::kOk;
    rig.io.current = fault == 1 ? Quality::kInvalid : Quality::kOk;
    rig.io.encoder_shift = fault == 2 ? 100'000 : 0;
    rig.io.estop = fault == 3;
    rig.io.overruns = fault == 4 ? 100 : 0;
    rig.io.read_status = fault == 5 ? Status::kFailed : Status::kOk;
    rig.io.write_status = fault == 6 ? Status::kFailed : Status::kOk;
    rig.io.current_shift_a = fault == 7 ? 5.0 : 0.0;
    EXPECT_EQ(rig.allocations_of(100), 0) << "fault " << fault;
    EXPECT_FALSE(energised(rig.application.telemetry().state)) << "fault " << fault;
  }
}

TEST(NoAllocation, NotInTheCycleThatTakesANewModel) {
  Rig rig;
  rig.application.rt_tick();
  const Config<4> config = {test::lossy_config(), test::distinct_config(1), test::distinct_config(2),
                            test::distinct_config(3)};
  ASSERT_TRUE(rig.application.configure(config, Rights::kMaintenance).taken());
  EXPECT_EQ(rig.allocations_of(10), 0);
  EXPECT_TRUE(rig.application.requests_taken());
}

/// Answers go nowhere, so that only the shell's own doing counts.
class NullSink final : public TextSink {
  void do_write(std::string_view /*text*/) override {}
};

TEST(NoAllocation, NotInTheShellOrTheStorageEither) {
  Rig rig;
  NullSink sink;
  test::FakeBoard board;
  Shell shell(rig.application, sink, board, true);
  const Watch watch;
  for (const std::string_view line : {"help",
                                      "status",
                                      "faults",
                                      "list",
                                      "dump",
                                      "diff",
                                      "get joint3.control.kp",
                                      "begin",
                                      "set joint0.control.kp 0.5",
                                      "commit",
                                      "arm",
                                      "move joint1 20 deg",
                                      "log joint0 5",
                                      "disarm",
                                      "nonsense",
                                      "set joint0.control.kp 1e9",
                                      "version",
                                      "model",
                                      "timing",
                                      "scope channels joint0.q2 joint3.drive",
                                      "scope start 50",
                                      "scope dump",
                                      "watch 20 joint0.q2",
                                      "zero joint0",
                                      "maintenance open",
                                      "arm",
                                      "experiment joint0 multisine duration=20 repeats=1",
                                      "\x03",
                                      "disarm"}) {
    for (const char c : line) {
      shell.receive(c);
    }
    shell.receive('\r');
    for (int i = 0; i < 100 && shell.busy(); ++i) {
      rig.application.rt_tick();
      shell.poll();
    }
  }
  const bool saved = rig.application.save();
  const LoadResult result = rig.application.load();
  EXPECT_EQ(watch.count(), 0);
  EXPECT_TRUE(saved);
  EXPECT_EQ(result, LoadResult::kLoaded);
}

}  // namespace
}  // namespace capstan
