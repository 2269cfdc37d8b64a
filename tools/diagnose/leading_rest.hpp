// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools {

/// The log from where something moves, but for a short while of rest before it, and a warning that says so. A long rest
/// would take the place of motion among the rows that a law is learned from, chosen by and judged on. Logs with the
/// torque behind a gear or at the joint stay as they are: that may say something while nothing moves.
auto without_leading_rest(AxisLog log) -> AxisLog;

}  // namespace capstan::tools
