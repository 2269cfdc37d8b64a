// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace capstan {

/// Memory that outlives the firmware, as the retained RAM of a microcontroller outlives its reset: it stays while the
/// firmware starts anew in the same program and, if it is a file, also when the program is killed. All zero at first.
class RetainedMemory {
 public:
  /// Gone with the program.
  explicit RetainedMemory(std::size_t words);
  /// A file, made if it is not there. Not for a real-time thread: the system may stop a write while it saves the page.
  /// Throws std::runtime_error with "sentence; cure".
  RetainedMemory(const std::string& path, std::size_t words);
  RetainedMemory(const RetainedMemory&) = delete;
  auto operator=(const RetainedMemory&) -> RetainedMemory& = delete;
  ~RetainedMemory();

  [[nodiscard]] auto words() const -> std::span<std::uint32_t> { return words_; }

 private:
  void map(int fd, int flags, std::size_t words);
  std::span<std::uint32_t> words_;
};

}  // namespace capstan
