// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/given_motion.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

constexpr double kLongestS = 0.015;
constexpr double kLongestForAccelerationS = 0.04;

/// Moves reversals to where the speed passes zero, if it does so once within a few samples: dry friction jumps there.
void sharpen_reversals(Samples& samples) {
  constexpr std::size_t kReach = 4;
  for (const std::size_t change : direction_changes(samples)) {
    if (change < kReach || change + kReach >= samples.size()) {
      continue;
    }
    const bool forward = samples[change].forward;
    std::size_t turn = 0;
    std::size_t turns = 0;
    for (std::size_t i = change - kReach + 1; i <= change + kReach; ++i) {
      if ((samples[i].dq1 > 0.0) != (samples[i - 1].dq1 > 0.0)) {
        turn = i;
        ++turns;
      }
    }
    if (turns == 1 && (samples[turn].dq1 > 0.0) == forward) {
      for (std::size_t i = change - kReach; i <= change + kReach; ++i) {
        samples[i].forward = i < turn ? !forward : forward;
      }
    }
  }
}

/// Second derivative by five points, right to (w dt)^4 / 90 at a frequency w; at the ends that of the neighbour.
auto second_difference(const Eigen::VectorXd& signal, double period_s) -> Eigen::VectorXd {
  const Eigen::Index n = signal.size();
  Eigen::VectorXd result = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 2; i + 2 < n; ++i) {
    result[i] = (-signal[i - 2] + 16.0 * signal[i - 1] - 30.0 * signal[i] + 16.0 * signal[i + 1] - signal[i + 2]) /
                (12.0 * period_s * period_s);
  }
  if (n > 4) {
    result.head(2).setConstant(result[2]);
    result.tail(2).setConstant(result[n - 3]);
  }
  return result;
}

auto motor_angles(const Samples& samples) -> Eigen::VectorXd {
  Eigen::VectorXd angle(static_cast<Eigen::Index>(samples.size()));
  std::transform(samples.begin(), samples.end(), angle.begin(), [](const auto& sample) { return sample.q1; });
  return angle;
}

void set_acceleration(double period_s, Samples& samples) {
  constexpr double kKilo = 1e-3;
  const Eigen::VectorXd acceleration = second_difference(motor_angles(samples), period_s);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].ddq1 = kKilo * acceleration[static_cast<Eigen::Index>(i)];
  }
}

auto twice_averaged(const Eigen::VectorXd& signal, Eigen::Index half) -> Eigen::VectorXd {
  const std::vector<Eigen::Index> rows = {signal.size()};
  return moving_mean(moving_mean(signal, rows, half), rows, half);
}

auto samples_in(double time_s, double period_s) -> Eigen::Index {
  return std::max<Eigen::Index>(1, static_cast<Eigen::Index>(time_s / period_s));
}

/// Share of the speed's energy that is left by an average.
auto motion_kept(const std::vector<AxisLog>& logs, const AngleNoise& noise, Eigen::Index half) -> double {
  double before = 0.0;
  double after = 0.0;
  for (const auto& log : logs) {
    const Eigen::VectorXd speed = local_slope(log.q1_rad, rate_half_window(log, noise), log.period_s);
    before += speed.squaredNorm();
    after += twice_averaged(speed, half).squaredNorm();
  }
  return after / before;
}

/// Inertia by a first fit of inertia and drag, averaged as far as may be.
auto rough_inertia(const AxisLog& log, const AngleNoise& noise, Eigen::Index half) -> double {
  Eigen::MatrixXd motion(log.samples(), 2);
  motion.col(0) = twice_averaged(second_difference(log.q1_rad, log.period_s), half);
  motion.col(1) = twice_averaged(local_slope(log.q1_rad, rate_half_window(log, noise), log.period_s), half);
  const Eigen::VectorXd rigid = motion.colPivHouseholderQr().solve(twice_averaged(log.measured(), half));
  return std::max(0.0, rigid[0]);
}

/// From `half` on, the first average that leaves little noise in one log. An average is shared by effort and law, so it
/// costs nothing but what is faster; the acceleration's noise falls by it as the width to the power of 2.5, the
/// effort's as its root. It is no noise of the effort, and a law would be asked for what makes it: so it has to be the
/// smaller.
auto against_noise(const AxisLog& log, const AngleNoise& noise, Eigen::Index half, Eigen::Index longest)
    -> Eigen::Index {
  constexpr double kNoiseShare = 0.02;
  constexpr double kOfTheEfforts = 0.5;
  constexpr double kNegligibleShare = 5e-4;  // where the effort has next to no noise
  const double size = rms(log.measured());
  // A fast motion in few samples is no noise.
  const double white = std::min(noise.white_rad, fast_noise_level(log.q1_rad));
  const double by_inertia = rough_inertia(log, noise, longest) * std::hypot(white, noise.step_rad / std::sqrt(12.0));
  const double own = white_noise_level(log.measured());
  const Eigen::Index farthest = samples_in(kLongestForAccelerationS, log.period_s);
  // What unit noise becomes is the root of the squares of what a unit impulse becomes.
  const Eigen::Index reach = 2 * farthest + 4;
  const Eigen::VectorXd impulse = Eigen::VectorXd::Unit(2 * reach + 1, reach);
  const Eigen::VectorXd rated = second_difference(impulse, log.period_s);
  for (; half < farthest; ++half) {
    const double of_motion = by_inertia * twice_averaged(rated, half).norm();
    const double of_effort = own * twice_averaged(impulse, half).norm();
    const bool much = half < longest && std::max(of_motion, of_effort) > kNoiseShare * size;
    if (!much && of_motion <= std::max(kOfTheEfforts * of_effort, kNegligibleShare * size)) {
      break;
    }
  }
  return half;
}

}  // namespace

auto given_motion(const AxisLog& log, const ConditionerShape<double>& conditioner, const AngleNoise& noise)
    -> NoncausalSamples {
  NoncausalSamples result = noncausal_samples(log, conditioner, noise);
  set_acceleration(log.period_s, result.samples);
  sharpen_reversals(result.samples);
  return result;
}

auto motion_seen_again(const AxisLog& log, const NoncausalSamples& seen, const AngleNoise& noise) -> Samples {
  Samples samples = seen.samples;
  Eigen::VectorXd angle = motor_angles(samples) + seen.hidden_rad;
  if (noise.step_rad <= 0.0) {
    Random random(0xA1E);
    const double level = fast_noise_level(log.q1_rad);
    for (double& value : angle) {
      value += level * random.normal();
    }
  }
  const Eigen::VectorXd rate = local_slope(angle, rate_half_window(log, noise), log.period_s);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    set_motion(samples[i], angle[static_cast<Eigen::Index>(i)], rate[static_cast<Eigen::Index>(i)]);
  }
  set_acceleration(log.period_s, samples);
  return samples;
}

auto effort_smoothing(const std::vector<AxisLog>& logs, const AngleNoise& noise) -> Eigen::Index {
  constexpr double kKept = 0.9997;
  const Eigen::Index longest = samples_in(kLongestS, logs.front().period_s);
  Eigen::Index half = 0;
  while (half < longest && motion_kept(logs, noise, half + 1) >= kKept) {
    ++half;
  }
  for (const auto& log : logs) {
    half = against_noise(log, noise, half, longest);
  }
  return half;
}

}  // namespace capstan::tools
