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
  double gain = 0.0;             ///< share of the residual's squares that the shift takes away
  double left = 0.0;             ///< residual after the shift over the target, rms about its mean
};

struct DelayChannels {
  const Eigen::VectorXd* q1 = nullptr;
  const Eigen::VectorXd* tau = nullptr;     ///< motor effort as an input; may be missing
  const Eigen::VectorXd* target = nullptr;  ///< joint angle, joint torque, or the effort that motion is to explain
  bool target_is_effort = false;            ///< explained by q1's motion alone
};

/// Looks for the shift in time that lets a flexible rate-independent law (plays of several widths, torque by direction,
/// with viscous drag as a rival) explain the target best, channel by channel. Only a shift that is the same in all
/// parts of the log counts: hysteresis lags in travel, not in time. Nothing if no channel is behind for certain, or the
/// log is too short.
auto delay_between(const DelayChannels& channels) -> std::optional<ChannelDelay>;

}  // namespace capstan::tools
