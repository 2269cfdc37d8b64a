// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/diagnose/preparation.hpp"

namespace capstan::tools {

/// How much of a law's weight the motor's torque holds.
struct WeightInTorque {
  double needed_nm = 0.0;      ///< amplitude that moves the joint as the law's gravity does, by its elongation
  double share = 0.0;          ///< of that wave over the joint's angle in the torque, beside friction, drag and mass
  double share_at_most = 0.0;  ///< upper end of its 95 % interval
};

/// Asks the torque for the weight of a law. Nothing where there is no torque or no elongation that turns it into an
/// angle.
auto weight_in_torque(const Preparation& p, const JointFile& law) -> std::optional<WeightInTorque>;

/// Where the torque shows no such weight, `gravity` is not the only answer: a joint's pulley out of its centre looks
/// the same in the angle. It becomes the first effect, with angle_periodic as its alternative, and the verdict
/// `ambiguous`.
void doubt_weight(const Preparation& p, Diagnosis& d);

}  // namespace capstan::tools
