// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/replay/board_effort_law.hpp"
#include "capstan/tools/replay/replay.hpp"
#include "capstan/tools/select/effort_law.hpp"

namespace capstan::tools {

/// The name of the estimate's column: "axis0/tau_est_Nm" of "axis0/tau_Nm".
auto estimate_column(const std::string& target) -> std::string;

/// Of a log whose channels have different rates, the rows that they have in common.
struct EffortReplay {
  std::string text;  ///< these rows with the estimate appended
  AxisLog log;       ///< with what is to be said of them
};
/// Runs an effort's law over a log, the motion being given.
/// @param axis  the log's axis; the law's own, with another number, is meant
auto replay_effort(const CsvLog& csv, int axis, const EffortLaw& law) -> EffortReplay;

/// What a board says of a log, row by row.
struct BoardEffort {
  Eigen::VectorXd law;          ///< the law's torque of the row, which the board has `delay` rows later
  Eigen::VectorXd disturbance;  ///< as the board says it in this row; 0 until its window is full
  Eigen::Index saturated = 0;   ///< rows in which a number met the end of the range of numbers
  Eigen::Index delay = 0;
};

/// The firmware's law over a log, causal: in double at any rate, in fixed point at 1 kHz. Throws Refusal.
auto run_board_effort(const AxisLog& log, const BoardEffortLaw& law, Arithmetic arithmetic) -> BoardEffort;

struct BoardEffortReplay : EffortReplay {  ///< with the disturbance, too
  BoardEffort effort;
};
/// The same in fixed point for a whole log file. Throws Refusal where no board runs the law.
/// @param name  of the law's file
auto replay_board_effort(const CsvLog& csv, int axis, const EffortLaw& law, const std::string& name)
    -> BoardEffortReplay;

}  // namespace capstan::tools
