// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/plant_link/plant_link_io.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "capstan/hal/plant_link/plant_server.hpp"

namespace capstan::plant_link {
namespace {

/// Time passes with every look at the clock.
struct Clock {
  [[nodiscard]] auto now() const noexcept -> std::uint32_t { return time += 10; }
  mutable std::uint32_t time = 0xFFFF'FF00;  // wraps early in every test
};

/// A joint that counts its steps and reads back what it was told.
struct CountingJoint {
  static constexpr std::size_t kAxes = 1;
  auto read(Sensed<1>& in) noexcept -> Status {
    in = {};
    in.axis[0] = {
        .encoder_counts = steps, .current_a = last.axis[0].current_a, .encoder = Quality::kOk, .current = Quality::kOk};
    in.estop = estop;
    return Status::kOk;
  }
  auto write(const Drive<1>& out) noexcept -> Status {
    ++steps;
    last = out;
    return Status::kOk;
  }
  void release() noexcept {
    ++releases;
    last = {};
  }
  int steps = 0;
  int releases = 0;
  bool estop = false;
  Drive<1> last;
};

/// A line with the plant's end of the protocol behind it, which the test can hush.
class PlantLine {
 public:
  auto read(std::uint8_t& byte) noexcept -> bool {
    if (to_board.empty()) {
      return false;
    }
    byte = to_board.front();
    to_board.pop_front();
    return true;
  }
  auto write_free() noexcept -> std::size_t { return room; }
  auto write(std::span<const std::uint8_t> bytes) noexcept -> std::size_t {
    PlantServer<CountingJoint>::Answer answer;
    for (const std::uint8_t byte : bytes) {
      if (server.take(byte, answer) && answers) {
        to_board.insert(to_board.end(), answer.view().begin(), answer.view().end());
      }
    }
    return bytes.size();
  }
  void send(const SensedFrame<1>& frame) {
    const auto wire = encode(frame);
    to_board.insert(to_board.end(), wire.view().begin(), wire.view().end());
  }

  CountingJoint joint;
  PlantServer<CountingJoint> server{joint};
  std::deque<std::uint8_t> to_board;
  std::size_t room = 256;
  bool answers = true;
};

class PlantLink : public testing::Test {
 protected:
  static constexpr std::uint32_t kPatience = 500;
  PlantLink() { io.start(); }
  auto cycle() -> Status {
    const Status status = io.read(in);
    Drive<1> out;
    out.axis[0] = {.current_a = Q24::from_raw(in.axis[0].encoder_counts), .enabled = true};
    EXPECT_EQ(io.write(out), io.is_up() ? Status::kOk : Status::kFailed);
    return status;
  }

  PlantLine line;
  Clock clock;
  PlantLinkIo<PlantLine, Clock, 1> io{line, clock, kPatience};
  Sensed<1> in;
};
static_assert(JointIo<PlantLinkIo<PlantLine, Clock, 1>>);

TEST_F(PlantLink, PlantAdvancesExactlyOneStepForEachCycle) {
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(cycle(), Status::kOk);
    ASSERT_EQ(in.axis[0].encoder_counts, i) << "the first snapshot is from before any step";
    ASSERT_EQ(in.axis[0].encoder, Quality::kOk);
  }
  EXPECT_EQ(line.joint.steps, 100);
  EXPECT_EQ(line.server.steps(), 100U);
  EXPECT_EQ(io.counters().answered, 100U);
  EXPECT_EQ(io.counters().missed, 0U);
  EXPECT_TRUE(io.is_up());
}

TEST_F(PlantLink, SetValueOfACycleIsWhatThePlantGets) {
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(cycle(), Status::kOk);
    EXPECT_TRUE(line.joint.last.axis[0].enabled);
    EXPECT_EQ(line.joint.last.axis[0].current_a.raw(), i);
  }
}

TEST_F(PlantLink, FrameThatDoesNotComeIsMissingAfterTheBoundAndNeverTheOldValue) {
  ASSERT_EQ(cycle(), Status::kOk);
  line.answers = false;
  ASSERT_EQ(cycle(), Status::kOk);  // its frame was on the way already
  const std::uint32_t before = clock.time;
  EXPECT_EQ(io.read(in), Status::kTimeout);
  EXPECT_EQ(in.axis[0].encoder, Quality::kMissing);
  EXPECT_EQ(in.axis[0].current, Quality::kMissing);
  EXPECT_EQ(in.axis[0].encoder_counts, 0);
  const std::uint32_t waited = clock.time - before;
  EXPECT_GE(waited, kPatience);
  EXPECT_LE(waited, kPatience + 50);
}

TEST_F(PlantLink, LateFrameIsCountedAndNotUsedInALaterCycle) {
  ASSERT_EQ(cycle(), Status::kOk);
  line.answers = false;
  ASSERT_EQ(cycle(), Status::kOk);
  SensedFrame<1> late{.sequence = 2};  // of the drive frame the second cycle sent
  late.axis[0].encoder = Quality::kOk;
  ASSERT_EQ(cycle(), Status::kTimeout);
  line.send(late);
  EXPECT_EQ(cycle(), Status::kTimeout);
  EXPECT_EQ(in.axis[0].encoder, Quality::kMissing);
  EXPECT_EQ(io.counters().stale, 1U);
}

TEST_F(PlantLink, GoesDownAfterThreeSilentCyclesAndComesBackWithThePlantWhereItStood) {
  ASSERT_EQ(cycle(), Status::kOk);
  line.answers = false;
  ASSERT_EQ(cycle(), Status::kOk);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(io.is_up());
    ASSERT_EQ(cycle(), Status::kTimeout);
  }
  EXPECT_FALSE(io.is_up());
  EXPECT_FALSE(line.joint.last.axis[0].enabled) << "the bridges are off when the link is down";
  const int steps = line.joint.steps;
  for (int i = 0; i < 50; ++i) {
    ASSERT_EQ(cycle(), Status::kTimeout);
  }
  EXPECT_EQ(line.joint.steps, steps) << "a link that is down asks, it does not advance the plant";
  line.answers = true;
  ASSERT_EQ(cycle(), Status::kTimeout);
  EXPECT_EQ(cycle(), Status::kOk);
  EXPECT_EQ(in.axis[0].encoder_counts, steps);
  EXPECT_TRUE(io.is_up());
}

TEST_F(PlantLink, BoardWithoutAPlantNeverWaits) {
  line.answers = false;
  line.to_board.clear();
  for (int i = 0; i < 20; ++i) {
    const std::uint32_t before = clock.time;
    ASSERT_EQ(io.read(in), Status::kTimeout);
    ASSERT_EQ(in.axis[0].encoder, Quality::kMissing);
    ASSERT_LE(clock.time - before, 30U);
    ASSERT_EQ(io.write({}), Status::kOk);
  }
  EXPECT_EQ(line.joint.steps, 0);
}

TEST_F(PlantLink, DrivingAPlantThatIsNotThereFails) {
  line.answers = false;
  line.to_board.clear();
  ASSERT_EQ(io.read(in), Status::kTimeout);
  Drive<1> out;
  out.axis[0].enabled = true;
  EXPECT_EQ(io.write(out), Status::kFailed);
  EXPECT_EQ(line.joint.steps, 0);
}

TEST_F(PlantLink, AnyAnswerToRepeatedQuestionsBringsTheLinkUp) {
  line.answers = false;
  line.to_board.clear();
  for (int i = 0; i < 5; ++i) {
    static_cast<void>(io.read(in));
    static_cast<void>(io.write({}));
  }
  line.send({.sequence = 0});  // the answer to the first of them, late
  EXPECT_EQ(io.read(in), Status::kOk);
}

TEST_F(PlantLink, DamagedFrameIsMissingAndCounted) {
  line.to_board[3] = static_cast<std::uint8_t>(line.to_board[3] ^ 0x10U);
  EXPECT_EQ(io.read(in), Status::kTimeout);
  EXPECT_EQ(in.axis[0].encoder, Quality::kMissing);
  EXPECT_EQ(io.counters().damaged, 1U);
}

TEST_F(PlantLink, RubbishOnTheLineCannotHoldTheCycle) {
  ASSERT_EQ(cycle(), Status::kOk);
  line.to_board.assign(100'000, 0x42);
  const std::uint32_t before = clock.time;
  EXPECT_EQ(io.read(in), Status::kTimeout);
  EXPECT_LE(clock.time - before, kPatience + 50);
}

TEST_F(PlantLink, ReleaseTurnsTheBridgeOffWithoutAStepOfThePlant) {
  ASSERT_EQ(cycle(), Status::kOk);
  const int steps = line.joint.steps;
  io.release();
  EXPECT_EQ(line.joint.steps, steps);
  EXPECT_EQ(line.joint.releases, 1);
  EXPECT_FALSE(line.joint.last.axis[0].enabled);
  EXPECT_EQ(cycle(), Status::kOk) << "the frame that was under way still counts";
}

TEST_F(PlantLink, LineWithoutRoomIsReportedAndNoHalfFrameIsSent) {
  line.room = 5;
  EXPECT_EQ(io.write({}), Status::kFailed);
  EXPECT_EQ(line.joint.steps, 0);
  EXPECT_EQ(io.counters().refused, 1U);
}

TEST_F(PlantLink, StopAndOverrunsAreHandedOn) {
  line.joint.estop = true;
  ASSERT_EQ(cycle(), Status::kOk);  // its frame was on the way already
  EXPECT_FALSE(in.estop);
  io.set_overruns(7);
  EXPECT_EQ(io.read(in), Status::kOk);
  EXPECT_TRUE(in.estop);
  EXPECT_EQ(in.overruns, 7U);
}

}  // namespace
}  // namespace capstan::plant_link
