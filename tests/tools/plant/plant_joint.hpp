// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "capstan/hal/sim/scenario.hpp"
#include "capstan/tests/tools/plant/effect_benchmark.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools::plant {

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

/// A drawn plant and the switches of its effects.
auto switched_joint(std::uint64_t seed, PlantMotion motion) -> std::unique_ptr<SwitchedJoint>;

}  // namespace capstan::tools::plant
