// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tests/tools/blind/blind_joint.hpp"

namespace capstan::tools::blind {

/// What an axis may ask for beyond inertia and drag: effects with a name in the catalogue (Stribeck's and an asymmetry
/// come with Coulomb's, a load's friction with the weight, as on any machine), and effects that nobody has a name for.
auto listed_efforts() -> const std::vector<std::vector<std::string>>&;
auto unlisted_efforts() -> const std::vector<std::string>&;

struct BlindAxis {
  AxisLog log;
  Eigen::VectorXd noise;  ///< of the effort, sample by sample
  Eigen::VectorXd angle;  ///< of the motor, without the encoder's steps
  double inertia = 0.0, drag = 0.0;
  bool visible = true;  ///< as BlindJoint's, with inertia and drag as the base law
};

/// A driven axis that is drawn anew for every seed: motion, inertia, drag, encoder, rate, noise and the form and size
/// of its effects. The strength is the rms of the weakest effect outside the base law over that of the noise. No code
/// in common with the laws.
auto blind_axis(const Case& drawn) -> BlindAxis;

}  // namespace capstan::tools::blind
