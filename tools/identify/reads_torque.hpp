// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/identify/law_fit.hpp"

namespace capstan::tools {

/// Whether any term of a joint angle's law changes with the motor's torque, its shapes being what they are: a table may
/// be over the torque or over something else. Such a law says nothing of a log without torque.
auto reads_torque(const LawForm& form) -> bool;

}  // namespace capstan::tools
