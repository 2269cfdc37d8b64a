// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/stm32f405/can_setpoints.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/boards/stm32f405/can_frames.hpp"

namespace capstan::stm32f405 {
namespace {

class Setpoints : public testing::Test {
 protected:
  /// One cycle in which these frames came; true if `axis` got a reference.
  auto cycle(std::initializer_list<stm32f4::CanFrame> frames, std::size_t axis = 0) -> bool {
    setpoints.rt_begin_cycle();
    for (const stm32f4::CanFrame& frame : frames) {
      setpoints.rt_take(frame);
    }
    return setpoints.rt_streamed()[axis].kind == Request::Kind::kFollow;
  }
  [[nodiscard]] auto angle(std::size_t axis = 0) const -> double {
    return setpoints.rt_streamed()[axis].position_rad.to_double();
  }
  void pass(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      EXPECT_FALSE(cycle({}));
    }
  }
  /// A stream of axis 0 whose last number is `last`.
  void run_stream(std::uint8_t last) {
    cycle({setpoint(0, static_cast<std::uint8_t>(last - 1), 0.1)});
    ASSERT_TRUE(cycle({setpoint(0, last, 0.1)}));
  }
  /// That `trouble` was counted `count` times and nothing else was, but for the frame that began the stream.
  void expect_only(CanTrouble trouble, std::uint32_t count) {
    for (std::size_t i = 0; i < kCanTroubles.size(); ++i) {
      const auto one = static_cast<CanTrouble>(i);
      const std::uint32_t expected = one == trouble ? count : one == CanTrouble::kSetpointAlone ? 1 : 0;
      EXPECT_EQ(troubles.count(one), expected) << kCanTroubles.at(i).name;
    }
  }
  CanTroubleCounters troubles;
  CanSetpoints<4> setpoints{kTestNode, troubles};
};

TEST_F(Setpoints, StreamIsFollowedFromItsSecondFrameOn) {
  EXPECT_FALSE(cycle({setpoint(0, 10, 0.3)})) << "a stray frame moves nothing";
  EXPECT_TRUE(cycle({setpoint(0, 11, 0.31)}));
  EXPECT_NEAR(angle(), 0.31, 1e-7);
  EXPECT_TRUE(cycle({setpoint(0, 12, -0.32)}));
  EXPECT_NEAR(angle(), -0.32, 1e-7);
  EXPECT_FALSE(cycle({})) << "a reference is used once";
  expect_only(CanTrouble::kSetpointAlone, 1);
}

TEST_F(Setpoints, SequenceWrapsWithoutATrace) {
  run_stream(254);
  for (const std::uint8_t sequence : std::initializer_list<std::uint8_t>{255, 0, 1}) {
    EXPECT_TRUE(cycle({setpoint(0, sequence, 0.1)}));
  }
  expect_only(CanTrouble::kSetpointAlone, 1);
}

TEST_F(Setpoints, EveryAxisHasAStreamOfItsOwn) {
  cycle({setpoint(0, 1, 0.1), setpoint(1, 101, 0.2), setpoint(2, 201, 0.3), setpoint(3, 51, 0.4)});
  EXPECT_TRUE(cycle({setpoint(0, 2, 0.1), setpoint(1, 102, 0.2), setpoint(2, 202, 0.3), setpoint(3, 52, 0.4)}));
  for (std::size_t axis = 0; axis < 4; ++axis) {
    EXPECT_NEAR(angle(axis), 0.1 * static_cast<double>(axis + 1), 1e-7);
  }
}

TEST_F(Setpoints, WrongLengthIsNotUsed) {
  run_stream(5);
  for (const std::uint8_t size : std::initializer_list<std::uint8_t>{0, 1, 7, 9, 15}) {
    stm32f4::CanFrame frame = setpoint(0, 6, 0.5);
    frame.size = size;
    EXPECT_FALSE(cycle({frame}));
  }
  expect_only(CanTrouble::kSetpointLength, 5);
}

TEST_F(Setpoints, EveryFlippedBitIsFoundByTheChecksum) {
  run_stream(5);
  for (std::size_t bit = 0; bit < 64; ++bit) {
    stm32f4::CanFrame frame = setpoint(0, 6, 0.5);
    frame.data.at(bit / 8) ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_FALSE(cycle({frame})) << bit;
  }
  expect_only(CanTrouble::kSetpointChecksum, 64);
}

TEST_F(Setpoints, SetpointOfOneAxisDoesNotPassForAnothers) {
  run_stream(5);
  stm32f4::CanFrame frame = setpoint(1, 6, 0.5);
  frame.id = setpoint(0, 6, 0.5).id;
  EXPECT_FALSE(cycle({frame}));
  expect_only(CanTrouble::kSetpointChecksum, 1);
}

TEST_F(Setpoints, UnknownKindIsNotUsed) {
  run_stream(5);
  stm32f4::CanFrame frame = setpoint(0, 6, 0.5);
  frame.data[1] = 2;
  const std::uint16_t crc = setpoint_checksum(frame);
  frame.data[6] = static_cast<std::uint8_t>(crc);
  frame.data[7] = static_cast<std::uint8_t>(crc >> 8U);
  EXPECT_FALSE(cycle({frame}));
  expect_only(CanTrouble::kSetpointKind, 1);
}

TEST_F(Setpoints, DuplicateIsNotUsedTwice) {
  run_stream(5);
  EXPECT_TRUE(cycle({setpoint(0, 6, 0.5)}));
  EXPECT_FALSE(cycle({setpoint(0, 6, 0.5)}));
  expect_only(CanTrouble::kSetpointDuplicate, 1);
}

TEST_F(Setpoints, LateFrameIsNeverReplayed) {
  run_stream(50);
  for (const std::uint8_t sequence : std::initializer_list<std::uint8_t>{49, 40, 200, 178}) {
    EXPECT_FALSE(cycle({setpoint(0, sequence, 0.9)})) << int{sequence};
  }
  EXPECT_TRUE(cycle({setpoint(0, 51, 0.1)}));
  expect_only(CanTrouble::kSetpointLate, 4);
}

TEST_F(Setpoints, GapIsCountedInFramesAndTheStreamGoesOn) {
  run_stream(5);
  EXPECT_TRUE(cycle({setpoint(0, 9, 0.2)}));
  EXPECT_NEAR(angle(), 0.2, 1e-7);
  expect_only(CanTrouble::kSetpointLost, 3);
}

TEST_F(Setpoints, TwoInOneCycleLeaveTheNewest) {
  run_stream(5);
  EXPECT_TRUE(cycle({setpoint(0, 6, 0.2), setpoint(0, 7, 0.3)}));
  EXPECT_NEAR(angle(), 0.3, 1e-7);
  expect_only(CanTrouble::kSetpointCrowded, 1);
}

TEST_F(Setpoints, StreamThatWasSilentForATenthOfASecondBeginsAnew) {
  run_stream(5);
  pass(99);
  EXPECT_FALSE(cycle({setpoint(0, 6, 0.7)})) << "its first frame could be one that hung in a queue";
  EXPECT_TRUE(cycle({setpoint(0, 7, 0.7)}));
  expect_only(CanTrouble::kSetpointAlone, 2);
}

TEST_F(Setpoints, StreamThatWasSilentForLessGoesOn) {
  run_stream(5);
  pass(98);
  EXPECT_TRUE(cycle({setpoint(0, 6, 0.7)}));
}

TEST_F(Setpoints, StrayFramesWithoutOrderNeverMoveAnything) {
  for (const std::uint8_t sequence : std::initializer_list<std::uint8_t>{1, 77, 12, 200, 12, 44, 44}) {
    EXPECT_FALSE(cycle({setpoint(0, sequence, 1.0)})) << int{sequence};
  }
}

TEST_F(Setpoints, FrameThatIsNotItsOwnIsCounted) {
  run_stream(5);
  stm32f4::CanFrame frame = setpoint(0, 6, 0.5);
  frame.id = 0x123;
  EXPECT_FALSE(cycle({frame}));
  expect_only(CanTrouble::kUnexpected, 1);
}

TEST(CanSetpointsOfTwoAxes, DoNotHearTheOthers) {
  CanTroubleCounters troubles;
  const CanSetpoints<2> setpoints(kTestNode, troubles);
  EXPECT_EQ(setpoints.identifiers(), (std::array<std::uint16_t, 4>{0x205, 0x305, 0x305, 0x305}));
}

TEST(CanTroubleTable, EveryTroubleHasANameACauseAndACure) {
  for (const CanTroubleInfo& trouble : kCanTroubles) {
    EXPECT_GT(std::string_view(trouble.name).size(), 3U);
    EXPECT_GT(std::string_view(trouble.cause).size(), 20U) << trouble.name;
    EXPECT_GT(std::string_view(trouble.cure).size(), 10U) << trouble.name;
  }
}

}  // namespace
}  // namespace capstan::stm32f405
