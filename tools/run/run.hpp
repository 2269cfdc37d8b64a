// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "capstan/boards/sim/sim_board.hpp"

namespace capstan::tools {

/// Errors of one joint against its camera, root mean square, rad.
struct JointErrors {
  double estimation_rmse_rad = 0.0;
  double tracking_rmse_rad = 0.0;  ///< 0 on the bench: there is no reference
};

struct RunSummary {
  double seconds = 0.0;
  std::vector<JointErrors> joints;
  std::string fault;  ///< empty, or what took the torque away, with cause and cure
};

/// Runs the firmware on the scenario's instrument, every axis of it: what the motors' nameplates say, shell lines, the
/// models' lines, arm, the motions streamed as references, disarm. A scenario of torques runs on the bench instead:
/// supplies drive the motors, and the disarmed firmware measures and estimates. As fast as it goes.
/// @param log  receives the log by the contract, or nullptr
/// Throws BadInput with the line and the shell's answer if a line is refused, Refusal if the plant diverges.
auto run_scenario(const sim::Scenario& scenario, const std::vector<std::string>& model, Banks& banks, std::ostream* log)
    -> RunSummary;

/// Shell lines for encoder and torque constant of every motor that differ from what the firmware holds.
auto nameplate_lines(const sim::Scenario& scenario, const Machine& machine) -> std::vector<std::string>;

}  // namespace capstan::tools
