// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/repeats.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace capstan::tools {
namespace {

/// A motion that does not repeat itself within a cycle.
auto cycle_at(double share) -> double {
  return std::sin(6.2832 * share) + 0.6 * std::sin(3.0 * 6.2832 * share + 1.0) + 0.3 * std::cos(7.0 * 6.2832 * share);
}

auto cycles(Eigen::Index length, Eigen::Index count, Eigen::Index lead_in, double noise) -> Eigen::VectorXd {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0.0, 1.0);
  Eigen::VectorXd motion(lead_in + length * count);
  for (Eigen::Index i = 0; i < motion.size(); ++i) {
    const double share = static_cast<double>(i - lead_in) / static_cast<double>(length);
    motion[i] = (i < lead_in ? cycle_at(0.0) : cycle_at(share)) + noise * normal(random);
  }
  return motion;
}

TEST(Repeats, AreFoundWithTheirLengthAndNumber) {
  const auto found = find_repeats(cycles(1503, 4, 0, 0.001), 0.001);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->length, 1503);
  EXPECT_EQ(found->count, 4);
}

// Another joint at 0.17 and 0.47 of the cycle's rates is elsewhere each time.
TEST(Repeats, AnotherSignalComesAgainOnlyIfItDoes) {
  const auto found = find_repeats(cycles(1500, 4, 0, 0.0), 0.0);
  ASSERT_TRUE(found.has_value());
  const auto tone = [](double per_cycle) {
    Eigen::VectorXd signal(6000);
    for (Eigen::Index i = 0; i < signal.size(); ++i) {
      signal[i] = std::sin(2.0 * 3.14159265358979 * per_cycle * static_cast<double>(i) / 1500.0);
    }
    return signal;
  };
  EXPECT_TRUE(comes_again(tone(2.0), *found));
  EXPECT_FALSE(comes_again(tone(1.7), *found));
  EXPECT_TRUE(comes_again(Eigen::VectorXd::Zero(6000), *found)) << "it stands";
}

TEST(Repeats, ALeadInBeforeTheFirstCycleIsLeftOut) {
  const auto found = find_repeats(cycles(2000, 3, 700, 0.001), 0.001);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->length, 2000);
  EXPECT_EQ(found->count, 3);
  EXPECT_EQ(found->first, 700);
}

TEST(Repeats, NoneAreFoundInAMotionThatNeverComesBack) {
  Eigen::VectorXd motion(8000);
  for (Eigen::Index i = 0; i < motion.size(); ++i) {
    const double t = static_cast<double>(i) / 8000.0;
    motion[i] = std::sin(30.0 * t) + std::sin(47.123 * t * t + 1.0) + 0.7 * std::sin(19.7 * t + 2.0);
  }
  EXPECT_FALSE(find_repeats(motion, 0.0).has_value());
  EXPECT_FALSE(find_repeats(Eigen::VectorXd::LinSpaced(5000, 0.0, 1.0), 0.0).has_value());
}

/// Swings that die away, `cycles` times over; each is within 3 % of the range of its neighbours for most of the time.
auto dying_swings(Eigen::Index length, Eigen::Index cycles) -> Eigen::VectorXd {
  Eigen::VectorXd motion(length * cycles);
  for (Eigen::Index i = 0; i < motion.size(); ++i) {
    const double share = static_cast<double>(i % length) / static_cast<double>(length);
    motion[i] = std::exp(-2.2 * share) * std::sin(24.0 * 6.2832 * share);
  }
  return motion;
}

TEST(Repeats, SwingsThatDieAwayAreNone) {
  EXPECT_FALSE(find_repeats(dying_swings(6000, 1), 0.0).has_value());
}

TEST(Repeats, SwingsThatDieAwayAgainAndAgainAreFoundWhole) {
  const auto found = find_repeats(dying_swings(6000, 4), 0.0);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->length, 6000);
  EXPECT_EQ(found->count, 4);
}

TEST(Repeats, PureErrorHasTheVarianceOfTheNoiseWhateverTheSignal) {
  const Repeats repeats{0, 5000, 4};
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0.0, 0.25);
  Eigen::VectorXd signal(20000);
  for (Eigen::Index i = 0; i < signal.size(); ++i) {
    signal[i] = 10.0 * cycle_at(static_cast<double>(i % 5000) / 5000.0) + normal(random);
  }
  EXPECT_NEAR(pure_error(signal, repeats).squaredNorm() / 20000.0, 0.0625, 0.002);
}

}  // namespace
}  // namespace capstan::tools
