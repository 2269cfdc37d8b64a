// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools::blind {

enum class Motion { kSine, kMultisine, kLadder, kTriangles };
inline constexpr Motion kMotions[] = {Motion::kSine, Motion::kMultisine, Motion::kLadder, Motion::kTriangles};
auto motion_name(Motion motion) -> const char*;

/// Effects with a name in the catalogue, and effects that nobody has a name for.
auto listed_effects() -> const std::vector<std::string>&;
auto unlisted_effects() -> const std::vector<std::string>&;

struct Case {
  std::vector<std::string> truths;  ///< none, one or two
  bool effort = false;              ///< of an axis whose effort is to be explained, not of a joint's angle
  Motion motion = Motion::kLadder;
  double strength = 1.0;  ///< rms of each effect outside the span of the base law, over the rms of the sensor's noise
  bool repeats = true;    ///< the same cycle four times; else one long motion
  std::uint64_t seed = 1;
};

struct BlindJoint {
  AxisLog log;
  double noise_rad = 0.0;  ///< standard deviation of the joint sensor's noise
  /// What no law that reads these sensors can go below: noise of the joint sensor and of the torque, the encoder's
  /// resolution, and what is unknown until the encoder shows that the motor has turned back.
  double floor_rad = 0.0;
  /// False where ratio, offset and elongation take up all but 3 % of an effect by themselves on this motion, as a sine
  /// does with inertia: nobody could name it.
  bool visible = true;
};

/// A joint that is drawn anew for every seed: ratio, elasticity, friction, load, noise, rate and the form and size of
/// its effects. No code in common with the laws. Torque and motor angle are what sensors make of them.
auto blind_joint(const Case& drawn) -> BlindJoint;

}  // namespace capstan::tools::blind
