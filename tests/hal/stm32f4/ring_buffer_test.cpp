// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/stm32f4/ring_buffer.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace capstan {
namespace {

TEST(RingBuffer, GivesBytesBackInOrderOverManyTurns) {
  RingBuffer<8> ring;
  std::uint8_t next_in = 0;
  std::uint8_t next_out = 0;
  for (int round = 0; round < 1000; ++round) {
    for (int i = 0; i < 5; ++i) {
      ASSERT_TRUE(ring.push(next_in++));
    }
    for (int i = 0; i < 5; ++i) {
      std::uint8_t byte = 0;
      ASSERT_TRUE(ring.pop(byte));
      ASSERT_EQ(byte, next_out++);
    }
  }
  EXPECT_EQ(ring.size(), 0U);
}

TEST(RingBuffer, TakesExactlyItsCapacityAndRefusesTheNext) {
  RingBuffer<4> ring;
  for (std::uint8_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(ring.push(i));
  }
  EXPECT_EQ(ring.free(), 0U);
  EXPECT_FALSE(ring.push(9));
  std::uint8_t byte = 0;
  ASSERT_TRUE(ring.pop(byte));
  EXPECT_EQ(byte, 0);
  EXPECT_TRUE(ring.push(4));
}

TEST(RingBuffer, EmptyRingLeavesTheByteAlone) {
  RingBuffer<4> ring;
  std::uint8_t byte = 77;
  EXPECT_FALSE(ring.pop(byte));
  EXPECT_EQ(byte, 77);
}

TEST(RingBuffer, TwoThreadsLoseNothingAndKeepTheOrder) {
  RingBuffer<16> ring;
  constexpr int kBytes = 200'000;
  std::thread writer([&ring] {
    for (int i = 0; i < kBytes;) {
      if (ring.push(static_cast<std::uint8_t>(i & 0xFF))) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  int wrong = 0;
  for (int i = 0; i < kBytes;) {
    std::uint8_t byte = 0;
    if (ring.pop(byte)) {
      wrong += byte == static_cast<std::uint8_t>(i & 0xFF) ? 0 : 1;
      ++i;
    } else {
      std::this_thread::yield();
    }
  }
  writer.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace capstan
