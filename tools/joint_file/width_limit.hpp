// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/joint_file/joint_file.hpp"

namespace capstan::tools {

/// Whether a width, of a play or of what bends like one, is so near to the most that a board's numbers hold that wider
/// ones were left out of a search. Of other shapes never.
auto is_at_limit(const ShapeInfo& info, double value) -> bool;

/// Widths of a law that are: "play.half_width".
auto widths_at_limit(const JointFile& law) -> std::vector<std::string>;

}  // namespace capstan::tools
