// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/linux/time_histogram.hpp"

#include <gtest/gtest.h>

namespace capstan {
namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

TEST(TimeHistogram, IsEmptyAtFirst) {
  const TimeHistogram histogram;
  EXPECT_EQ(histogram.count(), 0U);
  EXPECT_EQ(histogram.maximum(), nanoseconds(0));
  EXPECT_EQ(histogram.quantile(0.5), nanoseconds(0));
}

TEST(TimeHistogram, PutsEveryTimeIntoTheBinOfItsWholeMicroseconds) {
  TimeHistogram histogram;
  histogram.rt_add(nanoseconds(9'999));
  histogram.rt_add(nanoseconds(10'000));
  EXPECT_EQ(histogram.between(9, 10), 1U);
  EXPECT_EQ(histogram.between(10, 11), 1U);
  EXPECT_EQ(histogram.between(0, TimeHistogram::kBins), 2U);
}

TEST(TimeHistogram, KeepsTheExactMaximumOfTimesBeyondItsLastBin) {
  TimeHistogram histogram;
  histogram.rt_add(nanoseconds(7'123'456'789));
  histogram.rt_add(nanoseconds(1));
  EXPECT_EQ(histogram.maximum(), nanoseconds(7'123'456'789));
  EXPECT_EQ(histogram.between(TimeHistogram::kBins - 1, TimeHistogram::kBins), 1U);
  EXPECT_EQ(histogram.quantile(1.0), nanoseconds(7'123'456'789));
}

TEST(TimeHistogram, AClockThatStepsBackCountsAsNoDelay) {
  TimeHistogram histogram;
  histogram.rt_add(nanoseconds(-50));
  EXPECT_EQ(histogram.between(0, 1), 1U);
}

TEST(TimeHistogram, QuantilesAreRoundedUpToTheMicrosecond) {
  TimeHistogram histogram;
  for (int us = 0; us < 1000; ++us) {
    histogram.rt_add(microseconds(us));
  }
  EXPECT_EQ(histogram.quantile(0.5), microseconds(500));
  EXPECT_EQ(histogram.quantile(0.999), microseconds(999));
  EXPECT_EQ(histogram.quantile(1.0), microseconds(999)) << "never above the maximum";
}

}  // namespace
}  // namespace capstan
