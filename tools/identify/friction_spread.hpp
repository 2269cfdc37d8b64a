// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "capstan/tools/identify/conditioning.hpp"
#include "capstan/tools/joint_file/joint_file.hpp"

namespace capstan::tools {

/// What a board's LawMonitor takes for a stretch of steady motion. tools/apply checks that it is the same.
struct MonitorStretch {
  static constexpr double kStrideRad = 1.0 / 256.0;  ///< of the motor, from sample to sample
  static constexpr int kUnsettled = 512;             ///< strides after a start that take no part
  static constexpr int kSamples = 64;                ///< to and fro
  static constexpr double kSettleRad = 0.35;         ///< of the motor since it turned, before samples count
};

/// How far the friction of a stretch of healthy motion is from the steady one, Nm: rms over stretches as the board's
/// LawMonitor takes them, and what another speed within the logs' changes. Nothing where they have too few stretches.
auto friction_spread(const std::vector<AxisLog>& logs, const std::vector<Samples>& samples, const SteadyTorque& steady)
    -> std::optional<double>;

}  // namespace capstan::tools
