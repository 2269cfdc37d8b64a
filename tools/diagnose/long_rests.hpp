// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools {

/// The log of a joint angle without most of each long rest, in which neither motors nor joint move, and a warning that
/// says so. A long rest would take the place of motion among the rows that a law is learned from, chosen by and judged
/// on. A short while of each stays, where filters settle, and the times stay those of the file. A joint that creeps
/// does not rest. Logs of efforts and torques stay as they are: those say something while nothing moves.
auto without_long_rests(AxisLog log) -> AxisLog;

}  // namespace capstan::tools
