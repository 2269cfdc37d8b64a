// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "capstan/hal/sim/scenario.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools::plant {

/// A switch of the plant's effects, and what the catalogue calls it.
struct Switch {
  std::string name;      ///< of the effect in the plant
  std::string expected;  ///< in the catalogue; empty: foreign to it
  double sim::Effects::*size;
  double usual;  ///< with which a search for the size wanted begins, in the switch's unit
  double most;   ///< beyond which the plant refuses it, or nobody would call it small
};
auto switches() -> const std::vector<Switch>&;

/// The motions that joints are driven with.
enum class PlantMotion { kIdentify, kDecaying, kLadder, kPull };
inline constexpr PlantMotion kPlantMotions[] = {PlantMotion::kIdentify, PlantMotion::kDecaying, PlantMotion::kLadder};
auto name_of(PlantMotion motion) -> std::string;

/// An instrument drawn by chance: friction, stiffness, pretension, radii, motor and joint of the built-in ones, each
/// changed by its own factor.
auto drawn_plant(std::uint64_t seed) -> sim::PlantParameters;

/// As far as the motor can pull at a tip that is held, rad: tendons of one side alone, some 0.15 Nm.
auto pull_of(const sim::PlantParameters& plant) -> double;

/// The log of a plant that the firmware moves, its law the ratio alone. Throws Refusal where the firmware stops.
/// @param keep  file that the log is also written to; none if empty
auto log_of(const sim::PlantParameters& plant, PlantMotion motion, std::uint64_t seed, const std::string& keep = {})
    -> AxisLog;
/// The same with every column.
auto csv_of(const sim::PlantParameters& plant, PlantMotion motion, std::uint64_t seed, const std::string& keep = {})
    -> CsvLog;

}  // namespace capstan::tools::plant
