// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "capstan/firmware/parameters/config.hpp"
#include "capstan/hal/sim/plant.hpp"

namespace capstan::tools {

/// The motor observer's values of a simulated joint, by the way that a user goes: over the firmware's shell, with
/// `maintenance open`, `arm` and `commission joint0`. Throws std::runtime_error with the shell's answer if it refuses.
[[nodiscard]] auto commissioned(const sim::PlantParameters& plant, const AxisConfig& config, std::uint64_t seed)
    -> ObserverConfig;

}  // namespace capstan::tools
