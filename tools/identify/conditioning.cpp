// SPDX-License-Identifier: Apache-2.0
#include "tools/identify/conditioning.hpp"

#include <algorithm>

#include "tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// One count back may be the encoder trembling on an edge; two are a motion.
constexpr double kStepsAboveResolution = 1.5;
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

/// Direction of the other axis at every sample, by a conditioner of its own.
void add_other_axis(const OtherAxis& other, double period_s, std::vector<Measured<double>>& series) {
  const double step = quantisation_step(other.q1_rad);
  const double white = white_noise_level(other.q1_rad);
  ConditionerShape<double> shape;
  shape.direction_threshold_rad = threshold_above(step, white);
  SampleConditioner<double> conditioner(SamplePeriod<double>(period_s), shape);
  for (std::size_t i = 0; i < series.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    series[i].other_q1 = other.q1_rad[row];
    series[i].other_tau = other.tau_nm[row];
    series[i].other_forward = conditioner.update(other.q1_rad[row], other.tau_nm[row]).forward;
  }
}

/// The joint angle as far as a straight line in motor angle and torque gives it: what stands for the estimate that a
/// running law would have. The measured angle itself must not: a law could then copy what it is fitted to.
auto joint_by_motor(const AxisLog& log) -> Eigen::VectorXd {
  Eigen::MatrixXd columns(log.samples(), 3);
  columns << log.q1_rad, Eigen::VectorXd::Ones(log.samples()), log.tau_nm;
  const Eigen::MatrixXd gram = columns.transpose() * columns;
  return columns * gram.completeOrthogonalDecomposition().solve(columns.transpose() * log.q2_rad);
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
  if (log.other) {
    add_other_axis(*log.other, log.period_s, series);
  }
  return series;
}

auto causal_samples(const AxisLog& log, const ConditionerShape<double>& shape) -> Samples {
  SampleConditioner<double> conditioner(SamplePeriod<double>(log.period_s), shape);
  Samples samples;
  samples.reserve(static_cast<std::size_t>(log.samples()));
  const Eigen::VectorXd joint = log.q2_rad.size() > 0 ? joint_by_motor(log) : log.q1_rad;
  for (Measured<double> now : measured_series(log)) {
    now.q2 = joint[std::max<Eigen::Index>(1, static_cast<Eigen::Index>(samples.size())) - 1];
    samples.push_back(conditioner.update(now));
  }
  return samples;
}

auto motor_angle_noise(const std::vector<AxisLog>& logs) -> AngleNoise {
  AngleNoise noise;
  for (const auto& log : logs) {
    noise.step_rad = std::max(noise.step_rad, quantisation_step(log.q1_rad));
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
      for (Eigen::Index i = 0; i < rows; ++i) {
        const Eigen::Index h = std::min({half_width, i, rows - 1 - i});
        means(begin + i, c) = (sums[i + h + 1] - sums[i - h]) / static_cast<double>(2 * h + 1);
      }
      begin += rows;
    }
  }
  return means;
}

}  // namespace capstan::tools
