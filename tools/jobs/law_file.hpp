// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools {

/// A warning where a file can not hold all of the law.
void warn_of_left_out(Diagnosis& d);

/// Whether it is a law of the joint's torque by a reversal table, with or without effects.
auto is_reversal_table(const JointFile& law) -> bool;
/// Writes that table. Returns the status of what is written: without its effects no more than a base law.
/// @pre is_reversal_table()
auto write_reversal_table(const JointFile& law, const std::string& path) -> std::string;

}  // namespace capstan::tools
