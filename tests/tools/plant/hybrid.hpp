// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "capstan/hal/sim/parameters.hpp"
#include "capstan/tools/joint_file/joint_file.hpp"

namespace capstan::tools::plant {

/// Angle and torque of a joint by one law, whatever the tip touches.
struct HybridError {
  double angle_rad = 0.0;     ///< rms, of the joint's true angle
  double torque_share = 0.0;  ///< rms, of the range of the joint's torque with the tip held
  double largest_nm = 0.0;    ///< of the joint's torque in this motion
};

/// A law of tendons from a free motion and one with the tip held.
auto hybrid_law(const sim::PlantParameters& plant, std::uint64_t seed) -> JointFile;

/// The law on the board's numbers while a hand turns the motor to and fro, the tip on a spring.
/// @param spring_nm_per_rad  0: free; infinite: held
/// @param range_nm  of the joint's torque with the tip held
auto hybrid_error(const JointFile& law, const sim::PlantParameters& plant, double spring_nm_per_rad, double range_nm)
    -> HybridError;

/// Largest less least torque of the joint in that motion with the tip held, N m.
auto torque_range(const sim::PlantParameters& plant) -> double;

/// Prints them for joints drawn by these seeds.
void ask_hybrid(std::uint64_t first, int joints);

}  // namespace capstan::tools::plant
