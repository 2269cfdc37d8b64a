// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "capstan/hal/linux/file_descriptor.hpp"

namespace capstan::tools {

/// What an answer may take: an experiment stays silent while the joint goes to where it begins, and commissioning until
/// it is over.
inline constexpr std::chrono::minutes kLongestAnswer{15};

/// A line as a board meant it, without its end and what prompts put before it.
auto bare_line(std::string_view line) -> std::string_view;

/// The host's end of a board's shell: one line out, one answer back. Waits for each answer, so no character is lost.
class ShellClient {
 public:
  /// @param port  "tcp:PORT" on this machine, or a serial device or pseudo-terminal
  /// Throws BadInput if it can not be opened.
  explicit ShellClient(const std::string& port);

  /// The lines of the answer, without its "ok". Throws Refusal with the board's sentence if it is an error, or if no
  /// answer comes in time; saving erases flash, which takes up to 2.6 s. A signal ends it with a Refusal, too; that
  /// answer is passed over when it comes after all.
  auto ask(const std::string& line, std::chrono::seconds patience = std::chrono::seconds{5})
      -> std::vector<std::string>;

  /// What came behind the last answer, a prompt for instance, and was not looked at yet.
  [[nodiscard]] auto take_rest() -> std::string { return std::exchange(received_, {}); }
  [[nodiscard]] auto descriptor() const -> int { return line_.get(); }

 private:
  auto read_line(std::chrono::steady_clock::time_point deadline) -> std::string;

  FileDescriptor line_;
  std::string port_;
  std::string received_;
  int owed_ = 0;  // answers that nobody waits for any more
};

}  // namespace capstan::tools
