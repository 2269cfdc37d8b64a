// SPDX-License-Identifier: Apache-2.0
// Joints drawn about the built-in instruments, and what a person knows of them from data sheets.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "capstan/hal/sim/instrument.hpp"
#include "capstan/hal/sim/scenario.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {

/// The joint of a built-in instrument, as robot_finger or raven2:1.
inline auto joint_of(const std::string& text) -> sim::PlantParameters {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string name = text.substr(0, colon);
  const std::size_t axis = colon < text.size() ? std::stoul(text.substr(colon + 1)) : 0;
  if (sim::built_in_instrument(name).empty()) {
    throw BadInput("there is no instrument '" + name + "'");
  }
  return sim::parse_instrument(sim::built_in_instrument(name), name).axes.at(axis).plant;
}

/// That of CAPSTAN_INSTRUMENT, or the forceps.
inline auto instrument() -> sim::PlantParameters {
  const char* variable = std::getenv("CAPSTAN_INSTRUMENT");
  return variable == nullptr ? sim::PlantParameters{} : joint_of(variable);
}

/// What its data sheets tell the board. A motor of 30.2 mNm/A is a Maxon RE 40.
inline auto data_sheet(const sim::PlantParameters& plant, std::size_t axis = 0) -> std::vector<std::string> {
  const std::string set = "set joint" + std::to_string(axis) + ".";
  const double most_a = std::min(plant.current_limit_a, plant.current_full_scale_a);
  const double continuous_a = std::min(plant.torque_constant_nm_per_a < 0.05 ? 5.77 : 1.5, most_a);
  return {"maintenance open",
          set + "motor.encoder_counts " + std::to_string(std::lround(plant.encoder_counts_per_turn)),
          set + "motor.torque_per_current " + rounded(plant.torque_constant_nm_per_a) + " Nm/A",
          set + "limits.current " + rounded(std::min(2.0 * continuous_a, most_a)) + " A",
          set + "limits.continuous_current " + rounded(continuous_a) + " A",
          set + "motor_angle.beta " + rounded(plant.input_radius_m / plant.output_radius_m)};
}

inline auto draw(std::uint64_t seed, const sim::PlantParameters& joint = instrument()) -> sim::Scenario {
  Random random(seed * 7919);
  const auto between = [&](double low, double high) { return low * std::pow(high / low, random.uniform()); };
  sim::Scenario scenario;
  scenario.seed = seed;
  sim::PlantParameters& plant = scenario.plant;
  plant = joint;
  plant.motor_inertia_kgm2 *= between(0.6, 2.0);
  plant.motor_coulomb_nm *= between(0.5, 2.0);
  plant.motor_viscous_nms_per_rad *= between(0.5, 3.0);
  plant.pretension_n *= between(0.6, 1.3);
  const double stiffer = between(0.6, 1.6);
  plant.stiffness_top_n_per_m *= stiffer;
  plant.stiffness_bottom_n_per_m *= stiffer * between(0.9, 1.1);
  plant.current_noise_a *= between(0.5, 2.0);
  plant.current_offset_a = 0.01 * (random.uniform() - 0.5);
  plant.effects.play_half_width_rad = random.uniform() < 0.7 ? 0.0 : between(0.005, 0.02);
  plant.effects.gravity_torque_nm = random.uniform() < 0.7 ? 0.0 : between(0.001, 0.01);
  return scenario;
}

}  // namespace capstan::tools
