// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/tools/select/effort_law.hpp"

namespace capstan::tools {

/// A law of an effort as a file, schema capstan.effort/1: the terms as in a joint file, and a table [law] with what it
/// takes to run them: family (effort or gear), target, status, window, standstill, skew.
auto effort_file_text(const EffortLaw& law) -> std::string;
void write_effort_file(const std::string& path, const EffortLaw& law);

/// Throws BadInput: one sentence with file, line and cure.
auto parse_effort_file(const std::string& text, const std::string& name) -> EffortLaw;
auto read_effort_file(const std::string& path) -> EffortLaw;

/// Whether a file says that it is of this schema.
auto is_effort_file(const std::string& path) -> bool;

}  // namespace capstan::tools
