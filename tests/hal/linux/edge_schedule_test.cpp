// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/linux/edge_schedule.hpp"

#include <gtest/gtest.h>

#include <random>

namespace capstan {
namespace {

using std::chrono::microseconds;
using Time = EdgeSchedule::Time;
constexpr Time kPeriod = microseconds(1000);
constexpr Time kStart = microseconds(5000);

TEST(EdgeSchedule, CyclesInTimeRunOnEveryEdge) {
  EdgeSchedule edges(kStart, kPeriod);
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(edges.next(), kStart + i * kPeriod);
    ASSERT_TRUE(edges.rt_woke(edges.next() + microseconds(60)));
    edges.rt_finished(edges.next() + microseconds(400));
  }
  EXPECT_EQ(edges.missed(), 0U);
}

TEST(EdgeSchedule, ACycleThatEndsAfterTheNextEdgeSkipsThatEdgeOnly) {
  EdgeSchedule edges(kStart, kPeriod);
  ASSERT_TRUE(edges.rt_woke(kStart));
  edges.rt_finished(kStart + microseconds(1001));
  EXPECT_EQ(edges.next(), kStart + 2 * kPeriod);
  EXPECT_EQ(edges.missed(), 1U);
}

TEST(EdgeSchedule, ACycleThatEndsExactlyOnTheNextEdgeIsInTime) {
  EdgeSchedule edges(kStart, kPeriod);
  ASSERT_TRUE(edges.rt_woke(kStart));
  edges.rt_finished(kStart + kPeriod);
  EXPECT_EQ(edges.next(), kStart + kPeriod);
  EXPECT_EQ(edges.missed(), 0U);
}

TEST(EdgeSchedule, AWakeUpLaterThanHalfAPeriodIsSkippedAndALittleEarlierIsRun) {
  EdgeSchedule run(kStart, kPeriod);
  EXPECT_TRUE(run.rt_woke(kStart + microseconds(500)));
  EXPECT_EQ(run.missed(), 0U);
  EdgeSchedule skipped(kStart, kPeriod);
  EXPECT_FALSE(skipped.rt_woke(kStart + microseconds(501)));
  EXPECT_EQ(skipped.next(), kStart + kPeriod);
  EXPECT_EQ(skipped.missed(), 1U);
}

TEST(EdgeSchedule, AfterALongStallNothingIsMadeUpFor) {
  EdgeSchedule edges(kStart, kPeriod);
  EXPECT_FALSE(edges.rt_woke(kStart + microseconds(20'300)));
  EXPECT_EQ(edges.next(), kStart + 21 * kPeriod);
  EXPECT_EQ(edges.missed(), 21U);
}

TEST(EdgeSchedule, WhateverHappensTheGridStaysAndCyclesBeginAtLeastHalfAPeriodApart) {
  std::mt19937 random(20261121);
  std::exponential_distribution<double> delay_us(1.0 / 400.0);
  const auto some = [&] { return std::chrono::duration_cast<Time>(microseconds(static_cast<int>(delay_us(random)))); };
  EdgeSchedule edges(kStart, kPeriod);
  Time now = kStart - kPeriod;
  Time last_begin = Time::min() / 2;
  std::uint64_t run = 0;
  for (int i = 0; i < 100'000; ++i) {
    ASSERT_GE(edges.next(), now) << "an edge in the past would be a cycle made up for";
    const Time edge = edges.next();
    ASSERT_EQ(edge, kStart + static_cast<std::int64_t>(run + edges.missed()) * kPeriod);
    now = edge + some();
    if (edges.rt_woke(now)) {
      ASSERT_GE(now - last_begin, kPeriod / 2);
      last_begin = now;
      now += some();
      edges.rt_finished(now);
      ++run;
    }
  }
  EXPECT_GT(run, 0U);
  EXPECT_GT(edges.missed(), 0U);
}

}  // namespace
}  // namespace capstan
