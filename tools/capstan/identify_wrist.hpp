// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tools/capstan/options.hpp"

namespace capstan::tools {

inline constexpr const char* kWristModel = "wrist";

/// Fits pitch and both jaws at once, prints the law, and writes a joint file for each unless `output` is empty.
/// @param axes  numbers of pitch, right and left jaw in the logs. Throws BadInput and Refusal.
auto identify_wrist(const LogOptions& options, const std::vector<int>& axes, const std::string& output) -> int;

}  // namespace capstan::tools
