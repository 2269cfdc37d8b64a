// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace capstan::tools {

/// 'set' lines that put the force law of a joint file's [force] section into a joint of a board; none if the file has
/// no such section. Throws BadInput with file and cure.
auto force_lines(const std::string& joint_file, const std::string& name, int axis) -> std::vector<std::string>;

}  // namespace capstan::tools
