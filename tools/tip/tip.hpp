// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "capstan/model/wrist_kinematics.hpp"
#include "capstan/tools/log/csv_log.hpp"

namespace capstan::tools {

/// Where a wrist's axes stand in a log.
struct WristInLog {
  std::array<int, 3> axes = {0, 1, 2};  ///< pitch, right and left jaw
  JawLinks<double> links;
};

/// How far the tip of a jaw is from where the cameras saw it, m, by what the joints' estimates are off.
struct TipError {
  double rms_m, largest_m;
};

struct TipTrack {
  std::vector<std::string> names;  ///< tip_right/x_m, ..., tip_right/measured_x_m, ..., and axis0/q2_rad, ... of poses
  std::vector<Eigen::VectorXd> columns;
  std::array<std::optional<TipError>, 2> errors;  ///< right, left; none without measured angles
};

/// Both tips by (6.12) from the estimated joint angles of a log, from the pitch axis in its frame; and from the
/// measured ones where the log has all three. A log with only measured angles gets the tips of those. Where a camera
/// followed the jaws the measured angles come from joints_of_poses() and stand first among the columns. Throws BadInput
/// with the column that is missing.
auto tips_of(const CsvLog& file, const WristInLog& wrist) -> TipTrack;

}  // namespace capstan::tools
