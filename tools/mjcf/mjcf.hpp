// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tools/joint_file/joint_file.hpp"

namespace capstan::tools {

/// Names in the MuJoCo model that the fragment is for.
struct MjcfNames {
  std::string motor = "motor";     ///< hinge of the motor, rad
  std::string joint = "joint";     ///< hinge that the tendon moves, rad
  std::string tendon = "capstan";  ///< what the fragment's own elements begin with
};

/// A law as the tendon of a simulated joint.
struct Mjcf {
  std::string text;                   ///< to be included in a model
  std::vector<std::string> left_out;  ///< terms of the law that are not in it
  std::vector<std::string> warnings;  ///< why, and the cure
};

/// The tendon between the two hinges: its ratio; its elasticity, from how far the joint lags behind under torque; the
/// gap of a play, which then stands for the elasticity too; friction, from the torque of steady motion. MuJoCo computes
/// the torques that the law only knows: at a slow motion its joint goes where the law says. Throws Refusal for a law
/// without a ratio, and for one of tendons with friction (`tendon`) in a file without the torque of steady motion.
auto mjcf_of(const JointFile& joint, const MjcfNames& names) -> Mjcf;

}  // namespace capstan::tools
