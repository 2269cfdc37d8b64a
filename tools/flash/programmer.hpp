// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <csignal>
#include <string>
#include <vector>

#include "capstan/tools/support/held_stops.hpp"

namespace capstan::tools {

/// What a program that writes flash is given.
struct FlashJob {
  std::string sector0_file;  ///< bytes for 0x08000000
  std::string code_file;     ///< bytes for 0x0800C000
  std::string serial;        ///< device at the chip's serial boot loader, for stm32flash
  std::size_t sector0_bytes = 0, code_bytes = 0;
};

using CommandLine = std::vector<std::string>;

/// Programs that can write the board, best first: by the debug port openocd and st-flash, in the chip's own boot loader
/// dfu-util over USB and stm32flash over the console's port.
auto programmers() -> const std::vector<std::string>&;

/// `wanted`, or if that is empty the first one that is in PATH; stm32flash only if `serial` is known. Throws BadInput
/// for a name that is none of them, Refusal if none is there.
auto choose_programmer(const std::string& wanted, const std::string& serial) -> std::string;

/// Command lines that write both pieces, code first, so that a board whose flashing was cut short still has the
/// start-up code that finds its image damaged and says so; verify where the program can; restart the chip at the end.
auto programming_commands(const std::string& programmer, const FlashJob& job) -> std::vector<CommandLine>;

/// Runs one command with its output on standard error; its exit status, 127 if it could not be started. A stop that
/// comes meanwhile ends it, too.
auto run_program(const CommandLine& command, HeldStops& stops) -> int;

}  // namespace capstan::tools
