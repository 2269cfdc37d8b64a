// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/axis_gate.hpp"

#include <algorithm>
#include <map>

#include "capstan/tools/log/channel_gate.hpp"
#include "capstan/tools/log/channel_shape.hpp"
#include "capstan/tools/log/wild_values.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Rows at which something has changed: of a log that repeats its rows, those that were measured.
auto changed_rows(const AxisLog& axis) -> std::vector<Eigen::Index> {
  std::vector<Eigen::Index> rows = {0};
  for (Eigen::Index i = 1; i < axis.samples(); ++i) {
    bool changed = false;
    for (const Eigen::VectorXd* x : {&axis.q1_rad, &axis.tau_nm, &axis.q2_rad, &axis.effort}) {
      changed = changed || (x->size() > 0 && (*x)[i] != (*x)[i - 1]);
    }
    if (changed) {
      rows.push_back(i);
    }
  }
  return rows;
}

void keep_rows(AxisLog& axis, const std::vector<Eigen::Index>& rows) {
  axis = only_rows(std::move(axis), rows);
  axis.period_s = median(axis.time_s.tail(axis.samples() - 1) - axis.time_s.head(axis.samples() - 1));
}

/// The channels of an axis that are looked at.
auto channels_of(const CsvLog& csv, const AxisLog& axis, const AxisRequest& request, const std::string& q1)
    -> std::vector<GateChannel> {
  const bool effort = axis.effort.size() > 0;
  std::vector<GateChannel> channels = {
      {q1, ChannelRole::kMotorAngle, &axis.q1_rad},
      {axis_column(request.axis, "tau_Nm"), ChannelRole::kMotorEffort, axis.has_torque ? &axis.tau_nm : nullptr},
      {effort ? axis.target : "", request.force ? ChannelRole::kJointEffort : ChannelRole::kMotorEffort,
       effort ? &axis.effort : nullptr},
      {effort ? axis_column(request.axis, "q2_rad") : axis.target, ChannelRole::kJointAngle,
       axis.q2_rad.size() > 0 ? &axis.q2_rad : nullptr}};
  for (auto& channel : channels) {
    channel.source = csv.expression_of(channel.name);
  }
  return channels;
}

/// Rows per new value of the held ones, by name.
using Beats = std::map<std::string, double>;

/// Whether all that varies comes on one beat: a recorder that is slower than its log.
auto rows_repeat(const Beats& beats, const std::vector<GateChannel>& channels) -> bool {
  constexpr double kSameBeat = 0.02;  // of the rows per value
  const auto given = std::count_if(channels.begin(), channels.end(),
                                   [](const auto& c) { return c.values != nullptr && varies(*c.values); });
  if (beats.empty() || beats.size() != static_cast<std::size_t>(given)) {
    return false;
  }
  const auto [low, high] =
      std::minmax_element(beats.begin(), beats.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return high->second <= (1.0 + kSameBeat) * low->second;
}

/// What is measured at the joint may be slower than the rest, as a camera is; between its values it tells nothing new.
/// An effort of the motor is not thinned so: its law needs the motion's rates.
auto frames_of_joint(const AxisLog& axis, const Beats& beats, const std::vector<GateChannel>& channels)
    -> std::vector<Eigen::Index> {
  constexpr std::size_t kFewestFrames = 150;  // fewer are no log
  for (const auto& channel : channels) {
    const bool of_joint = channel.role == ChannelRole::kJointAngle || channel.role == ChannelRole::kJointEffort;
    if (of_joint && channel.name == axis.target && beats.contains(channel.name)) {
      auto frames = frame_rows(*channel.values, beats.at(channel.name));
      return frames.size() < kFewestFrames ? std::vector<Eigen::Index>{} : frames;
    }
  }
  return {};
}

/// " (lines 12, 40 and 3 more)", where there is more than the one that stands before the sentence.
auto lines_text(const CsvLog& csv, const std::vector<Eigen::Index>& rows) -> std::string {
  constexpr std::size_t kMostNamed = 8;
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < std::min(rows.size(), kMostNamed); ++i) {
    lines.push_back(std::to_string(csv.line_of(static_cast<std::size_t>(rows[i]))));
  }
  if (rows.size() < 2) {
    return "";
  }
  const std::string more = rows.size() > kMostNamed ? " and " + std::to_string(rows.size() - kMostNamed) + " more" : "";
  return " (lines " + joined(lines) + more + ")";
}

/// Puts a straight line through these rows of every signal, from the row before to the row after.
void leave_out(AxisLog& axis, std::vector<Eigen::Index> rows) {
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  // Neighbours on a straight line: a row less would be a gap in time, which the laws' memory would feel.
  for_each_signal(axis, [&](Eigen::VectorXd& signal) {
    if (&signal == &axis.time_s || signal.size() == 0) {
      return;
    }
    signal = without(std::move(signal), rows);
  });
}

}  // namespace

void pass_gate(const CsvLog& csv, const AxisRequest& request, const std::string& q1, AxisLog& axis) {
  const std::vector<GateChannel> channels = channels_of(csv, axis, request, q1);
  const std::vector<ChannelFinding> findings = inspect_channels(axis.period_s, channels);
  std::vector<Eigen::Index> wild;
  Beats beats;
  for (const auto& finding : findings) {
    if (finding.fault == ChannelFault::kSpikes) {
      wild.insert(wild.end(), finding.rows.begin(), finding.rows.end());
    } else if (finding.fault == ChannelFault::kHeld) {
      beats[finding.channel] = finding.value;
    }
  }
  const bool repeat = rows_repeat(beats, channels);
  std::vector<Eigen::Index> kept;
  if (!request.every_row) {
    leave_out(axis, wild);
  }
  if (!request.every_row && request.needs_target) {
    kept = repeat ? changed_rows(axis) : frames_of_joint(axis, beats, channels);
  }
  for (const auto& finding : findings) {
    const std::string where = finding.rows.empty()
                                  ? csv.name() + ": "
                                  : place(csv.name(), csv.line_of(static_cast<std::size_t>(finding.rows.front())));
    const bool thins = !repeat && !kept.empty() && finding.channel == axis.target;
    const std::string held = thins ? "; only those " + std::to_string(kept.size()) + " rows are used"
                                   : ", so it is late by half of that on average; log the sensor's own rate";
    axis.warnings.push_back(where + finding.channel + " " + finding.what +
                            (finding.fault == ChannelFault::kHeld     ? held
                             : finding.fault == ChannelFault::kSpikes ? lines_text(csv, finding.rows)
                                                                      : ""));
  }
  if (kept.empty()) {
    return;
  }
  keep_rows(axis, kept);
  if (repeat) {
    axis.warnings.push_back(axis.name + ": the rows repeat; only the " + std::to_string(kept.size()) +
                            " that were measured are used, " + rounded(axis.rate_hz()) + " Hz");
  }
  // What is held is late by half its beat, which hid how late it is by itself.
  for (const auto& finding : inspect_channels(axis.period_s, channels)) {
    if (finding.fault == ChannelFault::kLate) {
      axis.warnings.push_back(csv.name() + ": " + finding.channel + " " + finding.what);
    }
  }
}

}  // namespace capstan::tools
