// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/loop/exchange.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace capstan {
namespace {

TEST(Mailbox, HoldsOneValueUntilItIsTaken) {
  Mailbox<int> box;
  EXPECT_TRUE(box.empty());
  EXPECT_EQ(box.rt_peek(), nullptr);
  ASSERT_TRUE(box.offer(7));
  EXPECT_FALSE(box.offer(8)) << "the first has not been taken";
  ASSERT_NE(box.rt_peek(), nullptr);
  EXPECT_EQ(*box.rt_peek(), 7);
  EXPECT_FALSE(box.empty());
  box.rt_taken();
  EXPECT_TRUE(box.empty());
  EXPECT_TRUE(box.offer(8));
  EXPECT_EQ(*box.rt_peek(), 8);
}

/// Fields that must agree with each other; large enough not to be copied at once.
struct Agreeing {
  std::uint64_t first = 0;
  std::array<std::uint32_t, 40> rest{};
};

auto agreeing(std::uint64_t number) -> Agreeing {
  Agreeing value{.first = number};
  value.rest.fill(static_cast<std::uint32_t>(number * 2654435761U));
  return value;
}
auto agrees(const Agreeing& value) -> bool {
  for (const std::uint32_t word : value.rest) {
    if (word != static_cast<std::uint32_t>(value.first * 2654435761U)) {
      return false;
    }
  }
  return true;
}

TEST(Mailbox, ValuesCrossBetweenThreadsWholeAndInOrder) {
  constexpr std::uint64_t kValues = 2'000;
  Mailbox<Agreeing> box;
  std::thread writer([&box] {
    for (std::uint64_t i = 1; i <= kValues;) {
      if (box.offer(agreeing(i))) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  std::uint64_t last = 0;
  bool whole = true;
  bool in_order = true;
  while (last < kValues) {
    if (const Agreeing* value = box.rt_peek()) {
      whole = whole && agrees(*value);
      in_order = in_order && value->first == last + 1;
      last = value->first;
      box.rt_taken();
    } else {
      std::this_thread::yield();
    }
  }
  writer.join();
  EXPECT_TRUE(whole);
  EXPECT_TRUE(in_order);
}

TEST(Published, GivesTheNewestValue) {
  Published<Agreeing> published;
  EXPECT_EQ(published.read().first, 0U) << "before the first value it is zero";
  published.rt_publish(agreeing(1));
  published.rt_publish(agreeing(2));
  EXPECT_EQ(published.read().first, 2U);
  EXPECT_EQ(published.read().first, 2U);
}

struct Odd {
  std::array<std::uint8_t, 7> bytes{};
};
TEST(Published, ValuesNeedNotFillWholeWords) {
  Published<Odd> published;
  published.rt_publish({{1, 2, 3, 4, 5, 6, 7}});
  EXPECT_EQ(published.read().bytes, (std::array<std::uint8_t, 7>{1, 2, 3, 4, 5, 6, 7}));
}

TEST(Published, NoReadIsTornWhileTheCycleWrites) {
  constexpr std::uint64_t kValues = 100'000;
  Published<Agreeing> published;
  published.rt_publish(agreeing(1));
  std::atomic<bool> done = false;
  std::thread writer([&] {
    for (std::uint64_t i = 2; i <= kValues; ++i) {
      published.rt_publish(agreeing(i));
      if (i % 1000 == 0) {
        std::this_thread::yield();  // a cycle sleeps most of its time too
      }
    }
    done = true;
  });
  std::uint64_t last = 0;
  std::uint64_t reads = 0;
  bool whole = true;
  bool in_order = true;
  while (!done) {
    const Agreeing value = published.read();
    whole = whole && agrees(value);
    in_order = in_order && value.first >= last;
    last = value.first;
    ++reads;
  }
  writer.join();
  EXPECT_GT(reads, 0U);
  EXPECT_TRUE(whole);
  EXPECT_TRUE(in_order);
  EXPECT_EQ(published.read().first, kValues);
}

TEST(SpscRing, KeepsTheOrderAndCountsWhatFindsNoRoom) {
  SpscRing<int, 4> ring;
  int value = 0;
  EXPECT_FALSE(ring.pop(value));
  for (int i = 0; i < 6; ++i) {
    ring.rt_push(i);
  }
  EXPECT_EQ(ring.dropped(), 2U);
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(ring.pop(value));
    EXPECT_EQ(value, i) << "the oldest are kept, the newest dropped";
  }
  EXPECT_FALSE(ring.pop(value));
  ring.rt_push(9);
  ASSERT_TRUE(ring.pop(value));
  EXPECT_EQ(value, 9);
  EXPECT_EQ(ring.dropped(), 2U);
}

TEST(SpscRing, BetweenThreadsEveryValueArrivesInOrderOrIsCountedAsDropped) {
  constexpr std::uint64_t kValues = 100'000;
  SpscRing<Agreeing, 8> ring;
  std::atomic<bool> done = false;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kValues; ++i) {
      ring.rt_push(agreeing(i));
      if (i % 1000 == 0) {
        std::this_thread::yield();
      }
    }
    done = true;
  });
  std::uint64_t received = 0;
  std::uint64_t last = 0;
  bool whole = true;
  bool in_order = true;
  Agreeing value;
  for (bool more = true; more;) {
    more = !done;  // read before the last sweep, so that nothing is left behind
    while (ring.pop(value)) {
      whole = whole && agrees(value);
      in_order = in_order && value.first > last;
      last = value.first;
      ++received;
    }
  }
  writer.join();
  EXPECT_TRUE(whole);
  EXPECT_TRUE(in_order);
  EXPECT_GT(received, 0U);
  EXPECT_EQ(received + ring.dropped(), kValues);
}

}  // namespace
}  // namespace capstan
