// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/model/force_law.hpp"
#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/replay/replay.hpp"

namespace capstan::tools {

inline constexpr std::size_t kForceDepth = 16;  ///< reversals that a board remembers

/// The force law of a joint file as a board takes it.
struct BoardForceLaw {
  ForceLawParameters<double> parameters;
  PreisachTable table;  ///< of preisach
};

/// The law of the [force] section; none there: kNone. Throws BadInput with file and cure.
auto read_board_force_law(const std::string& joint_file, const std::string& name) -> BoardForceLaw;

struct ReplayedForce {
  Eigen::VectorXd torque_nm;  ///< of the joint
  long unknown = 0;           ///< samples, from the first on, whose past still matters: taken as demagnetised
  long beyond = 0;            ///< samples beyond the law's table, or at the end of the range of numbers
};

/// A log with the rows that the channels of an axis's force law have in common, where they have different rates; else
/// as it is.
auto force_rows(const CsvLog& log, int axis, std::vector<std::string>& notes) -> CsvLog;

/// Runs a force law over the motor's torque as the firmware does, which asks it for what the motor was told. kFixed is
/// the firmware's arithmetic; the law has no clock, so any rate will do.
auto replay_force(const Eigen::VectorXd& tau_nm, const BoardForceLaw& law, Arithmetic arithmetic) -> ReplayedForce;

}  // namespace capstan::tools
