// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace capstan::tools {

/// The exit statuses of the host program.
inline constexpr int kExitDone = 0;
inline constexpr int kExitRefused = 1;
inline constexpr int kExitBadInput = 2;

/// What the user gave can not be used. The message is one sentence that says what is wrong, where, and the cure.
class BadInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The input is sound, but the honest answer is no. The message says why and what would change it.
class Refusal : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// "file:line: " for the start of a message.
inline auto place(const std::string& file, std::size_t line) -> std::string {
  return file + ":" + std::to_string(line) + ": ";
}

}  // namespace capstan::tools
