// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <optional>

namespace capstan::tools {

/// Which channel is behind the others.
enum class LateChannel { kMotorAngle, kMotorEffort, kTarget };

struct ChannelDelay {
  LateChannel channel = LateChannel::kTarget;
  double rows = 0.0;             ///< behind the others
  double low = 0.0, high = 0.0;  ///< 95 %, rows
};

struct DelayChannels {
  const Eigen::VectorXd* q1 = nullptr;
  const Eigen::VectorXd* tau = nullptr;     ///< motor effort; may be missing
  const Eigen::VectorXd* target = nullptr;  ///< joint angle or torque; may be missing if tau is there
  double period_s = 0.0;
};

/// Two laws tell three channels apart. The motor's: its effort against its angle alone, which needs no joint. The
/// joint's: its angle or torque against motor angle and effort together. A late target is behind the joint's law only;
/// a late effort behind the motor's law; a late motor angle lets both run ahead. What a shift explains counts only if
/// it is known, from part to part of the log and by how well turns are known, if it explains as much as a delay of that
/// size has to, and if the motion turns often enough. Nothing if no channel is behind for certain.
auto delay_between(const DelayChannels& channels) -> std::optional<ChannelDelay>;

}  // namespace capstan::tools
