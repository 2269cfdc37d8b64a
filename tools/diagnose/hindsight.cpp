// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnose/hindsight.hpp"

#include <algorithm>
#include <cmath>

#include "tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// The last sample before a switch at which the motor still stood at the extreme of its stroke, within the noise.
auto turning_point(const AxisLog& log, std::size_t stroke_begin, std::size_t noticed, bool was_forward, double noise_rad)
    -> std::size_t {
  const double sign = was_forward ? 1.0 : -1.0;
  double extreme = sign * log.q1_rad[static_cast<Eigen::Index>(noticed)];
  for (std::size_t i = stroke_begin; i < noticed; ++i) {
    extreme = std::max(extreme, sign * log.q1_rad[static_cast<Eigen::Index>(i)]);
  }
  std::size_t turn = noticed;
  while (turn > stroke_begin && sign * log.q1_rad[static_cast<Eigen::Index>(turn)] < extreme - noise_rad) {
    --turn;
  }
  return turn;
}

}  // namespace

auto rate_half_window(const AxisLog& log, const AngleNoise& noise) -> Eigen::Index {
  constexpr double kNoiseShare = 0.02;
  constexpr double kLongestS = 0.025;
  const double sigma = std::hypot(noise.white_rad, noise.step_rad / std::sqrt(12.0));
  const double speed = rms(local_slope(log.q1_rad, std::max<Eigen::Index>(1, std::lround(0.02 / log.period_s)), log.period_s));
  const auto longest = std::max<Eigen::Index>(1, std::lround(kLongestS / log.period_s));
  Eigen::Index half = 1;
  // Variance of the slope of 2h + 1 equally spaced points: 3 sigma^2 / (h (h + 1) (2 h + 1) dt^2).
  auto slope_noise = [&](Eigen::Index h) {
    const auto x = static_cast<double>(h);
    return sigma / log.period_s * std::sqrt(3.0 / (x * (x + 1.0) * (2.0 * x + 1.0)));
  };
  while (half < longest && slope_noise(half) > kNoiseShare * speed) {
    ++half;
  }
  return half;
}

auto local_slope(const Eigen::VectorXd& signal, Eigen::Index half_window, double period_s) -> Eigen::VectorXd {
  const Eigen::Index n = signal.size();
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index h = std::min({half_window, i, n - 1 - i});
    double weighted = 0.0;
    for (Eigen::Index k = 1; k <= h; ++k) {
      weighted += static_cast<double>(k) * (signal[i + k] - signal[i - k]);
    }
    const auto x = static_cast<double>(h);
    slope[i] = h > 0 ? weighted / (period_s * x * (x + 1.0) * (2.0 * x + 1.0) / 3.0) : 0.0;
  }
  if (n > 2) {
    slope[0] = slope[1];
    slope[n - 1] = slope[n - 2];
  }
  return slope;
}

auto hindsight_samples(const AxisLog& log, const ConditionerShape<double>& conditioner, const AngleNoise& noise) -> Samples {
  Samples samples = causal_samples(log, conditioner);
  const Eigen::VectorXd rate = local_slope(log.q1_rad, rate_half_window(log, noise), log.period_s);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].dq1 = rate[static_cast<Eigen::Index>(i)];
  }
  const double at_rest = std::max(1.01 * noise.step_rad, 3.0 * (noise.step_rad > 0.0 ? 0.0 : noise.white_rad));
  std::size_t stroke_begin = 0;
  for (const std::size_t noticed : direction_changes(samples)) {
    const bool was_forward = samples[noticed - 1].forward;
    for (std::size_t i = turning_point(log, stroke_begin, noticed, was_forward, at_rest) + 1; i < noticed; ++i) {
      samples[i].forward = !was_forward;
    }
    stroke_begin = noticed;
  }
  return samples;
}

}  // namespace capstan::tools
