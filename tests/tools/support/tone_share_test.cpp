// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/support/tone_share.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "capstan/tools/support/random.hpp"

namespace capstan::tools {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// A minute of values every 20 ms, every third second left out.
auto share_of(const std::function<double(double)>& signal) -> double {
  std::vector<double> times, values;
  for (int i = 0; i < 3000; ++i) {
    const double time = 0.02 * i;
    if (static_cast<int>(time) % 3 != 0) {
      times.push_back(time);
      values.push_back(signal(time));
    }
  }
  const auto count = static_cast<Eigen::Index>(times.size());
  return tone_share(Eigen::Map<const Eigen::VectorXd>(times.data(), count),
                    Eigen::Map<const Eigen::VectorXd>(values.data(), count));
}

TEST(ToneShare, OfAToneThatKeepsItsPitchIsAllOfIt) {
  EXPECT_GT(share_of([](double t) { return 3.0 + 0.2 * std::sin(kTurn * 9.013 * t + 1.0); }), 0.97);
}

TEST(ToneShare, OfTwoTonesIsTheLargerOnesPart) {
  const double share = share_of([](double t) { return 2.0 * std::sin(kTurn * 3.0 * t) + std::sin(kTurn * 7.0 * t); });
  EXPECT_NEAR(share, 0.8, 0.03);  // 4 of 5
}

TEST(ToneShare, OfASwingThatBeginsAnewAndDiesAwayIsSmall) {
  Random random(1);
  std::vector<double> began;
  for (double time = 0.0; time < 60.0; time += 0.7 + random.uniform()) {
    began.push_back(time);
  }
  const double share = share_of([&](double t) {
    double sum = 0.0;
    for (const double begin : began) {
      sum += t > begin ? std::exp(-3.0 * (t - begin)) * std::sin(kTurn * 5.0 * (t - begin)) : 0.0;
    }
    return sum;
  });
  EXPECT_LT(share, 0.3);
}

TEST(ToneShare, OfNoiseIsNextToNothingAndOfAConstantNone) {
  Random random(2);
  EXPECT_LT(share_of([&](double /*t*/) { return random.normal(); }), 0.05);
  EXPECT_EQ(share_of([](double /*t*/) { return 2.0; }), 0.0);
  EXPECT_EQ(tone_share(Eigen::VectorXd(), Eigen::VectorXd()), 0.0);
}

}  // namespace
}  // namespace capstan::tools
