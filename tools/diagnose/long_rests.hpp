// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools {

/// The log of a joint angle without most of each long rest, in which neither motors nor joint move, and a warning that
/// says so. A long rest would take the place of motion among the rows that a law is learned from, chosen by and judged
/// on. A short while of each stays, where filters settle, and the times stay those of the file. A joint that creeps
/// does not rest. Logs of efforts and torques stay as they are: those say something while nothing moves.
auto without_long_rests(AxisLog log) -> AxisLog;

/// The law has a drift by the time since the start, or what it lacks is most like one. Such a law counts rows, as a
/// board does, and from a log without its rests it would learn of another time.
auto goes_by_time(const Diagnosis& d) -> bool;

}  // namespace capstan::tools
