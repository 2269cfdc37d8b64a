// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tools/select/effort_law.hpp"

namespace capstan::tools {

/// The shell lines that put a law of an effort into a joint: one transaction that sets every term, those that are off
/// included. Throws BadInput, as board_effort_law.
auto effort_lines(const EffortLaw& law, const std::string& name, int axis) -> std::vector<std::string>;

}  // namespace capstan::tools
