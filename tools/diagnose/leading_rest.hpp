// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools {

/// The log of a joint angle from where something moves, but for a short while of rest before it, and a warning that
/// says so. A long rest would take the place of motion among the rows that a law is learned from, chosen by and judged
/// on. Logs of efforts and torques stay as they are: those say something while nothing moves.
auto without_leading_rest(AxisLog log) -> AxisLog;

}  // namespace capstan::tools
