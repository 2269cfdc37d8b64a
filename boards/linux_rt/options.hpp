// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

#include "capstan/hal/linux/can_bus.hpp"
#include "capstan/hal/linux/gpio_lines.hpp"
#include "capstan/hal/linux/rt_loop.hpp"

namespace capstan {

/// The board's command line. No library for it: the cross build shall need no packages of the board's architecture.
struct BoardOptions {
  enum class Action : std::uint8_t { kRun, kSelftest, kHelp, kVersion };
  Action action = Action::kRun;
  std::string console = "stdio";
  std::string storage;            ///< empty: parameters are forgotten at the end
  std::optional<double> seconds;  ///< none: until told to stop
  RtOptions rt;
  CanSetup can;                   ///< without buses the joint is simulated
  GpioSetup gpio;                 ///< without a chip there are no lines
  bool simulated_drives = false;  ///< nobody can be hurt by what is on the buses
};

/// Throws std::runtime_error with "sentence; cure".
auto parse_options(std::span<char* const> arguments) -> BoardOptions;

auto help_text() -> const char*;

}  // namespace capstan
