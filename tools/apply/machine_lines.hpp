// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace capstan::tools {

inline constexpr std::string_view kMachineSchema = "capstan.machine/1";
inline constexpr std::string_view kMachineFamily = "capstan.machine/";

/// Whether the answer to `get NAME` says what `set NAME VALUE` asked for, in whichever unit of the parameter. The board
/// rounds to 2^-24 and prints what tells that step from the next, seven decimals; nothing else may differ.
auto reports(const std::string& answer, const std::string& set_line) -> bool;

/// The shell lines that set up a board as another one was commissioned, from 'maintenance open' to 'maintenance close'.
/// Throws BadInput with the line and the cure.
/// @param text  of a machine.toml of `capstan commission`   @param file  its name
auto machine_lines(const std::string& text, const std::string& file) -> std::vector<std::string>;

}  // namespace capstan::tools
