// SPDX-License-Identifier: Apache-2.0
// What a joint file keeps of the healthy loop: its width, how late the joint is, and how far friction goes from the
// steady one. The motions are written down by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "capstan/tools/identify/friction_spread.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/loop.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools {
namespace {

constexpr double kHalfWidth = 0.02;  // rad, at the motor
constexpr double kBeta = 0.9;
constexpr double kPeriod = 0.001;

auto motor(double time) -> double {
  return 0.4 * std::sin(2.0 * std::numbers::pi * 0.3 * time) + 0.1 * std::sin(2.0 * std::numbers::pi * 1.1 * time);
}

/// A minute of the joint behind a gap, seen by a sensor that is late by less than a sample.
auto late_joint(double late_s) -> AxisLog {
  constexpr Eigen::Index kRows = 60000;
  constexpr int kFine = 10;  // steps of the gap in a sample
  AxisLog log;
  log.name = "made.csv";
  log.period_s = kPeriod;
  log.has_torque = true;
  log.time_s = log.q1_rad = log.tau_nm = log.q2_rad = Eigen::VectorXd::Zero(kRows);
  Random random(3);
  double behind = 0.0;
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double time = kPeriod * static_cast<double>(i);
    for (int step = 1; step <= kFine; ++step) {
      const double seen = motor(time - late_s - kPeriod * (1.0 - static_cast<double>(step) / kFine));
      behind = std::clamp(behind, seen - kHalfWidth, seen + kHalfWidth);
    }
    log.time_s[i] = time;
    log.q1_rad[i] = motor(time);
    log.q2_rad[i] = kBeta * behind + 0.0017 * random.normal();
  }
  return log;
}

TEST(LoopGauges, TheWidthIsTheGapsHoweverLateTheJointIs) {
  for (const double late_s : {0.0, 0.0005, 0.006}) {
    const std::vector<AxisLog> logs = {late_joint(late_s)};
    ConditionerShape<double> shape;
    shape.direction_threshold_rad = 1e-4;
    const LawDesign design(logs, shape);
    const Eigen::VectorXd target = stacked_target(logs);
    const Blocks rows = even_blocks(design.log_rows(), 2);
    const LawForm alone = fit_loop(design, target, rows, {0.015, 0.01});
    const LawForm law = with_lateness(design, target, rows, alone);
    EXPECT_NEAR(half_width_of(law), kHalfWidth, 0.002 * kHalfWidth) << late_s;
    EXPECT_NEAR(lateness_of(law), late_s, 4e-5) << late_s;
    EXPECT_EQ(lateness_of(alone), 0.0);
    if (late_s > 0.001) {
      EXPECT_GT(half_width_of(alone), 1.02 * kHalfWidth) << "without it the lateness is width";
    }
  }
}

/// Swings of 2 rad to and fro, with a friction of its own in each.
auto swings(const std::vector<double>& friction_nm, double per_speed = 0.0) -> Samples {
  constexpr int kSteps = 2000;
  Samples samples;
  for (std::size_t swing = 0; swing < friction_nm.size(); ++swing) {
    const double speed = swing % 4 < 2 ? 1.0 : 3.0;
    for (int i = 0; i < kSteps; ++i) {
      const bool forward = swing % 2 == 0;
      const double way = 2.0 * i / kSteps;
      Sample<double> now;
      now.forward = forward;
      now.q1_reversal = forward ? -1.0 : 1.0;
      now.q1 = forward ? -1.0 + way : 1.0 - way;
      now.dq1 = forward ? speed : -speed;
      now.tau = (forward ? 1.0 : -1.0) * (friction_nm[swing] + per_speed * (speed - 2.0));
      samples.push_back(now);
    }
  }
  return samples;
}

auto spread(const Samples& samples) -> std::optional<double> {
  AxisLog log;
  log.has_torque = true;
  return friction_spread({log}, {samples}, {0.05, -0.05});
}

TEST(FrictionSpread, IsHowFarAStretchsFrictionIsFromTheSteadyOne) {
  EXPECT_NEAR(spread(swings(std::vector<double>(60, 0.05))).value(), 0.0, 1e-12);
  EXPECT_NEAR(spread(swings(std::vector<double>(60, 0.052))).value(), 0.002, 1e-9);
}

TEST(FrictionSpread, HoldsWhatAnotherSpeedChanges) {
  // 1 and 3 rad/s by turns: a stretch's mean has both, and a motion of either alone is off by one rad/s.
  const double value = spread(swings(std::vector<double>(60, 0.05), 0.001)).value();
  EXPECT_GT(value, 0.001);
  EXPECT_LT(value, 0.0015);
}

TEST(FrictionSpread, IsNotToldByFewStretches) {
  EXPECT_FALSE(spread(swings({0.05, 0.05, 0.05, 0.05})));
  AxisLog without;
  EXPECT_FALSE(friction_spread({without}, {swings(std::vector<double>(60, 0.05))}, {0.05, -0.05}));
}

}  // namespace
}  // namespace capstan::tools
