// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/leading_rest.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// A motor stands while its encoder goes to and fro by so many counts, or noises, or by this share of its range: a
/// motion that begins softly says something from there on.
constexpr double kCounts = 3.0;
constexpr double kNoises = 8.0;
constexpr double kShareOfMotor = 1e-4;
/// Of the joint's range, whose sensor is noisier: torque moves a joint while its motor stands.
constexpr double kShareOfJoint = 0.05;
/// Rest that takes this share of the rows behind it is cut down to the other one: filters begin in it.
constexpr double kLong = 0.1;
constexpr double kKept = 0.05;

auto first_beyond(const Eigen::VectorXd& angle, double enough) -> Eigen::Index {
  const auto moves = [&](double now) { return std::abs(now - angle[0]) > enough; };
  return std::find_if(angle.begin(), angle.end(), moves) - angle.begin();
}

auto range_of(const Eigen::VectorXd& angle) -> double {
  return angle.maxCoeff() - angle.minCoeff();
}

auto first_move(const Eigen::VectorXd& q1) -> Eigen::Index {
  return first_beyond(
      q1, std::max({kCounts * quantisation_step(q1), kNoises * white_noise_level(q1), kShareOfMotor * range_of(q1)}));
}

auto rows_of_leading_rest(const AxisLog& log) -> Eigen::Index {
  if (log.effort.size() > 0) {
    return 0;
  }
  Eigen::Index first = first_move(log.q1_rad);
  for (const auto& other : log.others) {
    first = std::min(first, first_move(other.q1_rad));
  }
  first = std::min(first, first_beyond(log.q2_rad, kShareOfJoint * range_of(log.q2_rad)));
  const auto behind = static_cast<double>(log.samples() - first);
  const bool is_long = static_cast<double>(first) > kLong * behind;
  return is_long && behind > 0.0 ? first - static_cast<Eigen::Index>(kKept * behind) : 0;
}

}  // namespace

auto without_leading_rest(AxisLog log) -> AxisLog {
  const Eigen::Index rest = rows_of_leading_rest(log);
  if (rest == 0) {
    return log;
  }
  const double length_s = log.time_s[rest] - log.time_s[0];
  log = rows_from(std::move(log), rest);
  log.warnings.push_back(log.name + ": nothing moves in the first " + rounded(length_s, 2) +
                         " s, which say nothing of the law and take no part");
  return log;
}

}  // namespace capstan::tools
