// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/hal/sim/faults.hpp"
#include "capstan/hal/sim/motion.hpp"
#include "capstan/hal/sim/parameters.hpp"
#include "capstan/hal/sim/toml_source.hpp"

/// The sections that scenarios and instruments are made of. All throw ScenarioError.
namespace capstan::sim {

void read_plant(const Source& source, const toml::table& table, PlantParameters& plant);
void read_environment(const Source& source, const toml::table& table, Environment& environment);
void read_effects(const Source& source, const toml::table& table, Effects& effects);
[[nodiscard]] Motion read_motion(const Source& source, const toml::table& table, Quantity quantity);

/// The axis that `axis = "name"` means.
[[nodiscard]] int axis_number(const Source& source, const toml::node& node, const std::vector<std::string>& names);

/// `axis_names`: what `axis = "name"` may say.
[[nodiscard]] Fault read_fault(const Source& source, const toml::table& table,
                               const std::vector<std::string>& axis_names);

}  // namespace capstan::sim
