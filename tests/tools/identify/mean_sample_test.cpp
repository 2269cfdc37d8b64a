// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/mean_sample.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace capstan::tools {
namespace {

TEST(MeanSample, IsTheMeanOfSignalsTheSumOfWaysAndTheDirectionOfMost) {
  std::vector<Sample<double>> samples(3);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto x = static_cast<double>(i);
    samples[i].q1 = x;
    samples[i].dq1 = 2.0 * x;
    samples[i].tau = 3.0 * x;
    samples[i].tau_late = 4.0 * x;
    samples[i].warmth = 5.0 * x;
    samples[i].advance = 0.1;
    samples[i].advance_late = 0.2 * x;
    samples[i].others[2].q1 = 6.0 * x;
    samples[i].forward = i != 2;
  }
  const auto mean = mean_sample(samples);
  EXPECT_DOUBLE_EQ(mean.q1, 1.0);
  EXPECT_DOUBLE_EQ(mean.dq1, 2.0);
  EXPECT_DOUBLE_EQ(mean.tau, 3.0);
  EXPECT_DOUBLE_EQ(mean.tau_late, 4.0);
  EXPECT_DOUBLE_EQ(mean.warmth, 5.0);
  EXPECT_DOUBLE_EQ(mean.advance, 0.3);
  EXPECT_DOUBLE_EQ(mean.advance_late, 0.6);
  EXPECT_DOUBLE_EQ(mean.others[2].q1, 6.0);
  EXPECT_TRUE(mean.forward) << "two of three, though not the last";
}

TEST(MeanSample, TakesWhatIsNoSignalFromTheLast) {
  std::vector<Sample<double>> samples(2);
  samples[0].late_gain = 0.1;
  samples[1].late_gain = 0.2;
  samples[1].q1_reversal = 0.7;
  EXPECT_EQ(mean_sample(samples).late_gain, 0.2);
  EXPECT_EQ(mean_sample(samples).q1_reversal, 0.7);
}

}  // namespace
}  // namespace capstan::tools
