// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "capstan/hal/sim/parameters.hpp"

namespace capstan::sim {

/// One named number of `Owner`, with the range in which it is physically possible. The tables below feed the scenario
/// reader, validate(), the command line override and the instrument files: a new parameter is one line.
template <class Owner>
struct Field {
  std::string_view name;
  double Owner::*member;
  double low;
  double high;
};

struct EffectField {
  std::string_view effect;
  std::string_view key;
  double Effects::*member;
  double low;
  double high;
  bool primary;  ///< set by `effect = number`
};

[[nodiscard]] std::span<const Field<PlantParameters>> plant_fields();
[[nodiscard]] std::span<const Field<Environment>> environment_fields();
[[nodiscard]] std::span<const EffectField> effect_fields();

/// Sets "play" (its primary numbers) or "play.half_width_rad". Throws std::invalid_argument with "sentence; cure" if
/// there is no such effect or the value is out of range; `effects` is then unchanged.
void set_effect(Effects& effects, std::string_view name, double value);

/// Sets a number of the plant by its field name, integers included. Throws as set_effect does.
void set_parameter(PlantParameters& parameters, std::string_view name, double value);

void set_environment(Environment& environment, std::string_view name, double value);

/// "free", "locked", "spring", "kelvin_voigt", "hunt_crossley". Throws as set_effect does.
[[nodiscard]] EnvironmentKind environment_kind(std::string_view name);

/// Whether this number of an environment is looked at by that kind.
[[nodiscard]] bool plays_a_part(EnvironmentKind kind, std::string_view name);

/// "quasi_static", "dynamic". Throws as set_effect does.
[[nodiscard]] SolverMode solver_mode(std::string_view name);

}  // namespace capstan::sim
