// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tools/joint_file/joint_file.hpp"

namespace capstan::tools {

/// The shell lines that put a law into a running board: one transaction of 'set' for every parameter of the law, terms
/// that are off included, so that nothing of an earlier law stays behind, and what the monitor may expect of it.
auto model_lines(const JointFile& joint, int axis) -> std::vector<std::string>;

}  // namespace capstan::tools
