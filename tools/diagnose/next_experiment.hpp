// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools {

/// The motion that would tell apart what this diagnosis could not, as a scenario for `capstan run`: equal cycles, no
/// farther and no faster than the joint (of an effort, the motor) went in the log. Empty where nothing was left open,
/// and for a linear axis.
auto next_scenario(const Diagnosis& diagnosis) -> std::string;

}  // namespace capstan::tools
