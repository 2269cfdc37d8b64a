// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/noncausal_samples.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// Where a reversal happened.
struct Turn {
  Eigen::Index start = 0;  ///< estimate of the first sample of the new direction
  RowRange uncertain;
};

/// Finds a reversal between the begin of a stroke and the sample at which the causal switch noticed it. The motor
/// leaves its extreme like x ~ t^2, so it takes as long from rest to the first distance that can be seen as from there
/// to four times that. A motor that sets off more gently has turned earlier, so the doubt reaches four times as far
/// back.
auto find_turn(const AxisLog& log, RowRange stroke, bool was_forward, double visible_rad) -> Turn {
  const double sign = was_forward ? 1.0 : -1.0;
  auto height = [&](Eigen::Index i) { return sign * log.q1_rad[i]; };
  double extreme = height(stroke.end);
  for (Eigen::Index i = stroke.begin; i < stroke.end; ++i) {
    extreme = std::max(extreme, height(i));
  }
  Eigen::Index last = stroke.end;  // sample still at the extreme
  while (last > stroke.begin && height(last) < extreme - visible_rad) {
    --last;
  }
  Eigen::Index away = last;
  while (away + 1 < log.samples() && height(away) > extreme - 4.0 * visible_rad) {
    ++away;
  }
  Eigen::Index first = last;
  while (first > stroke.begin && height(first - 1) >= extreme - visible_rad) {
    --first;
  }
  const Eigen::Index seeing = std::max<Eigen::Index>(away - last, 1);
  return {std::max(last - seeing, first) + 1, {std::max(last - 4 * seeing, first), last + 1}};
}

/// The motor angle between the encoder's counts: straight lines through the edges that it crossed, each halfway between
/// two samples, and never further from a count than half a step. Slow motions show far less of the steps so.
auto between_counts(const Eigen::VectorXd& q1, double step_rad) -> Eigen::VectorXd {
  if (step_rad <= 0.0) {
    return q1;
  }
  Eigen::VectorXd angle = q1;
  Eigen::Index entered = 0;  // first sample of the count that it is at
  for (Eigen::Index i = 1; i < q1.size(); ++i) {
    if (std::abs(q1[i] - q1[i - 1]) < 0.5 * step_rad) {
      continue;
    }
    const double left = 0.5 * (q1[i - 1] + q1[i]);
    // Several counts at a time: there is nothing in between, and a mean of neighbours would only cut corners.
    const bool fast = i - entered == 1 && entered > 0 && std::abs(q1[i] - q1[i - 2]) > 3.5 * step_rad;
    for (Eigen::Index k = entered; entered > 0 && !fast && k < i; ++k) {
      const double came = 0.5 * (q1[entered - 1] + q1[entered]);
      const double share = (static_cast<double>(k - entered) + 0.5) / static_cast<double>(i - entered);
      angle[k] = std::clamp(came + share * (left - came), q1[k] - 0.5 * step_rad, q1[k] + 0.5 * step_rad);
    }
    entered = i;
  }
  return angle;
}

/// Torque up to a sample, averaged so that one noisy value does not stand for the reversal.
auto torque_near(const AxisLog& log, Eigen::Index at) -> double {
  const auto reach = std::max<Eigen::Index>(1, std::lround(0.005 / log.period_s));
  const Eigen::Index begin = std::max<Eigen::Index>(0, at - reach);
  const Eigen::Index end = std::min(log.samples(), at + 1);
  return log.tau_nm.segment(begin, end - begin).mean();
}

/// Angle and torque of the last reversal, where the direction is known to turn.
void remember_reversals(const AxisLog& log, Samples& samples) {
  double tau = torque_near(log, 0);
  double q1 = log.q1_rad[0];
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i > 0 && samples[i].forward != samples[i - 1].forward) {
      tau = torque_near(log, static_cast<Eigen::Index>(i));
      q1 = samples[i].q1;
    }
    samples[i].tau_reversal = tau;
    samples[i].q1_reversal = q1;
  }
}

/// Standard deviation of a slope of slopes per standard deviation of white noise in the signal, 1/s2.
auto noise_of_second_slope(Eigen::Index half_window, double period_s) -> double {
  const auto h = static_cast<double>(half_window);
  const Eigen::VectorXd weights =
      Eigen::VectorXd::LinSpaced(2 * half_window + 1, -h, h) * (3.0 / (h * (h + 1.0) * (2.0 * h + 1.0) * period_s));
  double energy = 0.0;
  for (Eigen::Index shift = -2 * half_window; shift <= 2 * half_window; ++shift) {
    const Eigen::Index overlap = weights.size() - std::abs(shift);
    const double product = shift < 0 ? weights.head(overlap).dot(weights.head(overlap).reverse())
                                     : weights.tail(overlap).dot(weights.tail(overlap).reverse());
    energy += product * product;
  }
  return std::sqrt(energy);
}

/// Second derivative, per second squared: the slope of slopes.
auto second_slope(const Eigen::VectorXd& signal, Eigen::Index half_window, double period_s) -> Eigen::VectorXd {
  return local_slope(local_slope(signal, half_window, period_s), half_window, period_s);
}

/// Half width, in samples, of the two windows for the acceleration, as wide as its noise demands. What trembles with
/// the encoder's last digit would speak for the opposite sign of any effect of it, because the angle in the law
/// trembles alike.
auto acceleration_half_window(const AxisLog& log, const AngleNoise& noise) -> Eigen::Index {
  constexpr double kNoiseShare = 0.05;
  constexpr double kLongestS = 0.06;
  const double sigma = std::hypot(noise.white_rad, noise.step_rad / std::sqrt(12.0));
  const auto longest = std::max<Eigen::Index>(1, std::lround(kLongestS / log.period_s));
  for (Eigen::Index half = 1;; half = std::min(longest, half + std::max<Eigen::Index>(1, half / 4))) {
    const double noise_left = sigma * noise_of_second_slope(half, log.period_s);
    if (half == longest || noise_left <= kNoiseShare * rms(second_slope(log.q1_rad, half, log.period_s))) {
      return half;
    }
  }
}

/// What has this rate, from a start on.
auto summed(const Eigen::VectorXd& rate, double start, double period_s) -> Eigen::VectorXd {
  Eigen::VectorXd sum(rate.size());
  double here = start;
  for (Eigen::Index i = 0; i < rate.size(); ++i) {
    here += i > 0 ? 0.5 * period_s * (rate[i - 1] + rate[i]) : 0.0;
    sum[i] = here;
  }
  return sum;
}

/// The angle once more through an encoder of this step, whose edges lie elsewhere.
auto counted_again(const Eigen::VectorXd& angle, double step_rad) -> Eigen::VectorXd {
  if (step_rad <= 0.0) {
    return angle;
  }
  const double shift = 0.5 * step_rad + angle[0] - step_rad * std::round(angle[0] / step_rad);
  return ((angle.array() - shift) / step_rad).round() * step_rad + shift;
}

}  // namespace

auto rate_half_window(const AxisLog& log, const AngleNoise& noise) -> Eigen::Index {
  constexpr double kNoiseShare = 0.02;
  constexpr double kLongestS = 0.025;
  const double sigma = std::hypot(noise.white_rad, noise.step_rad / std::sqrt(12.0));
  const double speed =
      rms(local_slope(log.q1_rad, std::max<Eigen::Index>(1, std::lround(0.02 / log.period_s)), log.period_s));
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

auto noncausal_samples(const AxisLog& log, const ConditionerShape<double>& conditioner, const AngleNoise& noise)
    -> NoncausalSamples {
  NoncausalSamples result{causal_samples(log, conditioner), {}, {}, {}, {}};
  const auto changes = direction_changes(result.samples);
  constexpr double kKiloRadPerRad = 1e-3;
  const Eigen::Index half_window = rate_half_window(log, noise);
  const Eigen::VectorXd angle = between_counts(log.q1_rad, noise.step_rad);
  const Eigen::VectorXd rate = local_slope(log.q1_rad, half_window, log.period_s);
  const Eigen::Index wide = acceleration_half_window(log, noise);
  const Eigen::VectorXd acceleration = second_slope(log.q1_rad, wide, log.period_s);
  for (std::size_t i = 0; i < result.samples.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    set_motion(result.samples[i], angle[row], rate[row]);
    result.samples[i].ddq1 = kKiloRadPerRad * acceleration[row];
    result.samples[i].tau_late = result.samples[i].tau;  // nothing is late
  }
  const double visible = noise.step_rad > 0.0 ? 1.01 * noise.step_rad : 3.0 * noise.white_rad;
  Eigen::Index stroke_begin = 0;
  for (const std::size_t change : changes) {
    const auto noticed = static_cast<Eigen::Index>(change);
    const bool was_forward = !result.samples[change].forward;
    const Turn turn = find_turn(log, {stroke_begin, noticed}, was_forward, visible);
    for (Eigen::Index i = turn.start; i < noticed; ++i) {
      result.samples[static_cast<std::size_t>(i)].forward = !was_forward;
    }
    if (visible > 0.0) {
      result.uncertain.push_back(turn.uncertain);
    }
    stroke_begin = noticed;
  }
  for (auto& sample : result.samples) {
    sample.course_late = sample.forward ? 1.0 : -1.0;
    sample.advance_late = sample.advance;
    sample.late_gain = 0.0;
  }
  remember_reversals(log, result.samples);
  result.hidden_rad = between_counts(counted_again(angle, noise.step_rad), noise.step_rad) - angle;
  const Eigen::VectorXd by_rate = summed(rate, angle[0], log.period_s);
  result.hidden_rate = local_slope(counted_again(by_rate, noise.step_rad), half_window, log.period_s) - rate;
  const Eigen::VectorXd by_acceleration = summed(summed(acceleration, rate[0], log.period_s), angle[0], log.period_s);
  result.hidden_acceleration =
      kKiloRadPerRad *
      (second_slope(counted_again(by_acceleration, noise.step_rad), wide, log.period_s) - acceleration);
  return result;
}

auto ahead_by(double rows, const Eigen::Ref<const Eigen::VectorXd>& signal) -> Eigen::VectorXd {
  const auto whole = static_cast<Eigen::Index>(rows);
  const double rest = rows - static_cast<double>(whole);
  const Eigen::Index last = signal.size() - 1;
  Eigen::VectorXd ahead(signal.size());
  for (Eigen::Index i = 0; i <= last; ++i) {
    const double now = signal[std::min(i + whole, last)];
    ahead[i] = now + rest * (signal[std::min(i + whole + 1, last)] - now);
  }
  return ahead;
}

auto doubtful_rows(const Samples& running, const NoncausalSamples& afterwards) -> Blocks {
  std::vector<bool> doubtful(running.size());
  std::transform(running.begin(), running.end(), afterwards.samples.begin(), doubtful.begin(),
                 [](const auto& now, const auto& later) { return now.forward != later.forward; });
  for (const auto& rows : afterwards.uncertain) {
    std::fill(doubtful.begin() + rows.begin, doubtful.begin() + rows.end, true);
  }
  Blocks blocks;
  for (auto begin = std::find(doubtful.begin(), doubtful.end(), true); begin != doubtful.end();) {
    const auto end = std::find(begin, doubtful.end(), false);
    blocks.push_back({begin - doubtful.begin(), end - doubtful.begin()});
    begin = std::find(end, doubtful.end(), true);
  }
  return blocks;
}

}  // namespace capstan::tools
