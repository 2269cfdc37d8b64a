// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/response/response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "capstan/tools/response/periods.hpp"

namespace capstan::tools {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// Numbers that decide, chosen in November 2026 on logs of the simulated forceps, seeds 1 to 3, 11 to 15 and 33; what
// response_on_plant_test and docs/tuning.md report of margins is of seeds 31 and 32.
constexpr std::size_t kLeastWindows = 4;  // for a spread that means anything
constexpr double kExcited = 0.1;          // of the strongest line, or of a chirp's strongest octave
constexpr std::size_t kLeastBins = 8;     // of a chirp in one point
constexpr double kOctaveShare = 1.0 / 6.0;
// Of the square by which noise makes two ways differ: six of seven lines that are alike differ by less. Chosen
// 29 November 2026 on elbows 4400 to 4407.
constexpr double kAgrees = 2.0;

auto signals_of(const ResponseLog& log, bool on_torque) -> Signals {
  return {on_torque ? &log.excitation_nm : &log.reference_rad, &log.torque_nm, &log.q1_rad, &log.q2_rad};
}

/// Radius of the circle that holds the mean of M complex values with probability 0.95, in standard errors: the root of
/// the quantile of F(2, 2 M - 2), which has a closed form.
auto circle95(std::size_t count) -> double {
  const double half = static_cast<double>(count) - 1.0;
  return std::sqrt(half * (std::pow(0.05, -1.0 / half) - 1.0));
}

/// out / in by way of what shakes, over windows or bins.
auto ratio_of(const std::vector<Spectra>& all, Signal out, Signal in) -> Estimate {
  Complex over{};
  Complex under{};
  double shaken = 0.0;
  for (const Spectra& one : all) {
    over += one[out] * std::conj(one[kShaken]);
    under += one[in] * std::conj(one[kShaken]);
    shaken += std::norm(one[kShaken]);
  }
  Estimate estimate{.value = over / under};
  double left = 0.0;
  for (const Spectra& one : all) {
    left += std::norm(one[out] - estimate.value * one[in]);
  }
  const double variance = left / static_cast<double>(all.size() - 1) * shaken / std::norm(under);
  estimate.radius95 = circle95(all.size()) * std::sqrt(variance);
  return estimate;
}

auto coherence_of(const std::vector<Spectra>& all, Signal a) -> double {
  Complex cross{};
  double own = 0.0;
  double shaken = 0.0;
  for (const Spectra& one : all) {
    cross += one[a] * std::conj(one[kShaken]);
    own += std::norm(one[a]);
    shaken += std::norm(one[kShaken]);
  }
  return own * shaken > 0.0 ? std::norm(cross) / (own * shaken) : 0.0;
}

auto point_of(double hz, const std::vector<Spectra>& all, bool on_torque) -> ResponsePoint {
  ResponsePoint point{.hz = hz};
  point.motor = ratio_of(all, kMotor, kTorque);
  point.joint = ratio_of(all, kJoint, kMotor);
  if (on_torque) {
    point.loop = ratio_of(all, kShaken, kTorque);  // u = d - L u
    point.loop.value -= 1.0;
  }
  point.coherence = std::min(coherence_of(all, kTorque), coherence_of(all, kMotor));
  return point;
}

auto mean_power(const std::vector<Spectra>& all, Signal signal) -> double {
  double sum = 0.0;
  for (const Spectra& one : all) {
    sum += std::norm(one[signal]);
  }
  return sum / static_cast<double>(all.size());
}

/// Power of what repeats, without bias (so it may be below 0), and of what does not in a mean over the windows.
auto repeating_power(const std::vector<Spectra>& all, Signal signal) -> std::array<double, 2> {
  Complex mean{};
  for (const Spectra& one : all) {
    mean += one[signal];
  }
  const auto count = static_cast<double>(all.size());
  mean /= count;
  const double scatter = (mean_power(all, signal) - std::norm(mean)) / (count - 1.0);
  return {std::norm(mean) - scatter, scatter};
}

auto distortion_of(const Periods& periods, const std::vector<std::size_t>& lines, const Signals& signals)
    -> Distortion {
  std::vector<double> power;
  for (const std::size_t line : lines) {
    power.push_back(mean_power(periods.at(line, signals), kMotor));
  }
  std::array<double, 2> sums{};
  std::array<int, 2> counts{};
  double noise = 0.0;
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
    for (std::size_t h = lines[i] + 1; h < std::min(lines[i + 1], lines[i] + 9); ++h) {
      const auto [repeats, rest] = repeating_power(periods.at(h, signals), kMotor);
      const double beside = std::sqrt(power[i] * power[i + 1]);
      sums[h % 2] += repeats / beside;
      noise += rest / beside;
      ++counts[h % 2];
    }
  }
  if (counts[0] == 0 || counts[1] == 0) {
    return {};
  }
  return {.known = true,
          .even = std::sqrt(std::max(0.0, sums[0] / counts[0])),
          .odd = std::sqrt(std::max(0.0, sums[1] / counts[1])),
          .noise = std::sqrt(noise / (counts[0] + counts[1]))};
}

/// Rms rate of the motor at the lines that shake, rad/s.
auto shake_rate(const Periods& periods, const std::vector<std::size_t>& lines, const Signals& signals) -> double {
  double power = 0.0;
  for (const std::size_t line : lines) {
    const double way = std::max(0.0, repeating_power(periods.at(line, signals), kMotor)[0]);
    power += 0.5 * way * std::pow(kTwoPi * 1e3 * static_cast<double>(line) / kMultisinePeriodMs, 2);
  }
  return std::sqrt(power);
}

auto lines_of(const Periods& periods, const Signals& signals) -> std::vector<std::size_t> {
  std::vector<double> power(kMultisinePeriodMs / 2);
  for (std::size_t h = 1; h < power.size(); ++h) {
    power[h] = periods.shaken_power(h, *signals[kShaken]);
  }
  const double least = kExcited * kExcited * *std::max_element(power.begin(), power.end());
  std::vector<std::size_t> lines;
  for (std::size_t h = 1; h < power.size(); ++h) {
    if (power[h] > least) {
      lines.push_back(h);
    }
  }
  return lines;
}

/// Where the ways do not differ by more than noise, both are the response of all periods, with its smaller circle.
void share_what_agrees(Response& response) {
  for (std::size_t i = 0; i < response.points.size() && !response.ways.empty(); ++i) {
    ResponsePoint& a = response.ways[0].points[i];
    ResponsePoint& b = response.ways[1].points[i];
    if (std::norm(a.motor.value - b.motor.value) < kAgrees * noise_between(a.motor, b.motor)) {
      a = b = response.points[i];
    }
  }
}

auto estimate_multisine(const ResponseLog& log, Response response) -> Response {
  Periods periods(log, response.on_torque);
  response.windows = periods.count();
  response.travels = periods.travels();
  if (periods.count() < kLeastWindows) {
    throw Refusal(log.name + ": has " + std::to_string(periods.count()) +
                  " whole periods of 2.048 s in which the joint goes one way, and the noise is told from " +
                  std::to_string(kLeastWindows) +
                  "; shake for longer, and give a joint that travels legs (2 travel / speed) of 3 s or more");
  }
  const auto signals = signals_of(log, response.on_torque);
  const std::vector<std::size_t> lines = lines_of(periods, signals);
  if (response.travels) {
    periods.find_slopes(lines, signals);
    response.backward_nm = periods.mean_torque(false);
    response.forward_nm = periods.mean_torque(true);
    response.motor_speed_rad_s = periods.mean_speed();
    response.motor_shake_rad_s = shake_rate(periods, lines, signals);
  }
  response.distortion = distortion_of(periods, lines, signals);
  const auto over = [&](const Periods& some, Response one) {
    one.windows = some.count();
    for (const std::size_t line : lines) {
      one.points.push_back(
          point_of(1e3 * static_cast<double>(line) / kMultisinePeriodMs, some.at(line, signals, true), one.on_torque));
    }
    return one;
  };
  if (response.travels) {
    const Periods backward = periods.going(false);
    const Periods forward = periods.going(true);
    if (std::min(backward.count(), forward.count()) >= kLeastWindows) {
      const auto by_name = [&](const Periods& way, const char* name) {
        Response one = response;
        one.name += name;
        return over(way, std::move(one));
      };
      response.ways = {by_name(backward, ", backward"), by_name(forward, ", forward")};
    }
  }
  response = over(periods, std::move(response));
  share_what_agrees(response);
  return response;
}

/// The next length that a fast transform likes; a few rows of zeros more.
auto smooth_length(Eigen::Index rows) -> Eigen::Index {
  const auto is_smooth = [](Eigen::Index n) {
    for (const Eigen::Index factor : {2, 3, 5}) {
      while (n % factor == 0) {
        n /= factor;
      }
    }
    return n == 1;
  };
  while (!is_smooth(rows)) {
    ++rows;
  }
  return rows;
}

/// A sweep begins and ends at rest, so its spectrum is that of the whole log; points are means over neighbouring bins.
auto estimate_chirp(const ResponseLog& log, Response response) -> Response {
  response.windows = 1;
  const auto signals = signals_of(log, response.on_torque);
  const Eigen::Index rows = log.time_s.size();
  const double period_s = (log.time_s[rows - 1] - log.time_s[0]) / static_cast<double>(rows - 1);
  const Eigen::Index padded = smooth_length(rows);
  const double resolution = 1.0 / (static_cast<double>(padded) * period_s);
  const auto bins = static_cast<std::size_t>(0.45 / period_s / resolution);
  std::vector<Spectra> all(bins);
  Eigen::FFT<double> transform;
  for (std::size_t s = 0; s < kSignals; ++s) {
    const Eigen::VectorXd& x = *signals[s];
    const double slope = (x[rows - 1] - x[0]) / static_cast<double>(rows - 1);
    std::vector<double> rest(static_cast<std::size_t>(padded), 0.0);
    for (Eigen::Index i = 0; i < rows; ++i) {
      rest[static_cast<std::size_t>(i)] = x[i] - x[0] - slope * static_cast<double>(i);
    }
    std::vector<Complex> spectrum;
    transform.fwd(spectrum, rest);
    for (std::size_t k = 1; k < bins; ++k) {
      all[k][s] = spectrum[k];
    }
  }
  double most = 0.0;  // each octave takes as long, so a sweep's power falls as 1 / f, and what leaks beside it more
  for (std::size_t k = 1; k < bins; ++k) {
    most = std::max(most, static_cast<double>(k) * std::norm(all[k][kShaken]));
  }
  for (std::size_t k = 1; k < bins;) {
    const auto width = static_cast<std::size_t>(static_cast<double>(k) * (std::exp2(kOctaveShare) - 1.0));
    const std::size_t next = k + std::max(kLeastBins, width);
    if (next > bins) {
      break;
    }
    const std::vector<Spectra> some(all.begin() + static_cast<std::ptrdiff_t>(k),
                                    all.begin() + static_cast<std::ptrdiff_t>(next));
    const auto is_shaken = [&](const Spectra& one) {
      return static_cast<double>(k) * std::norm(one[kShaken]) > kExcited * kExcited * most;
    };
    if (std::all_of(some.begin(), some.end(), is_shaken)) {
      const double hz = resolution * 0.5 * static_cast<double>(k + next - 1);
      response.points.push_back(point_of(hz, some, response.on_torque));
    }
    k = next;
  }
  return response;
}

}  // namespace

auto estimate_response(const ResponseLog& log) -> Response {
  Response response{.name = log.name, .points = {}, .distortion = {}};
  response.on_torque = log.excitation_nm.cwiseAbs().maxCoeff() > 0.0;
  require_signals(log, response.on_torque);
  response.multisine = is_multisine(response.on_torque ? log.excitation_nm : log.reference_rad);
  return response.multisine ? estimate_multisine(log, std::move(response)) : estimate_chirp(log, std::move(response));
}

}  // namespace capstan::tools
