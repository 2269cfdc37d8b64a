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

/// Warns of a law that lacked `gravity` where the torque shows no such weight: a joint's pulley off its centre looks
/// the same in the angle. The name stays, for a torque that the weight was taken out of (as in the thesis's chapter 7)
/// shows none either.
void doubt_weight(const Preparation& p, Diagnosis& d);

}  // namespace capstan::tools
