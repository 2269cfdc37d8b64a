// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/identify/force_fit.hpp"

namespace capstan::tools {

/// A force law as the [force] section of a joint file.
auto force_section(const PullPushFit& fit) -> std::string;
auto force_section(const PreisachFit& fit) -> std::string;

/// The text of a joint file with its [force] section replaced by another, or put behind everything else. An empty text
/// becomes a file of that section alone.
auto with_force_section(const std::string& joint_file, const std::string& section) -> std::string;

}  // namespace capstan::tools
