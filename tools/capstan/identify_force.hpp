// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/capstan/options.hpp"

namespace capstan::tools {

/// True for the names of --model that are force laws: pull_push and preisach.
auto is_force_model(const std::string& model) -> bool;

/// Fits a force law, prints it, and puts it into `output` as the section [force] unless that is empty. A joint file
/// that is there keeps everything else. Throws BadInput and Refusal.
auto identify_force(const LogOptions& options, const std::string& model, const std::string& output) -> int;

}  // namespace capstan::tools
