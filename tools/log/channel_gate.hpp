// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

namespace capstan::tools {

/// What may be wrong with a channel of a log.
enum class ChannelFault {
  kSpikes,     ///< single wild values
  kHeld,       ///< a new value only every few rows
  kStuck,      ///< stands still for a while although the joint moves
  kUnsigned,   ///< the magnitude in place of the value
  kClipped,    ///< cut off at an end of its range
  kWrapped,    ///< jumps back by a turn
  kQuantised,  ///< only a few steps over its range
  kDegrees,    ///< an angle in degrees in place of radians
  kLate,       ///< behind the other channels
  kJump,       ///< jumps once, by no turn
};
auto fault_word(ChannelFault fault) -> const char*;

/// What a channel measures, as far as the tests differ.
enum class ChannelRole { kMotorAngle, kJointAngle, kMotorEffort, kJointEffort, kOther };

struct GateChannel {
  std::string name;
  ChannelRole role = ChannelRole::kOther;
  const Eigen::VectorXd* values = nullptr;
  std::string source = {};  ///< what --map reads it from; empty: a column of that name
};

struct ChannelFinding {
  ChannelFault fault = ChannelFault::kSpikes;
  std::string channel;
  std::vector<Eigen::Index> rows;  ///< that are touched, from 0; empty: all
  double value = 0.0;              ///< rows per new value, steps, seconds late
  double low = 0.0, high = 0.0;    ///< 95 % interval of the seconds
  /// What it is, without file, channel and line: "has 3 single wild values, which are left out".
  std::string what;
};

/// Looks at every channel alone and beside the others. Everything is judged by shares of the channel's own range, noise
/// and resolution: units do not matter. Linear time in the rows.
/// @param period_s  from row to row
auto inspect_channels(double period_s, const std::vector<GateChannel>& channels) -> std::vector<ChannelFinding>;

}  // namespace capstan::tools
