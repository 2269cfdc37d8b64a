// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/support/statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace capstan::tools {
namespace {

constexpr double kMedianOfSquares = 0.4549;  // of a standard normal

}  // namespace

auto quantile(const Eigen::VectorXd& values, double p) -> double {
  std::vector<double> sorted(values.begin(), values.end());
  const auto rank = static_cast<std::ptrdiff_t>(std::lround(p * static_cast<double>(sorted.size() - 1)));
  std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
  return sorted[static_cast<std::size_t>(rank)];
}

auto median(const Eigen::VectorXd& values) -> double {
  return quantile(values, 0.5);
}

auto rms(const Eigen::VectorXd& values) -> double {
  return values.size() == 0 ? 0.0 : std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

auto rms_about_mean(const Eigen::VectorXd& values) -> double {
  return rms((values.array() - values.mean()).matrix());
}

auto range_of(const Eigen::VectorXd& values) -> double {
  return values.maxCoeff() - values.minCoeff();
}

auto student_t95(double degrees_of_freedom) -> double {
  const double v = std::max(degrees_of_freedom, 1.0);
  constexpr double kFewest = 4.0;
  if (v < kFewest) {
    // The logarithm as a cubic of 1 / v through those of 1, 2, 3 and 4 degrees of freedom, exact to 0.04 %.
    constexpr std::array<double, 4> kPoints = {12.706205, 4.302653, 3.182446, 2.776445};
    double logarithm = 0.0;
    for (std::size_t i = 0; i < kPoints.size(); ++i) {
      double weight = std::log(kPoints[i]);
      for (std::size_t j = 0; j < kPoints.size(); ++j) {
        const double other = 1.0 / static_cast<double>(j + 1);
        weight *= i == j ? 1.0 : (1.0 / v - other) / (1.0 / static_cast<double>(i + 1) - other);
      }
      logarithm += weight;
    }
    return std::exp(logarithm);
  }
  // Cornish-Fisher expansion of the t quantile about the normal one, exact to 0.3 %.
  constexpr double kNormal = 1.959964;
  const double z = kNormal;
  const double z3 = z * z * z;
  const double z5 = z3 * z * z;
  const double z7 = z5 * z * z;
  return z + (z3 + z) / (4.0 * v) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * v * v) +
         (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * v * v * v);
}

auto normal_tail(double z) -> double {
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

auto normal_quantile_upper(double p) -> double {
  double low = 0.0;
  double high = 40.0;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (normal_tail(middle) > p ? low : high) = middle;
  }
  return low;
}

auto goodness_of_fit_percent(const Eigen::VectorXd& measured, const Eigen::VectorXd& estimated) -> double {
  const double spread = (estimated.array() - estimated.mean()).matrix().norm();
  return 100.0 * (1.0 - (measured - estimated).norm() / spread);
}

auto white_noise_level(const Eigen::VectorXd& signal) -> double {
  const Eigen::Index n = signal.size() - 3;
  if (n < 1) {
    return 0.0;
  }
  const Eigen::VectorXd third =
      signal.tail(n) - 3.0 * signal.segment(2, n) + 3.0 * signal.segment(1, n) - signal.head(n);
  constexpr double kGain = 20.0;  // 1 + 9 + 9 + 1
  // From the median of the squares, so that a few corners of the motion do not count as noise.
  return std::sqrt(median(third.cwiseAbs2()) / kMedianOfSquares / kGain);
}

auto fast_noise_level(const Eigen::VectorXd& signal) -> double {
  constexpr int kOrder = 6;
  constexpr double kGain = 924.0;  // sum of the squares of the weights
  if (signal.size() <= kOrder) {
    return 0.0;
  }
  Eigen::VectorXd difference = signal;
  for (int order = 0; order < kOrder; ++order) {
    const Eigen::Index n = difference.size() - 1;
    difference = Eigen::VectorXd(difference.tail(n) - difference.head(n));
  }
  return std::sqrt(median(difference.cwiseAbs2()) / kMedianOfSquares / kGain);
}

namespace {

/// The step that the changes up to so many of them are multiples of, on the mean.
auto mean_step(const Eigen::ArrayXd& changes, double step, double most) -> double {
  double total = 0.0;
  double count = 0.0;
  for (const double change : changes) {
    if (change > 0.5 * step && change < (most + 0.5) * step) {
      total += change;
      count += std::round(change / step);
    }
  }
  return count > 0.0 ? total / count : step;
}

}  // namespace

auto quantisation_step(const Eigen::VectorXd& signal) -> double {
  if (signal.size() < 2) {
    return 0.0;
  }
  const Eigen::ArrayXd changes = (signal.tail(signal.size() - 1) - signal.head(signal.size() - 1)).array().abs();
  const double rounding = 1e-9 * signal.cwiseAbs().maxCoeff();
  double step = std::numeric_limits<double>::infinity();
  for (const double change : changes) {
    step = change > rounding ? std::min(step, change) : step;
  }
  if (!std::isfinite(step) || step < 100.0 * rounding) {
    return 0.0;
  }
  constexpr double kLargestMultiple = 50.0;  // beyond, rounding makes everything a multiple
  // Printed to a few decimals, the smallest change alone is a poor measure of the step.
  for (const double most : {1.0, 4.0, 16.0, kLargestMultiple}) {
    step = mean_step(changes, step, most);
  }
  Eigen::Index counted = 0;
  Eigen::Index multiples = 0;
  for (const double change : changes) {
    const double steps = change / step;
    if (steps > 0.5 && steps < kLargestMultiple) {
      ++counted;
      multiples += std::abs(steps - std::round(steps)) < 0.05 ? 1 : 0;
    }
  }
  return static_cast<double>(multiples) > 0.98 * static_cast<double>(counted) ? step : 0.0;
}

}  // namespace capstan::tools
