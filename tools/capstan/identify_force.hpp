// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/tools/capstan/options.hpp"
#include "capstan/tools/identify/force_fit.hpp"

namespace capstan::tools {

/// Fits a force law, prints it, and puts it into `output` as the section [force] unless that is empty. A joint file
/// that is there keeps everything else. Throws BadInput and Refusal.
auto identify_force(const LogOptions& options, const std::string& model, const PreisachGrid& grid,
                    const std::string& output) -> int;

}  // namespace capstan::tools
