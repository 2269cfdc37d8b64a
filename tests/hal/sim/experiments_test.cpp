// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/experiments.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "capstan/hal/sim/scenario.hpp"

namespace capstan::sim {
namespace {

Motion only(std::vector<Segment> segments) {
  return Motion(std::move(segments), 1, 0.05);
}

// Turning points of a motion, but for wiggles below 1e-6 rad.
std::vector<double> turning_points(const Motion& motion) {
  std::vector<double> points;
  double before = 0.0;
  double direction = 0.0;
  for (double t = 0.06; t < motion.cycle_s(); t += 0.001) {
    const double now = motion.reference_rad(t);
    const double step = now - before;
    if (std::fabs(step) > 1.0e-9 && step * direction < 0.0)
      points.push_back(before);
    if (std::fabs(step) > 1.0e-9)
      direction = step;
    before = now;
  }
  return points;
}

TEST(Experiments, AStaircaseReversesOnceAtEveryLevelAndAlwaysFromTheSameBottom) {
  const Motion motion = only(reversal_staircase({.amplitude_rad = 0.5}, 5, 0.5));
  const std::vector<double> points = turning_points(motion);
  // Bottom, level, bottom, level, ...: levels at -0.3, -0.1, ..., 0.5.
  ASSERT_EQ(points.size(), 11U);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double expected = i % 2 == 0 ? -0.5 : -0.3 + 0.2 * static_cast<double>(i / 2);
    EXPECT_NEAR(points[i], expected, 1.0e-4) << i;
  }
}

TEST(Experiments, ASpeedLadderMovesAtItsSpeedsAndNothingInBetween) {
  const std::vector<double> speeds = {0.1, 0.4, 1.6};
  const std::vector<Segment> segments = speed_ladder({.amplitude_rad = 0.4, .cycles = 3}, speeds);
  ASSERT_EQ(segments.size(), 3U);
  const Motion motion = only(segments);
  double start = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    int at_speed = 0;
    int samples = 0;
    for (double t = start + 0.06; t < start + segments[i].duration_s; t += 0.001, ++samples) {
      const double rate = std::fabs(motion.at(t).rate_rad_per_s);
      ASSERT_LT(rate, speeds[i] * (1.0 + 1.0e-9));
      at_speed += std::fabs(rate - speeds[i]) < 1.0e-9 ? 1 : 0;
    }
    EXPECT_GT(at_speed, samples * 6 / 10) << speeds[i];
    start += segments[i].duration_s;
  }
}

TEST(Experiments, ASineLadderGivesEachFrequencyItsCycles) {
  const std::vector<Segment> segments = sine_ladder({.amplitude_rad = 0.3, .cycles = 4}, {0.5, 2.0});
  ASSERT_EQ(segments.size(), 2U);
  EXPECT_NEAR(segments[0].duration_s, 8.0, 1.0e-12);
  EXPECT_NEAR(segments[1].duration_s, 2.0, 1.0e-12);
  EXPECT_EQ(segments[1].frequency_hz, 2.0);
}

TEST(Experiments, PolylinesHaveContinuousSpeedAndEndWhereTheyShould) {
  const Segment line{.kind = SegmentKind::kPolyline,
                     .duration_s = 6.0,
                     .corner_s = 0.1,
                     .speed_rad_per_s = 0.5,
                     .points_rad = {0.0, 0.4, 0.39, -0.3}};
  const Motion motion = only({line});
  double before = motion.at(0.06).rate_rad_per_s;  // behind the blend from rest
  for (double t = 0.06; t < 6.0; t += 0.001) {
    const Kinematics k = motion.at(t);
    ASSERT_LT(std::fabs(k.rate_rad_per_s - before), 0.5 / 0.1 * 0.001 + 1.0e-9) << t;
    before = k.rate_rad_per_s;
  }
  EXPECT_NEAR(motion.reference_rad(5.9), -0.3, 1.0e-12);
  // 0.4, 0.01 and 0.69 rad: the short leg never gets to speed.
  EXPECT_NEAR(polyline_duration_s(line), 0.4 / 0.5 + 0.1 + 0.2 + 0.69 / 0.5 + 0.1, 1.0e-12);
}

TEST(Experiments, ImpossibleLaddersAreRefused) {
  EXPECT_THROW(static_cast<void>(sine_ladder({.amplitude_rad = 0.3}, {})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(sine_ladder({.amplitude_rad = 0.3}, {-1.0})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(sine_ladder({.amplitude_rad = 0.0}, {1.0})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(speed_ladder({.amplitude_rad = 0.3, .cycles = 0}, {1.0})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(reversal_staircase({.amplitude_rad = 0.3}, 1, 1.0)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(reversal_staircase({.amplitude_rad = 0.3}, 5, 0.0)), std::invalid_argument);
}

TEST(Experiments, ScenariosSpellThem) {
  const Scenario s = parse_scenario(
      "[motion]\n[[motion.segments]]\nkind = \"sine_ladder\"\namplitude_rad = 0.3\ncycles = 2\n"
      "frequencies_hz = [0.5, 1.0]\n[[motion.segments]]\nkind = \"polyline\"\nspeed_rad_per_s = 1.0\n"
      "points_rad = [0.0, 0.5, 0.0]\n[[motion.segments]]\nkind = \"reversal_staircase\"\namplitude_rad = 0.3\nlevels = "
      "4\n"
      "speed_rad_per_s = 1\n",
      "x.toml");
  EXPECT_GT(s.duration_s, 4.0 + 2.0 + 1.1);
  for (const char* bad : {"kind = \"sine_ladder\"\namplitude_rad = 0.3\nfrequencies_hz = [0.5]\nduration_s = 3\n",
                          "kind = \"polyline\"\nspeed_rad_per_s = 1.0\n", "kind = \"ladder\"\nduration_s = 1\n",
                          "kind = \"polyline\"\npoints_rad = [0, 1]\n"}) {
    EXPECT_THROW(static_cast<void>(parse_scenario("[motion]\n[[motion.segments]]\n" + std::string(bad), "x.toml")),
                 ScenarioError)
        << bad;
  }
}

}  // namespace
}  // namespace capstan::sim
