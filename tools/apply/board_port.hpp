// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/hal/linux/file_descriptor.hpp"

namespace capstan::tools {

/// Opens a board's console, for one program at a time: "tcp:PORT" on this machine, or a serial device or
/// pseudo-terminal. Throws BadInput with a sentence and its cure.
auto open_board_port(const std::string& port) -> FileDescriptor;

}  // namespace capstan::tools
