// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace capstan::sim {
namespace {

std::vector<Segment> one_of_each() {
  return {
      {.kind = SegmentKind::kSine, .duration_s = 3.3, .amplitude_rad = 0.5, .frequency_hz = 0.7, .phase_rad = 1.0},
      {.kind = SegmentKind::kHold, .duration_s = 1.0, .offset_rad = -0.3},
      {.kind = SegmentKind::kTriangle, .duration_s = 4.0, .amplitude_rad = 0.4, .frequency_hz = 0.6, .corner_s = 0.1},
      {.kind = SegmentKind::kDecayingSine,
       .duration_s = 2.0,
       .amplitude_rad = 0.4,
       .frequency_hz = 1.3,
       .decay_per_s = 0.4},
      {.kind = SegmentKind::kMultisine,
       .duration_s = 5.0,
       .offset_rad = 0.1,
       .amplitude_rad = 0.45,
       .frequencies_hz = {0.2, 0.4, 0.6, 0.8}}};
}

TEST(Motion, StartsAndEndsAtRestAtZero) {
  const Motion motion(one_of_each(), 2, 0.5);
  for (const double t : {-1.0, 0.0, motion.duration_s(), motion.duration_s() + 5.0}) {
    const Kinematics k = motion.at(t);
    EXPECT_NEAR(k.angle_rad, 0.0, 1.0e-12) << t;
    EXPECT_NEAR(k.rate_rad_per_s, 0.0, 1.0e-10) << t;
    EXPECT_NEAR(k.acceleration_rad_per_s2, 0.0, 1.0e-8) << t;
  }
  EXPECT_NEAR(motion.duration_s(), 2.0 * 15.3 + 0.5, 1.0e-12);
}

TEST(Motion, AngleAndRateNeverJump) {
  const Motion motion(one_of_each(), 3, 0.4);
  constexpr double kStep = 1.0e-4;
  Kinematics before = motion.at(0.0);
  for (double t = kStep; t < motion.duration_s() + 0.1; t += kStep) {
    const Kinematics now = motion.at(t);
    ASSERT_LT(std::fabs(now.angle_rad - before.angle_rad), 10.0 * kStep) << t;
    ASSERT_LT(std::fabs(now.rate_rad_per_s - before.rate_rad_per_s), 120.0 * kStep) << t;
    before = now;
  }
}

TEST(Motion, RateAndAccelerationAreTheDerivativesOfTheAngle) {
  const Motion motion(one_of_each(), 2, 0.5);
  constexpr double kStep = 1.0e-5;
  for (double t = 0.0123; t < motion.duration_s() - 0.01; t += 0.0317) {
    const Kinematics a = motion.at(t - kStep);
    const Kinematics b = motion.at(t + kStep);
    ASSERT_NEAR((b.angle_rad - a.angle_rad) / (2.0 * kStep), motion.at(t).rate_rad_per_s, 1.0e-3) << t;
    ASSERT_NEAR((b.rate_rad_per_s - a.rate_rad_per_s) / (2.0 * kStep), motion.at(t).acceleration_rad_per_s2, 0.05) << t;
  }
}

TEST(Motion, RepeatsAreEqualAfterTheFirstBlend) {
  const Motion motion(one_of_each(), 4, 0.5);
  for (double t = 0.5; t < motion.cycle_s(); t += 0.01) {
    for (const double cycle : {1.0, 2.0, 3.0}) {
      ASSERT_NEAR(motion.reference_rad(t), motion.reference_rad(t + cycle * motion.cycle_s()), 1.0e-10) << t;
    }
  }
}

TEST(Motion, AmplitudesArePeaks) {
  const auto peak = [](const Segment& segment) {
    const Motion motion({segment}, 1, 0.1);
    double largest = 0.0;
    for (double t = 0.1; t < segment.duration_s; t += 1.0e-3) {
      largest = std::max(largest, std::fabs(motion.reference_rad(t)));
    }
    return largest;
  };
  EXPECT_NEAR(peak({.kind = SegmentKind::kSine, .duration_s = 4.0, .amplitude_rad = 0.3, .frequency_hz = 0.5}), 0.3,
              1e-5);
  EXPECT_NEAR(peak({.kind = SegmentKind::kTriangle,
                    .duration_s = 4.0,
                    .amplitude_rad = 0.3,
                    .frequency_hz = 0.5,
                    .corner_s = 0.2}),
              0.3, 1e-5);
  EXPECT_NEAR(peak({.kind = SegmentKind::kMultisine,
                    .duration_s = 10.0,
                    .amplitude_rad = 0.3,
                    .frequencies_hz = {0.1, 0.2, 0.3, 0.4, 0.5}}),
              0.3, 1e-3);
}

TEST(Motion, ATriangleMovesAtConstantSpeedBetweenItsCorners) {
  const Motion motion({{.kind = SegmentKind::kTriangle,
                        .duration_s = 4.0,
                        .amplitude_rad = 0.4,
                        .frequency_hz = 0.25,
                        .corner_s = 0.2}},
                      1, 0.1);
  // A quarter period of 1 s at full speed but for half a corner, which costs half of itself.
  EXPECT_NEAR(motion.at(0.5).rate_rad_per_s, 0.4 / (1.0 - 0.05), 1.0e-12);
  EXPECT_NEAR(motion.at(2.0).rate_rad_per_s, -0.4 / (1.0 - 0.05), 1.0e-12);
  EXPECT_NEAR(motion.at(1.0).angle_rad, 0.4, 1.0e-12);
  EXPECT_NEAR(motion.at(3.0).angle_rad, -0.4, 1.0e-12);
}

TEST(Motion, SchroederPhasesKeepTheCrestOfTenTonesLow) {
  Segment tones{.kind = SegmentKind::kMultisine, .duration_s = 100.0, .amplitude_rad = 1.0};
  for (int k = 1; k <= 10; ++k)
    tones.frequencies_hz.push_back(0.01 * k);
  const Motion motion({tones}, 1, 0.5);
  double squares = 0.0;
  int count = 0;
  for (double t = 0.5; t < 100.0; t += 0.05, ++count)
    squares += std::pow(motion.reference_rad(t), 2);
  // All tones in phase would have a crest factor of sqrt(20) = 4.5; Schroeder's phases stay below 2.
  EXPECT_LT(1.0 / std::sqrt(squares / count), 2.0);
}

TEST(Motion, ImpossibleSegmentsAreRefused) {
  const Segment good{.kind = SegmentKind::kSine, .duration_s = 2.0, .amplitude_rad = 0.3, .frequency_hz = 0.5};
  EXPECT_NO_THROW(Motion({good}, 1, 0.5));
  EXPECT_THROW(Motion({}, 1, 0.5), std::invalid_argument);
  EXPECT_THROW(Motion({good}, 0, 0.5), std::invalid_argument);
  EXPECT_THROW(Motion({good}, 1, 3.0), std::invalid_argument);
  Segment bad = good;
  bad.frequency_hz = 0.0;
  EXPECT_THROW(Motion({bad}, 1, 0.5), std::invalid_argument);
  bad = good;
  bad.duration_s = -1.0;
  EXPECT_THROW(Motion({bad}, 1, 0.5), std::invalid_argument);
  bad = good;
  bad.kind = SegmentKind::kMultisine;
  EXPECT_THROW(Motion({bad}, 1, 0.5), std::invalid_argument);
}

}  // namespace
}  // namespace capstan::sim
