// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/law_fit.hpp"

namespace capstan::tools {

/// What a change of the loop alone is called; empty: the tendons' torque changed and their motion did not.
/// @param width,torque  of the loop, over the healthy joint's
auto name_of_change(double width, double torque) -> std::string;

/// How large such a change is, for people. @pre its size has an interval
auto change_sentence(const std::string& name, const EffectSize& size) -> std::string;

/// Tendons with the one number changed that has the name; others as they are.
/// @param width  of the loop, over the healthy joint's
auto changed_tendons(LawForm tendons, const std::string& name, double width) -> LawForm;

}  // namespace capstan::tools
