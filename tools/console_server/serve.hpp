// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace capstan::tools {

struct ConsoleOptions {
  std::string port;  ///< of a board; empty: the simulator
  std::uint16_t listen = 0;
  std::string page;      ///< folder; empty: beside this program
  std::string scenario;  ///< of the simulator, TOML; empty: one joint
};

/// Serves the page until SIGINT or SIGTERM; the board's torque goes then. @param ready  is told the page's address
/// Throws BadInput with a sentence.
void serve_console(const ConsoleOptions& options, const std::function<void(const std::string&)>& ready);

}  // namespace capstan::tools
