// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "capstan/tests/tools/plant/independent_plant.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools::plant {

/// Motions that a laboratory would use, joint angles within 0.6 rad: sums of sines, triangles with reversals of several
/// sizes, smooth ramps between holds, a random walk; and slow pulls at a joint that is held.
enum class LabMotion { kSines, kTriangles, kRamps, kWalk, kPulls };
inline constexpr int kLabMotions = 4;  ///< of a free joint
inline constexpr double kLabDurationS = 60.0;
auto name_of(LabMotion motion) -> std::string;

/// An experiment: how it is moved and logged.
struct LabExperiment {
  LabMotion motion = LabMotion::kSines;
  std::uint64_t seed = 1, noise_seed = 1;  ///< of the motion, of noises
  double rate_hz = 500.0;                  ///< of the log
  double repeat_s = 15.0;                  ///< after which the motion comes again; the log lasts 60 s
};

/// The experiment drawn for a seed.
auto drawn_experiment(std::uint64_t seed) -> LabExperiment;
/// The same joint in another motion, that nothing was chosen on.
auto other_experiment(LabExperiment experiment) -> LabExperiment;

/// What is asked for by time in s: the joint's angle, or of pulls the motor's, as far as `pull`, rad. It turns back
/// where it would begin anew: no laboratory lets its joint jump.
auto lab_course(const LabExperiment& experiment, double pull) -> std::function<double(double)>;

/// The log of an experiment, in the contract's form.
/// @param held  with the torque on the joint
/// @param keep  file that it is also written to; none if empty
auto lab_log(const std::vector<independent::Row>& rows, bool held, const LabExperiment& experiment,
             const std::string& keep) -> AxisLog;

}  // namespace capstan::tools::plant
