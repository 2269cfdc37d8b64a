// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <string>

#include "capstan/tools/console_server/hub.hpp"

namespace capstan::tools {

/// A board's console: "tcp:PORT", a serial device or a pseudo-terminal. Throws BadInput with a sentence.
auto open_port_line(boost::asio::io_context& io, const std::string& port, Hub::Listener listener)
    -> std::unique_ptr<BoardLine>;

/// The firmware on a simulated instrument, in real time. @param scenario  TOML; empty: one joint
/// Throws BadInput with a sentence.
auto open_simulated_line(boost::asio::io_context& io, const std::string& scenario, Hub::Listener listener)
    -> std::unique_ptr<BoardLine>;

}  // namespace capstan::tools
