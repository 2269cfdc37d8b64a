// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/shape_range.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// A gap of half the range or more is never crossed; one of a thousandth of it is below what sensors of motors show
/// (4096 counts over a range of a turn). Chosen on no log.
constexpr ShapeRange kOfAngle = {1.0 / 2000.0, 1.0 / 2.02};
/// What is over within so little torque is a step at each reversal; what goes on far beyond the log's torque is not
/// over in it, and the nearest law that is says where it leads. Chosen on no log.
constexpr ShapeRange kOfTorque = {1.0 / 500.0, 10.0};
/// A speed that is slower than nearly all of the motion is a step again.
constexpr ShapeRange kOfSpeed = {1.0 / 400.0, 2.0};
/// What takes far longer than the log is a straight line in it, and where that leads the log does not say: with three
/// times the log's length it leads to 3.5 times what the log shows. Chosen on no log.
constexpr double kLongestOfDuration = 3.0;

auto range_in(const std::vector<Samples>& samples, auto&& value_of) -> double {
  double widest = 0.0;
  for (const auto& log : samples) {
    const auto ends = std::minmax_element(log.begin(), log.end(),
                                          [&](const auto& a, const auto& b) { return value_of(a) < value_of(b); });
    widest = log.empty() ? widest : std::max(widest, value_of(*ends.second) - value_of(*ends.first));
  }
  return widest;
}

auto top_speed(const std::vector<Samples>& samples) -> double {
  constexpr double kExceeded = 0.99;
  double fastest = 0.0;
  for (const auto& log : samples) {
    Eigen::VectorXd speed(static_cast<Eigen::Index>(log.size()));
    std::transform(log.begin(), log.end(), speed.begin(), [](const auto& s) { return std::abs(s.dq1); });
    fastest = log.empty() ? fastest : std::max(fastest, quantile(speed, kExceeded));
  }
  return fastest;
}

auto within(const ShapeInfo& info, const ShapeRange& share, double of) -> ShapeRange {
  const ShapeRange range = {std::max(info.minimum, share.low * of), std::min(info.maximum, share.high * of)};
  return range.low < range.high ? range : ShapeRange{info.minimum, info.maximum};
}

}  // namespace

auto reach_of(const std::vector<Samples>& samples, const std::vector<double>& periods_s) -> SignalReach {
  SignalReach reach;
  for (std::size_t log = 0; log < samples.size(); ++log) {
    reach.duration_s = std::max(reach.duration_s, static_cast<double>(samples[log].size()) * periods_s[log]);
  }
  reach.q1 = range_in(samples, [](const auto& s) { return s.q1; });
  reach.dq1 = top_speed(samples);
  reach.tau = range_in(samples, [](const auto& s) { return s.tau; });
  for (std::size_t slot = 0; slot < kMostOthers; ++slot) {
    reach.others[slot] = range_in(samples, [slot](const auto& s) { return s.others[slot].q1; });
  }
  return reach;
}

auto at_many_places(const Eigen::VectorXd& q1) -> bool {
  // Friction, inertia, drag, an offset, sine, cosine and order, and as many again. Chosen on no log.
  constexpr double kFewest = 14.0;
  constexpr Eigen::Index kCells = 200;
  const double low = q1.minCoeff();
  const double cell = (q1.maxCoeff() - low) / static_cast<double>(kCells);
  Eigen::VectorXd rows = Eigen::VectorXd::Zero(kCells + 1);
  for (const double angle : q1) {
    rows(cell > 0.0 ? static_cast<Eigen::Index>((angle - low) / cell) : 0) += 1.0;
  }
  // As many places, all visited alike, have this sum of squares.
  return rows.sum() * rows.sum() >= kFewest * rows.squaredNorm();
}

auto ShapeRange::with(double value) const -> ShapeRange {
  return {std::min(low, value), std::max(high, value)};
}

auto range_of(const ShapeInfo& info, const SignalReach& reach) -> ShapeRange {
  switch (info.of) {
    case ShapeOf::kMotorRange:
      return within(info, kOfAngle, reach.q1);
    case ShapeOf::kMotorSpeed:
      return within(info, kOfSpeed, reach.dq1);
    case ShapeOf::kTorqueRange:
      return within(info, kOfTorque, reach.tau);
    case ShapeOf::kOtherRange:
      return within(info, kOfAngle, *std::max_element(reach.others.begin(), reach.others.end()));
    case ShapeOf::kTime: {
      const double per_unit = std::string_view(info.unit) == "min" ? 60.0 : 1.0;
      const double longest = std::min(info.maximum, kLongestOfDuration * reach.duration_s / per_unit);
      return {info.minimum, longest > info.minimum ? longest : info.maximum};
    }
    case ShapeOf::kNothing:
    case ShapeOf::kGiven:
      break;
  }
  return {info.minimum, info.maximum};
}

}  // namespace capstan::tools
