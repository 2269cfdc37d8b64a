// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "boards/sim/sim_board.hpp"

namespace capstan::tools {

/// Errors of a run against the joint camera, root mean square, rad.
struct RunSummary {
  double seconds = 0.0;
  double estimation_rmse_rad = 0.0;
  double tracking_rmse_rad = 0.0;
  std::string fault;  ///< empty, or what took the torque away, with cause and cure
};

/// Runs the firmware on the scenario's plant: shell lines, then the model's lines, arm, the motion streamed as
/// references, disarm. As fast as it goes.
/// @param log  receives the log by the contract, or nullptr
/// Throws BadInput with the line and the shell's answer if a line is refused.
auto run_scenario(const sim::Scenario& scenario, const std::vector<std::string>& model, Banks& banks, std::ostream* log)
    -> RunSummary;

}  // namespace capstan::tools
