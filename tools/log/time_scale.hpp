// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace capstan::tools {

/// What to say of a log whose time steps by this, if that can hardly be seconds: the unit it looks like and the option
/// that cures it. Empty if it can. A log that is that slow is read with --map "time_s=time_s*1".
/// @param period_s  median step of time_s
auto time_unit_fault(double period_s) -> std::string;

}  // namespace capstan::tools
