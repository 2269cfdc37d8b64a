// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/given_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace capstan::tools {
namespace {

constexpr double kRateHz = 200.0;
constexpr double kHertz = 2.3;
constexpr double kOmega = 2.0 * 3.14159265358979 * kHertz;

/// A sine whose reversals fall between samples, and an effort in proportion to its acceleration.
auto sine_log() -> AxisLog {
  constexpr Eigen::Index kRows = 1000;
  AxisLog log;
  log.period_s = 1.0 / kRateHz;
  log.time_s = Eigen::VectorXd::LinSpaced(kRows, 0.0, (kRows - 1) * log.period_s);
  log.q1_rad = (kOmega * log.time_s.array() + 0.4).sin();
  log.tau_nm = Eigen::VectorXd::Zero(kRows);
  log.effort = -kOmega * kOmega * 0.01 * log.q1_rad;
  return log;
}

TEST(GivenMotion, AccelerationOfASineHasNoLagAndNoLoss) {
  const AxisLog log = sine_log();
  const auto samples = given_motion(log, {}, {}).samples;
  for (std::size_t i = 3; i + 3 < samples.size(); ++i) {
    const double exact = -kOmega * kOmega * log.q1_rad[static_cast<Eigen::Index>(i)];
    // (w dt)^4 / 90 of the amplitude.
    ASSERT_NEAR(1000.0 * samples[i].ddq1, exact, kOmega * kOmega * std::pow(kOmega / kRateHz, 4) / 80.0) << i;
  }
}

TEST(GivenMotion, TheDirectionTurnsAtTheSampleWhereTheSpeedDoes) {
  const AxisLog log = sine_log();
  const auto samples = given_motion(log, {}, {}).samples;
  int reversals = 0;
  for (std::size_t i = 200; i + 10 < samples.size(); ++i) {
    const double time = log.time_s[static_cast<Eigen::Index>(i)];
    const double speed = std::cos(kOmega * time + 0.4);
    if (std::fabs(speed) > 0.6 * kOmega / kRateHz) {  // more than about half a sample away
      ASSERT_EQ(samples[i].forward, speed > 0.0) << i;
    }
    reversals += samples[i].forward != samples[i - 1].forward ? 1 : 0;
  }
  EXPECT_GE(reversals, 16);
}

TEST(EffortSmoothing, IsLongerWhereTheEffortIsNoisyAndNeverBeyondFifteenMilliseconds) {
  AxisLog log = sine_log();
  const Eigen::Index clean = effort_smoothing({log}, {});
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    log.effort[i] += (i % 2 == 0 ? 1.0 : -1.0) * 0.5;  // of an effort of 1.5 rms
  }
  const Eigen::Index noisy = effort_smoothing({log}, {});
  EXPECT_GT(noisy, clean);
  EXPECT_LE(noisy, static_cast<Eigen::Index>(0.015 * kRateHz));
}

// Inertia times the noise of a coarse encoder's acceleration is 2 % of the effort after 15 ms, too, and no noise of the
// effort: averaging goes on until it is the smaller of the two.
TEST(EffortSmoothing, GoesOnWhereTheEncoderHasMoreNoiseThanTheEffort) {
  AxisLog log = sine_log();
  const double step = 2.0 * 3.14159265358979 / 4096.0;
  log.q1_rad = log.q1_rad.unaryExpr([step](double angle) { return std::round(angle / step) * step; });
  const AngleNoise noise{0.0, step};
  const auto in_ms = [](Eigen::Index samples) { return 1e3 / kRateHz * static_cast<double>(samples); };
  const Eigen::Index coarse = effort_smoothing({log}, noise);
  EXPECT_GT(in_ms(coarse), 15.0);
  EXPECT_LE(in_ms(coarse), 40.0);
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    log.effort[i] += (i % 2 == 0 ? 1.0 : -1.0) * 0.5;
  }
  EXPECT_LE(in_ms(effort_smoothing({log}, noise)), 15.0);
}

}  // namespace
}  // namespace capstan::tools
