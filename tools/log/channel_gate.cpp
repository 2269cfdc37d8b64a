// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/channel_gate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "capstan/model/terms/transport_delay.hpp"
#include "capstan/tools/log/channel_delay.hpp"
#include "capstan/tools/log/channel_ends.hpp"
#include "capstan/tools/log/channel_shape.hpp"
#include "capstan/tools/log/wild_values.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;
using Rows = std::vector<Index>;

constexpr double kFewestSteps = 100.0;  // of the resolution over the range: coarser, and steps look like lost motion
/// A joint behind tendons turns less than this; its angle in degrees runs over more.
constexpr double kMostJointTurns = 2.0;
/// Angles in degrees beside radians run 57.3 times as far; the ratio of the pulleys makes that more or less.
constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kPulleys = 3.5;

/// Only angles start anew after a turn.
auto is_effort(const GateChannel& channel) -> bool {
  return channel.role == ChannelRole::kMotorEffort || channel.role == ChannelRole::kJointEffort;
}

/// Whether a signal keeps its value in most of these rows.
auto mostly_still(const Eigen::VectorXd& x, const Rows& rows) -> bool {
  const auto still = std::count_if(rows.begin(), rows.end(), [&](Index i) { return i > 0 && x[i] == x[i - 1]; });
  return 2 * static_cast<std::size_t>(still) > rows.size();
}

/// What --map reads the channel from, as a part of an expression.
auto source_of(const GateChannel& channel) -> const std::string& {
  return channel.source.empty() ? channel.name : channel.source;
}

/// What a delay can be cured by. A law's answer may come late; what it reads it takes as it comes, and none looks
/// ahead.
auto cure_of(bool is_target, double late_s) -> std::string {
  if (!is_target) {
    return "no effect of a law takes it up, so give this channel's values the times at which they were measured";
  }
  constexpr double kLongestS = TransportDelay<double>::kInfo.shapes[0].maximum;
  return late_s <= kLongestS ? "the effect transport_delay can take it up, and a common time stamp would cure it"
                             : "the effect transport_delay takes up " + rounded(1e3 * kLongestS, 3) +
                                   " ms at most, so give this channel's values the times at which they were measured";
}

class Gate {
 public:
  Gate(double period_s, const std::vector<GateChannel>& channels) : period_s_(period_s) {
    for (const auto& channel : channels) {
      if (channel.values != nullptr && varies(*channel.values)) {
        channels_.push_back(channel);
      }
    }
  }

  auto findings() -> std::vector<ChannelFinding> {
    for (const auto& channel : channels_) {
      look_at(channel);
    }
    compare_angles();
    compare_times();
    return std::move(found_);
  }

 private:
  void add(ChannelFault fault, const GateChannel& channel, std::vector<Index> rows, double value, std::string what) {
    found_.push_back({fault, channel.name, std::move(rows), value, 0.0, 0.0, std::move(what)});
  }
  [[nodiscard]] auto first_of(ChannelRole role) const -> const GateChannel* {
    const auto at = std::find_if(channels_.begin(), channels_.end(), [&](const auto& c) { return c.role == role; });
    return at == channels_.end() ? nullptr : &*at;
  }
  [[nodiscard]] auto has(ChannelFault fault) const -> bool {
    return std::any_of(found_.begin(), found_.end(), [&](const auto& f) { return f.fault == fault; });
  }

  /// An angle that starts anew after each turn, or a single jump, which is none.
  void add_jumps(const GateChannel& channel, std::vector<Eigen::Index> rows) {
    const Eigen::VectorXd& x = *channel.values;
    double jump = 0.0;  // the largest: motion takes away from a turn what it adds to the angle
    for (const Eigen::Index row : rows) {
      jump = std::max(jump, std::abs(x[row] - x[row - 1]));
    }
    const auto turn = nearest_turn(jump);
    if (rows.size() == 1 && (!turn || is_effort(channel))) {
      add(ChannelFault::kJump, channel, std::move(rows), jump,
          "jumps by " + rounded(jump) +
              " here, once, as where two recordings are joined, a tendon slips or the zero is set again" +
              (channel.role == ChannelRole::kMotorAngle  // where that is seen, a file is taken apart (recordings.hpp)
                   ? ""
                   : "; give what is before and after as two logs"));
      return;
    }
    const std::string count = rows.size() == 1 ? ", once," : " and " + std::to_string(rows.size()) + " times in all,";
    add(ChannelFault::kWrapped, channel, std::move(rows), jump,
        "jumps by " + rounded(jump) + " here" + count + " as an angle does that restarts after each turn; unwrap it, " +
            "for instance with Python: `numpy.unwrap(angle, period=" + rounded(turn.value_or(jump), 8) + ")`");
  }

  /// A number below zero whose sign was lost.
  void add_unsigned_word(const GateChannel& channel, double range) {
    const std::string half = exact(0.5 * range);
    const std::string& source = source_of(channel);
    add(ChannelFault::kWrapped, channel, {}, range,
        "is " + rounded(range, 8) + " too high wherever it is below zero, as a number with a sign is that was read " +
            "without one; read it with --map \"" + channel.name + "=" + source + " - " + half + "*(1 + sign(" + source +
            " - " + half + "))\"");
  }

  /// Stretches of one value.
  void look_at_flats(const GateChannel& channel) {
    const Eigen::VectorXd& x = *channel.values;
    const auto* motor = first_of(ChannelRole::kMotorAngle);
    Rows clipped = clipped_rows(x);
    if (!is_effort(channel) && motor != nullptr && mostly_still(*motor->values, clipped)) {
      clipped.clear();  // it rests at an end of its way
    }
    if (const auto beat = rows_per_value(x)) {
      add(ChannelFault::kHeld, channel, {}, *beat, "has a new value only every " + rounded(*beat) + " samples");
    } else if (!clipped.empty()) {
      add(ChannelFault::kClipped, channel, clipped, x.maxCoeff(),
          "is cut off at an end of its range in " + std::to_string(clipped.size()) +
              " rows, from here on; choose a larger range of the sensor" +
              (is_effort(channel) ? ", unless the drive itself gives no more" : ""));
    }
    if (motor != nullptr && motor->name != channel.name && clipped.empty()) {  // what is cut off stands still as well
      if (auto stuck = stuck_rows(x, *motor->values); !stuck.empty()) {
        const auto count = std::to_string(stuck.size());
        add(ChannelFault::kStuck, channel, std::move(stuck), 0.0,
            "stands still in " + count + " rows, from here on, while the motor moves on; check its cable");
      }
    }
  }

  void look_at(const GateChannel& channel) {
    const Eigen::VectorXd& x = *channel.values;
    if (const auto range = is_effort(channel) ? unsigned_range(x) : std::nullopt) {
      add_unsigned_word(channel, *range);
      return;
    }
    if (auto rows = jump_rows(x); !rows.empty()) {
      if (rows.size() == 1 || !is_effort(channel)) {  // friction switches a torque to and fro between two levels
        add_jumps(channel, std::move(rows));
      }
      return;
    }
    const bool is_angle = channel.role == ChannelRole::kMotorAngle || channel.role == ChannelRole::kJointAngle;
    if (auto rows = spike_rows(x, !is_angle); !rows.empty()) {
      const auto count = std::to_string(rows.size());
      add(ChannelFault::kSpikes, channel, std::move(rows), 0.0,
          "stands out from both neighbours here, one of " + count + " such rows; a straight line takes their place");
    }
    look_at_flats(channel);
    if (is_magnitude(x, channel.role == ChannelRole::kMotorEffort)) {
      add(ChannelFault::kUnsigned, channel, {}, 0.0,
          "turns up sharply each time it reaches zero, as the magnitude of a signal with a sign does; log it with its "
          "sign");
    }
    if (const auto steps = steps_over_range(x); steps && *steps < kFewestSteps) {
      add(ChannelFault::kQuantised, channel, {}, *steps,
          "has only " + rounded(*steps, 2) + " steps of its resolution over its range; use a finer sensor");
    }
  }

  void compare_angles() {
    const auto* motor = first_of(ChannelRole::kMotorAngle);
    const auto* joint = first_of(ChannelRole::kJointAngle);
    if (joint == nullptr) {
      return;
    }
    const double joint_range = robust_range(*joint->values);
    const double motor_range = motor == nullptr ? 0.0 : robust_range(*motor->values);
    const double most = kMostJointTurns * 2.0 * std::numbers::pi;
    const auto hint = [this](const std::string& name) {
      const auto channel =
          std::find_if(channels_.begin(), channels_.end(), [&](const auto& c) { return c.name == name; });
      return "; if it is in degrees, read it with --map \"" + name + "=deg(" + source_of(*channel) + ")\"";
    };
    if (joint_range > most) {
      add(ChannelFault::kDegrees, *joint, {}, joint_range,
          "runs over " + rounded(joint_range) + ", more turns than a joint behind tendons makes" + hint(joint->name));
    }
    if (motor == nullptr || joint_range <= 0.0) {
      return;
    }
    if (!has(ChannelFault::kJump) && !has(ChannelFault::kWrapped) && !has(ChannelFault::kStuck)) {
      if (const auto row = leap_row(*joint->values, *motor->values)) {
        add_jumps(*joint, {*row});
      }
    }
    const double ratio = motor_range / joint_range;
    if (ratio > kDegrees / kPulleys && ratio < kDegrees * kPulleys && motor_range > most) {
      add(ChannelFault::kDegrees, *motor, {}, ratio,
          "runs " + rounded(ratio, 3) + " times as far as " + joint->name + hint(motor->name) +
              "; if there is a gear of that ratio between them, ignore this");
    }
  }

  void compare_times() {
    const auto* motor = first_of(ChannelRole::kMotorAngle);
    const auto* angle = first_of(ChannelRole::kJointAngle);
    const auto* effort = first_of(ChannelRole::kMotorEffort);
    const auto* torque = first_of(ChannelRole::kJointEffort);
    const auto* target = angle != nullptr ? angle : torque;
    if (motor == nullptr || (target == nullptr && effort == nullptr) || has(ChannelFault::kWrapped) ||
        has(ChannelFault::kJump) || has(ChannelFault::kUnsigned) ||
        has(ChannelFault::kHeld)) {  // what is held is late by half of that, and said to be
      return;
    }
    std::array<Eigen::VectorXd, 3> tame;
    const auto values = [&](const GateChannel* channel, std::size_t place) -> const Eigen::VectorXd* {
      if (channel == nullptr) {
        return nullptr;
      }
      const auto spikes = std::find_if(found_.begin(), found_.end(), [&](const auto& one) {
        return one.fault == ChannelFault::kSpikes && one.channel == channel->name;
      });
      if (spikes == found_.end()) {
        return channel->values;
      }
      tame[place] = without(*channel->values, spikes->rows);
      return &tame[place];
    };
    const auto delay = delay_between({values(motor, 0), values(effort, 1), values(target, 2), period_s_});
    if (!delay) {
      return;
    }
    const auto* late = delay->channel == LateChannel::kTarget       ? target
                       : delay->channel == LateChannel::kMotorAngle ? motor
                                                                    : effort;
    const double ms = 1e3 * period_s_;
    add(ChannelFault::kLate, *late, {}, period_s_ * delay->rows,
        "is late against the other channels by " + rounded(ms * delay->rows, 3) + " ms (95 % " +
            rounded(ms * delay->low, 3) + " to " + rounded(ms * delay->high, 3) + "); nothing was shifted: " +
            cure_of(late == (target != nullptr ? target : effort), period_s_ * delay->rows) +
            (late == effort && target != nullptr
                 ? "; if all channels share one clock, this is not a delay: tendon drag and friction cause it"
                 : ""));
    found_.back().low = period_s_ * delay->low;
    found_.back().high = period_s_ * delay->high;
  }

  double period_s_;
  std::vector<GateChannel> channels_;
  std::vector<ChannelFinding> found_;
};

}  // namespace

auto fault_word(ChannelFault fault) -> const char* {
  constexpr const char* kWords[] = {"spikes",  "held",      "stuck",   "unsigned", "clipped",
                                    "wrapped", "quantised", "degrees", "late",     "jump"};
  return kWords[static_cast<std::size_t>(fault)];
}

auto inspect_channels(double period_s, const std::vector<GateChannel>& channels) -> std::vector<ChannelFinding> {
  return Gate(period_s, channels).findings();
}

}  // namespace capstan::tools
