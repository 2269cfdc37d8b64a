// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "firmware/shell.hpp"

namespace capstan {

struct ShellCommand {
  const char* name;
  const char* arguments;
  const char* help;
  void (*run)(Shell& shell, std::string_view arguments);
};

/// Every command there is; `help` prints from it.
auto shell_commands() -> std::span<const ShellCommand>;

}  // namespace capstan
