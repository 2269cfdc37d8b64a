// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools {

/// Writes folder/index.html, self-contained, and each picture as an .svg beside it. Creates the folder. Returns the
/// page's path. Throws BadInput if the folder can not be written.
auto write_report(const std::string& folder, const Diagnosis& diagnosis) -> std::string;

}  // namespace capstan::tools
