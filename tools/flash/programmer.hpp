// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <csignal>
#include <string>
#include <vector>

namespace capstan::tools {

/// What a program that writes flash is given.
struct FlashJob {
  std::string sector0_file;  ///< bytes for 0x08000000
  std::string code_file;     ///< bytes for 0x0800C000
  std::string serial;        ///< device at the chip's serial boot loader, for stm32flash
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

/// Keeps Ctrl-C and SIGTERM from ending this program while it lives; one that came ends it afterwards.
class HeldStops {
 public:
  HeldStops();
  HeldStops(const HeldStops&) = delete;
  auto operator=(const HeldStops&) -> HeldStops& = delete;
  ~HeldStops();
  /// Whether one came within this time, or before.
  [[nodiscard]] auto came(std::chrono::milliseconds wait) -> bool;
  [[nodiscard]] auto came() const -> bool { return came_; }
  /// What a program is to begin with.
  [[nodiscard]] auto usual() const -> const sigset_t& { return usual_; }

 private:
  sigset_t stops_{}, usual_{};
  bool came_ = false;
};

/// Runs one command with its output on standard error; its exit status, 127 if it could not be started. A stop that
/// comes meanwhile ends it, too.
auto run_program(const CommandLine& command, HeldStops& stops) -> int;

}  // namespace capstan::tools
