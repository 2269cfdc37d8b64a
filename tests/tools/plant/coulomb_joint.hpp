// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "capstan/tests/tools/plant/coulomb_plant.hpp"
#include "capstan/tests/tools/plant/effect_benchmark.hpp"
#include "capstan/tests/tools/plant/lab_motion.hpp"

namespace capstan::tools::plant {

/// An instrument drawn by chance, larger than those of the other plants: a hand's or an arm's. One in two has a camera
/// that is late by 4 to 20 ms on every day.
auto coulomb_joint(std::uint64_t seed) -> coulomb::Parameters;

/// The log of an experiment, in the contract's form.
/// @param keep  file that it is also written to; none if empty
auto log_of(const coulomb::Parameters& joint, const LabExperiment& experiment, const std::string& keep = {}) -> AxisLog;

/// A drawn instrument in its experiment, and the switches of its effects.
auto switched_coulomb_joint(std::uint64_t seed) -> std::unique_ptr<SwitchedJoint>;

}  // namespace capstan::tools::plant
