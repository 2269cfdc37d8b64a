// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "capstan/tests/tools/plant/effect_benchmark.hpp"
#include "capstan/tests/tools/plant/independent_plant.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools::plant {

/// Motions that a laboratory would use, joint angles within 0.6 rad: sums of sines, triangles with reversals of several
/// sizes, smooth ramps between holds, a random walk; and slow pulls at a joint that is held.
enum class LabMotion { kSines, kTriangles, kRamps, kWalk, kPulls };
inline constexpr int kLabMotions = 4;  ///< of a free joint
auto name_of(LabMotion motion) -> std::string;

/// An experiment: how it is moved and logged.
struct LabExperiment {
  LabMotion motion = LabMotion::kSines;
  std::uint64_t seed = 1, noise_seed = 1;  ///< of the motion, of noises
  double rate_hz = 500.0;                  ///< of the log
  double repeat_s = 15.0;                  ///< after which the motion comes again; the log lasts 60 s
};

/// An instrument drawn by chance from the ranges of drawn_plant(), guides unevenly loaded: 8 to 16 per tendon, shares
/// of its friction up to 1.5 times each other's.
auto independent_joint(std::uint64_t seed) -> independent::Parameters;
/// The experiment drawn for it.
auto drawn_experiment(std::uint64_t seed) -> LabExperiment;

/// The log of an experiment, in the contract's form.
/// @param keep  file that it is also written to; none if empty
auto log_of(const independent::Parameters& joint, const LabExperiment& experiment, const std::string& keep = {})
    -> AxisLog;

/// A drawn instrument in its experiment, and the switches of its effects.
auto switched_independent_joint(std::uint64_t seed) -> std::unique_ptr<SwitchedJoint>;

}  // namespace capstan::tools::plant
