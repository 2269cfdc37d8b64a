// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "capstan/tests/tools/plant/effect_benchmark.hpp"
#include "capstan/tests/tools/plant/independent_plant.hpp"
#include "capstan/tests/tools/plant/lab_motion.hpp"

namespace capstan::tools::plant {

/// An instrument drawn by chance from the ranges of drawn_plant(), guides unevenly loaded: 8 to 16 per tendon, shares
/// of its friction up to 1.5 times each other's.
auto independent_joint(std::uint64_t seed) -> independent::Parameters;

/// The log of an experiment, in the contract's form.
/// @param keep  file that it is also written to; none if empty
auto log_of(const independent::Parameters& joint, const LabExperiment& experiment, const std::string& keep = {})
    -> AxisLog;

/// A drawn instrument in its experiment, and the switches of its effects.
auto switched_independent_joint(std::uint64_t seed) -> std::unique_ptr<SwitchedJoint>;

}  // namespace capstan::tools::plant
