// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "capstan/tools/commission/board_shell.hpp"

namespace capstan::tools {

/// A board that a command moves. Once this was called Ctrl-C, SIGTERM and a closed terminal end what waits for the
/// board: torque goes off and is not given again, and parameters go back. Throws BadInput: no such port.
auto open_board(const std::string& port) -> std::unique_ptr<BoardShell>;

/// Asks the person at the terminal. @param yes  a script's, which asks nobody
auto agrees(bool yes, const std::string& question) -> bool;

/// "commission.txt" as "commission.joint1.txt": what is known of one joint is not taken for another's.
auto with_joint(const std::string& name, int axis) -> std::string;

}  // namespace capstan::tools
