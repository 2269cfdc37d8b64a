// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/jobs/logs.hpp"
#include "capstan/tools/replay/force_replay.hpp"
#include "capstan/tools/replay/replay.hpp"

namespace capstan::tools {

/// A law of a joint angle over a log, every row of it.
struct AngleReplay {
  CsvLog csv;  ///< the rows that the axis's channels have in common
  AxisLog log;
  Replayed estimates;
};
auto replay_angle(const CsvLog& log, int axis, const JointFile& joint, Arithmetic arithmetic, const Say& warn)
    -> AngleReplay;

/// Torque of the joint by a force law, row by row. @pre it is one: not kNone
auto replay_torque(const CsvLog& log, int axis, const BoardForceLaw& law, Arithmetic arithmetic, const Say& warn)
    -> Eigen::VectorXd;

/// Throws Refusal where a number met the end of its range. @param law  what to call it
void refuse_saturated(long samples, const std::string& law);

}  // namespace capstan::tools
