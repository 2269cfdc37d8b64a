// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "capstan/tools/joint_file/joint_file.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools {

/// Pitch, right and left jaw, in this order throughout.
inline constexpr std::size_t kWristAxes = 3;

/// A wrist's law, (6.8) with (6.14) to (6.16): the jaws' tendons pass the pitch, so a jaw follows by its K all that the
/// pitch's own tendons do, their stretch included.
struct WristFit {
  std::array<JointFile, kWristAxes> joints;      ///< a row each, as a board runs it
  std::array<double, kWristAxes> follow{};       ///< K; 0 of the pitch
  std::array<double, kWristAxes> follow_half{};  ///< half of their 95 % intervals
  std::array<double, kWristAxes>
      untied_rmse_rad{};                  ///< of each row fitted for itself, its coupling of three free numbers
  std::vector<std::string> undetermined;  ///< what the rows for themselves could not determine, but the coupling
};

/// Fits all three joints at once: seven numbers of motion and stretch fewer than row by row. @pre the logs of each axis
/// are of the same runs, have torque and joint angle; a jaw's have the pitch as their other axis
auto fit_wrist(const std::array<std::vector<AxisLog>, kWristAxes>& logs) -> WristFit;

}  // namespace capstan::tools
