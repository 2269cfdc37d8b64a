// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>

#include "capstan/tests/tools/blind/blind_world.hpp"

namespace capstan::tools::blind {

/// What an effect adds to the joint's angle, in whatever size; its form and numbers are drawn.
using Effect = std::function<Signal(const World&, Draw&)>;

auto listed() -> const std::map<std::string, Effect>&;
auto unlisted() -> const std::map<std::string, Effect>&;
/// The effect so many times as large: a delay grows in time, everything else in angle.
auto sized(const std::string& name, const World& w, const Signal& unit, double size) -> Signal;
auto effect_of(const std::string& name) -> const Effect&;

}  // namespace capstan::tools::blind
