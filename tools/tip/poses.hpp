// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>

#include "capstan/tools/log/csv_log.hpp"

namespace capstan::tools {

/// Joint angles of a wrist whose jaws a camera follows, by (6.11) turned round: from the log's columns tip_right/qw,
/// qx, qy, qz and tip_left/..., a jaw's frame in that of the pitch axis as a quaternion of any length. The columns
/// axisN/q2_rad that follow, rad: the pitch's, of two jaws their mean, and each jaw's; empty if no jaw is followed.
/// @param axes  pitch, right and left jaw. Throws BadInput: a quaternion of zeros with its line, or a log that has
/// axisN/q2_rad beside the poses.
auto joints_of_poses(const CsvLog& log, const std::array<int, 3>& axes) -> std::map<std::string, Eigen::VectorXd>;

}  // namespace capstan::tools
