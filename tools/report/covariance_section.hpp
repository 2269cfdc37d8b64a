// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/tools/diagnose/identifiability.hpp"

namespace capstan::tools {

/// What the log can and can not tell: excitation of each parameter, correlations of their estimates, and which of them
/// need another motion. Empty where nothing is known.
auto covariance_section(const Identifiability& told) -> std::string;

}  // namespace capstan::tools
