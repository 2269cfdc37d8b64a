// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/model/disturbance.hpp"
#include "capstan/tools/select/effort_law.hpp"

namespace capstan::tools {

/// A law of an effort as a board runs it.
struct BoardEffortLaw {
  TorqueLawParameters<double> law;  ///< acceleration in krad/s2
  MotionView<double> view;
};

/// Throws BadInput with the cure where a board can not run the law: the torque behind a gear, a linear axis, another
/// column than the motor's torque, what another joint's motion brings, numbers beyond its range.
/// @param name        of the file
/// @param any_number  whether numbers beyond a board's range will do, in double
auto board_effort_law(const EffortLaw& law, const std::string& name, bool any_number = false) -> BoardEffortLaw;

}  // namespace capstan::tools
