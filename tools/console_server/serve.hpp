// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace capstan::tools {

struct ConsoleOptions {
  std::string port;  ///< of a board; empty: the simulator
  std::uint16_t listen = 0;
  std::string page;       ///< folder; empty: beside this program
  bool foxglove = false;  ///< the signals also by Foxglove's protocol
  std::string scenario;   ///< of the simulator, TOML; empty: one joint
};

/// Serves the page until SIGINT or SIGTERM; the board's torque goes then. @param ready  is told the address of the
/// page, and that of the signals for Foxglove or nothing. Throws BadInput with a sentence.
void serve_console(const ConsoleOptions& options,
                   const std::function<void(const std::string&, const std::string&)>& ready);

}  // namespace capstan::tools
