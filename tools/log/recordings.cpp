// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/recordings.hpp"

#include <algorithm>
#include <iterator>

#include "capstan/tools/log/channel_shape.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;

/// A jump is so many times what all but one in two hundred changes are at most, and its neighbours: a motor speeds up
/// by less from one row to the next. Set before a log was looked at.
constexpr double kTimesUsual = 8.0;
constexpr double kUsualMoves = 0.995;
/// Rows are lost where the clock goes by so many periods.
constexpr double kLost = 1.5;
/// More are how the motion or its channel is, as steps are, or an angle that starts anew.
constexpr std::size_t kMostRecordings = 8;
/// A recording has so many rows, and moves by this share of what the farthest going one does.
constexpr Index kFewestRowsOfOne = 100;
constexpr double kLeastMotion = 0.3;

/// What a motor goes from one row to the next, where it goes.
auto while_moving(const Eigen::VectorXd& change) -> Eigen::VectorXd {
  std::vector<double> moving;
  std::copy_if(change.begin(), change.end(), std::back_inserter(moving), [](double one) { return one > 0.0; });
  return Eigen::Map<const Eigen::VectorXd>(moving.data(), std::ssize(moving));
}

/// First rows of what may be recordings, the log's own among them.
auto beginnings(const AxisLog& log) -> std::vector<Index> {
  const Eigen::VectorXd change = changes_of(log.q1_rad);
  const Eigen::VectorXd step_s = changes_of(log.time_s);
  // Rows that are lost leave a joint its zero and take it along, so an angle goes on over them (see recordings.hpp).
  const auto may_begin = [&](Index i) { return log.effort.size() > 0 || step_s[i] < kLost * log.period_s; };
  const Eigen::VectorXd moving = while_moving(change);
  std::vector<Index> first = {0};
  if (moving.size() == 0) {
    return first;
  }
  const double usual = quantile(moving, kUsualMoves);
  for (Index i = 1; i + 1 < change.size(); ++i) {
    if (may_begin(i) && change[i] > kTimesUsual * std::max({usual, change[i - 1], change[i + 1]})) {
      first.push_back(i + 1);
    }
  }
  return first;
}

}  // namespace

auto recordings_in(AxisLog log) -> std::vector<AxisLog> {
  const std::vector<Index> first = beginnings(log);
  if (first.size() == 1 || first.size() > kMostRecordings) {
    return {std::move(log)};
  }
  std::vector<AxisLog> recordings;
  std::vector<std::string> when;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Index end = i + 1 < first.size() ? first[i + 1] : log.samples();
    if (end - first[i] < kFewestRowsOfOne) {
      return {std::move(log)};
    }
    recordings.push_back(rows_from(first_rows(log, end), first[i]));
    if (i > 0) {
      when.push_back(rounded(log.time_s[first[i]]) + " s");
      recordings.back().name += " from " + when.back();
      recordings.back().warnings.clear();
    }
  }
  const auto by_motion = [](const auto& a, const auto& b) { return range_of(a.q1_rad) < range_of(b.q1_rad); };
  const auto [least, most] = std::minmax_element(recordings.begin(), recordings.end(), by_motion);
  if (range_of(least->q1_rad) < kLeastMotion * range_of(most->q1_rad)) {
    return {std::move(log)};
  }
  recordings.front().warnings.push_back(log.name + ": the motor is somewhere else from one row to the next at " +
                                        joined(when) + ", so this file is taken as " + std::to_string(first.size()) +
                                        " recordings, each with a zero and a start of its own");
  return recordings;
}

}  // namespace capstan::tools
