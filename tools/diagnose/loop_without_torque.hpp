// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/diagnose/preparation.hpp"

namespace capstan::tools {

/// Says of play that was found where no torque is logged that healthy tendons draw the same loop, by stretching under
/// their own friction, and which log tells the two apart. The law is the best there is either way.
void doubt_loop_without_torque(const Preparation& p, Diagnosis& d);

}  // namespace capstan::tools
