// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace capstan::tools {

/// What holds for the words of every command and CLI11 does not ask: numbers are finite and fit their type, and no
/// file that is written is one that is read, or is written twice.
/// @pre the command was parsed, and nothing of it was carried out. Throws BadInput.
void expect_sound(const CLI::App& command);

}  // namespace capstan::tools
