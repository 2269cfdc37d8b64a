// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/leading_rest.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Share of a motor's range that counts as rest: an encoder's last digits may tremble, a brake let go. And of the
/// joint's, whose sensor is noisier: torque moves it while the motor stands.
constexpr double kMotorStands = 0.01;
constexpr double kJointStands = 0.05;
/// Rest that is kept, as a share of the rows behind it: filters begin in it, and friction holds.
constexpr double kKept = 0.05;

auto first_move(const Eigen::VectorXd& angle, double share) -> Eigen::Index {
  if (angle.size() == 0) {
    return 0;
  }
  const double enough = share * (angle.maxCoeff() - angle.minCoeff());
  const auto moves = [&](double now) { return std::abs(now - angle[0]) > enough; };
  return std::find_if(angle.begin(), angle.end(), moves) - angle.begin();
}

auto rows_of_leading_rest(const AxisLog& log) -> Eigen::Index {
  Eigen::Index first = first_move(log.q1_rad, kMotorStands);
  for (const auto& other : log.others) {
    first = std::min(first, first_move(other.q1_rad, kMotorStands));
  }
  if (!log.motion_alone()) {
    first = std::min(first, first_move(log.q2_rad, kJointStands));
  }
  const auto kept = static_cast<Eigen::Index>(kKept * static_cast<double>(log.samples() - first));
  return first < log.samples() ? std::max<Eigen::Index>(0, first - kept) : 0;
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
