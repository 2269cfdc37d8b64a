// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/conditioning.hpp"

#include <algorithm>

#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// One count back may be the encoder trembling on an edge; two are a motion.
constexpr double kStepsAboveResolution = 1.5;
/// One count back is a motion where no edge was seen to tremble: of this many crossed slowly, none (so less than 3 %
/// do).
constexpr double kStepsOfSteadyEdges = 0.75;
constexpr Eigen::Index kEdgesSeen = 100;
/// Two independent excursions of 4 standard deviations each way: one false switch in some 10^8 samples at rest.
constexpr double kDeviationsAboveNoise = 8.0;
constexpr double kLargestShareOfMotion = 0.02;
/// Half a step of the firmware's numbers would be no threshold at all.
constexpr double kSmallestThresholdRad = 1e-6;

/// A quantised signal's third difference shows its steps as noise: they are counted once.
auto threshold_above(double step_rad, double white_rad) -> double {
  const double white = step_rad > 0.0 && white_rad < step_rad ? 0.0 : white_rad;
  return std::max({kStepsAboveResolution * step_rad, kDeviationsAboveNoise * white, kSmallestThresholdRad});
}

/// Resolution of an encoder; none where its last digits tremble, for then no edge says where the motor is.
auto encoder_step(const Eigen::VectorXd& signal) -> double {
  constexpr double kMostBySteps = 0.9;
  const double step = quantisation_step(signal);
  return fast_noise_level(signal) > kMostBySteps * step ? 0.0 : step;
}

/// How often the direction switch of a threshold turns.
auto turns(const AxisLog& log, double threshold_rad) -> Eigen::Index {
  ConditionerShape<double> shape;
  shape.direction_threshold_rad = threshold_rad;
  SampleConditioner<double> conditioner(SamplePeriod<double>(log.period_s), shape);
  Eigen::Index count = 0;
  bool forward = conditioner.sample().forward;
  for (const double q1 : log.q1_rad) {
    const bool now = conditioner.update(q1, 0.0).forward;
    count += now != forward ? 1 : 0;
    forward = now;
  }
  return count;
}

/// Whether the encoder went one count back now and then without going on, or too few edges were crossed slowly to know.
auto edges_may_tremble(const std::vector<AxisLog>& logs, double step_rad) -> bool {
  Eigen::Index crossed = 0;
  for (const auto& log : logs) {
    if (turns(log, kStepsOfSteadyEdges * step_rad) != turns(log, kStepsAboveResolution * step_rad)) {
      return true;
    }
    const Eigen::ArrayXd moved = (log.q1_rad.tail(log.samples() - 1) - log.q1_rad.head(log.samples() - 1)).array();
    crossed += (moved.abs() > 0.5 * step_rad && moved.abs() < 1.5 * step_rad).count();
  }
  return crossed < kEdgesSeen;
}

/// Another axis in a slot of the coupling, its direction by a conditioner of its own.
void add_other_axis(const OtherAxis& other, std::size_t slot, double period_s, std::vector<Measured<double>>& series) {
  const double step = quantisation_step(other.q1_rad);
  const double white = white_noise_level(other.q1_rad);
  ConditionerShape<double> shape;
  shape.direction_threshold_rad = threshold_above(step, white);
  SampleConditioner<double> conditioner(SamplePeriod<double>(period_s), shape);
  for (std::size_t i = 0; i < series.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    series[i].others[slot] = {.q1 = other.q1_rad[row],
                              .tau = other.tau_nm[row],
                              .forward = conditioner.update(other.q1_rad[row], other.tau_nm[row]).forward};
  }
}

/// The joint angle as far as the usual law and the link's weight give it: what stands for the estimate that a running
/// law would have. The measured angle itself must not: a law could then copy what it is fitted to.
auto joint_by_motor(const AxisLog& log, const Samples& samples) -> Eigen::VectorXd {
  constexpr Eigen::Index kWithoutWeight = 4;
  constexpr int kRounds = 4;  // the weight acts at the angle that it changes
  Eigen::MatrixXd columns(log.samples(), kWithoutWeight + 2);
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    const bool forward = samples[static_cast<std::size_t>(i)].forward;
    const double tau = log.tau_nm[i];
    columns.row(i).head(kWithoutWeight) << log.q1_rad[i], 1.0, forward ? tau : 0.0, forward ? 0.0 : tau;
  }
  const auto fitted = [&](Eigen::Index count) -> Eigen::VectorXd {
    const auto used = columns.leftCols(count);
    const Eigen::MatrixXd gram = used.transpose() * used;
    return used * gram.completeOrthogonalDecomposition().solve(used.transpose() * log.q2_rad);
  };
  Eigen::VectorXd joint = fitted(kWithoutWeight);
  for (int round = 0; round < kRounds; ++round) {
    columns.rightCols(2) << joint.array().sin(), joint.array().cos();
    joint = fitted(columns.cols());
  }
  return joint;
}

}  // namespace

auto measured_series(const AxisLog& log) -> std::vector<Measured<double>> {
  std::vector<Measured<double>> series(static_cast<std::size_t>(log.samples()));
  for (std::size_t i = 0; i < series.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    series[i].q1 = log.q1_rad[row];
    series[i].tau = log.tau_nm[row];
    if (log.temperature_c.size() > 0) {
      series[i].temperature = log.temperature_c[row];
    }
  }
  for (std::size_t slot = 0; slot < std::min(kMostOthers, log.others.size()); ++slot) {
    add_other_axis(log.others[slot], slot, log.period_s, series);
  }
  return series;
}

auto causal_samples(const AxisLog& log, const ConditionerShape<double>& shape) -> Samples {
  SampleConditioner<double> conditioner(SamplePeriod<double>(log.period_s), shape);
  Samples samples;
  samples.reserve(static_cast<std::size_t>(log.samples()));
  for (const Measured<double>& now : measured_series(log)) {
    conditioner.update(now);
    conditioner.delay_torque();
    samples.push_back(conditioner.sample());
  }
  if (log.q2_rad.size() > 0) {
    const Eigen::VectorXd joint = joint_by_motor(log, samples);
    for (std::size_t i = 0; i < samples.size(); ++i) {  // of now: one sample back may be many of the board's cycles
      samples[i].q2 = joint[static_cast<Eigen::Index>(i)];
    }
  }
  return samples;
}

auto motor_angle_noise(const std::vector<AxisLog>& logs) -> AngleNoise {
  AngleNoise noise;
  for (const auto& log : logs) {
    noise.step_rad = std::max(noise.step_rad, encoder_step(log.q1_rad));
    noise.white_rad = std::max(noise.white_rad, white_noise_level(log.q1_rad));
  }
  return noise;
}

auto direction_thresholds(const std::vector<AxisLog>& logs, const AngleNoise& noise) -> std::vector<double> {
  double range = 0.0;
  for (const auto& log : logs) {
    range = std::max(range, log.q1_rad.maxCoeff() - log.q1_rad.minCoeff());
  }
  const double largest = kLargestShareOfMotion * range;
  double threshold = threshold_above(noise.step_rad, noise.white_rad);
  const bool by_resolution = threshold == kStepsAboveResolution * noise.step_rad;
  if (by_resolution && !edges_may_tremble(logs, noise.step_rad)) {
    threshold = kStepsOfSteadyEdges * noise.step_rad;
  }
  std::vector<double> thresholds;
  for (; threshold < largest && thresholds.size() < 8; threshold *= 2.0) {
    thresholds.push_back(threshold);
  }
  if (thresholds.empty()) {
    thresholds.push_back(std::max(largest, kSmallestThresholdRad));
  }
  return thresholds;
}

auto direction_changes(const Samples& samples) -> std::vector<std::size_t> {
  std::vector<std::size_t> changes;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (samples[i].forward != samples[i - 1].forward) {
      changes.push_back(i);
    }
  }
  return changes;
}

auto decimated(const Eigen::MatrixXd& columns, Eigen::Index factor) -> Eigen::MatrixXd {
  if (factor == 1) {
    return columns;
  }
  Eigen::MatrixXd coarse(columns.rows() / factor, columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    for (Eigen::Index row = 0; row < coarse.rows(); ++row) {
      coarse(row, c) = columns.col(c).segment(row * factor, factor).mean();
    }
  }
  return coarse;
}

auto moving_mean(const Eigen::MatrixXd& columns, const std::vector<Eigen::Index>& log_rows, Eigen::Index half_width)
    -> Eigen::MatrixXd {
  if (half_width == 0) {
    return columns;
  }
  Eigen::MatrixXd means(columns.rows(), columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    Eigen::Index begin = 0;
    for (const Eigen::Index rows : log_rows) {
      Eigen::VectorXd sums(rows + 1);
      sums[0] = 0.0;
      for (Eigen::Index i = 0; i < rows; ++i) {
        sums[i + 1] = sums[i] + columns(begin + i, c);
      }
      const Eigen::Index edge = std::min(half_width, (rows + 1) / 2);
      for (Eigen::Index i = 0; i < edge; ++i) {
        for (const Eigen::Index at : {i, rows - 1 - i}) {
          const Eigen::Index h = std::min(at, rows - 1 - at);
          means(begin + at, c) = (sums[at + h + 1] - sums[at - h]) / static_cast<double>(2 * h + 1);
        }
      }
      const Eigen::Index whole = rows - 2 * edge;
      const Eigen::Index width = 2 * half_width + 1;
      if (whole > 0) {
        means.col(c).segment(begin + edge, whole) =
            (sums.segment(width, whole) - sums.head(whole)) / static_cast<double>(width);
      }
      begin += rows;
    }
  }
  return means;
}

}  // namespace capstan::tools
