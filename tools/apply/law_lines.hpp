// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace capstan::tools {

/// The shell lines that write a file into a board: a motion law, a force law or both, or an effort law, from 'begin' to
/// 'commit'; or what a commissioning found (machine_lines).
/// Throws BadInput or Refusal with the cure where this board could not run it.
/// @param force  also a law whose joint would run against the motor, or too far
auto law_lines(const std::string& file, int axis, bool force) -> std::vector<std::string>;

/// Throws BadInput if lines of that file are for another joint than the one that was asked for: a machine.toml says
/// itself for which.
void expect_axis(const std::vector<std::string>& lines, int axis, const std::string& file);

/// Throws BadInput if lines are for a joint that the board does not have.
/// @param version  its answer to 'version', which says how many it has
void expect_joints(const std::vector<std::string>& lines, const std::vector<std::string>& version);

}  // namespace capstan::tools
