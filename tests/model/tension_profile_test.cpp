// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/tension_profile.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace capstan {
namespace {

/// The definition, point by point: pulling raises every point to the new curve where it is below it, yielding lowers
/// what is above. No front, no pieces, no closed integral.
class Points {
 public:
  Points(double eta, double tension, std::size_t count) : tensions_(count, tension), decay_(count) {
    for (std::size_t i = 0; i < count; ++i) {
      decay_[i] = std::exp(-eta * static_cast<double>(i) / static_cast<double>(count - 1));
    }
  }
  void pull_to(double tension) {
    const bool pulled = tension > tensions_[0];
    for (std::size_t i = 0; i < tensions_.size(); ++i) {
      tensions_[i] =
          pulled ? std::fmax(tensions_[i], tension * decay_[i]) : std::fmin(tensions_[i], tension / decay_[i]);
    }
  }
  [[nodiscard]] auto at(std::size_t i) const -> double { return tensions_[i]; }
  [[nodiscard]] auto integral() const -> double {
    double sum = 0.5 * (tensions_.front() + tensions_.back());
    for (std::size_t i = 1; i + 1 < tensions_.size(); ++i) {
      sum += tensions_[i];
    }
    return sum / static_cast<double>(tensions_.size() - 1);
  }

 private:
  std::vector<double> tensions_, decay_;
};

TEST(TensionProfile, IsThePointByPointDefinitionOnRandomMotion) {
  for (const double eta : {0.05, 0.7, 1.1414, 2.5}) {
    constexpr std::size_t kCount = 60001;
    Points points(eta, 12.0, kCount);
    TensionProfile profile({eta, 5.0664e4}, 12.0);
    std::mt19937 engine(31);
    std::uniform_real_distribution<double> wide(0.5, 60.0);
    std::normal_distribution<double> narrow(0.0, 2.0);
    double tension = 12.0;
    for (int round = 0; round < 250; ++round) {
      tension = round % 15 == 0 ? wide(engine) : std::fmax(tension + narrow(engine), 0.1);
      profile.pull_to(tension);
      points.pull_to(tension);
      for (std::size_t i = 0; i < kCount; i += 1500) {
        const double phi = static_cast<double>(i) / (kCount - 1);
        ASSERT_NEAR(profile.at(phi), points.at(i), 1e-9 * points.at(i)) << eta << ", " << round << ", " << phi;
      }
      ASSERT_NEAR(profile.integral(), points.integral(), 1e-9 * points.integral()) << eta << ", " << round;
    }
    EXPECT_EQ(profile.dropped(), 0U);
  }
}

TEST(TensionProfile, FrontAdvancesFromTheInputAndTheOutputMovesOnlyWhenItArrives) {
  TensionProfile profile({1.1414, 5.0664e4}, 10.0);
  double front = 0.0;
  double tension = 10.0;
  while (profile.front() < 1.0) {
    tension += 0.05;
    profile.pull_to(tension);
    EXPECT_GT(profile.front(), front);
    front = profile.front();
    EXPECT_EQ(profile.at(1.0) == 10.0, front < 1.0);
  }
  EXPECT_NEAR(tension, 10.0 * std::exp(1.1414), 0.05) << "(2.11): the output follows from here on";
}

TEST(TensionProfile, SlackEmptiesTheWholeTendonAndPullingFillsItAtOnce) {
  TensionProfile profile({1.0, 1000.0}, 10.0);
  profile.pull_to(-1.0);
  EXPECT_EQ(profile.integral(), 0.0);
  EXPECT_EQ(profile.at(0.7), 0.0);
  profile.pull_to(5.0);
  EXPECT_EQ(profile.front(), 1.0);
  EXPECT_NEAR(profile.elongation(), 5.0 * (1.0 - std::exp(-1.0)) / 1000.0, 1e-15);
}

TEST(TensionProfile, FullMemoryDropsTheInnermostLoopAndCountsIt) {
  TensionProfile profile({1.0, 1000.0}, 10.0);
  Points points(1.0, 10.0, 1001);
  for (int i = 0; i < 100; ++i) {
    const double tension = 10.0 + (i % 2 == 0 ? 4.0 : -4.0) * (1.0 - i / 100.0);
    profile.pull_to(tension);
    points.pull_to(tension);
    ASSERT_NEAR(profile.at(0.0), tension, 1e-12);
  }
  EXPECT_GT(profile.dropped(), 0U);
  profile.pull_to(13.99);
  points.pull_to(13.99);
  EXPECT_NEAR(profile.integral(), points.integral(), 1e-5) << "the dropped loops are wiped out";
}

}  // namespace
}  // namespace capstan
