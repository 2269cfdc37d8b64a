// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <termios.h>

#include <utility>

namespace capstan {

/// Makes a line transparent: no echo, no editing, no signals, 8 bits. With `speed` other than 0 also 8N1 at that speed.
/// False if the file is no terminal.
auto make_raw(int fd, speed_t speed = 0) -> bool;

/// Puts the terminal on standard input into character mode as long as this object lives. What it was before comes back
/// at its end, at exit() and when a signal ends the program. Does nothing if standard input is no terminal. Ctrl-C
/// still ends the program. Ctrl-Z is switched off: a stopped process leaves a joint without its controller.
class CharacterMode {
 public:
  CharacterMode();
  CharacterMode(CharacterMode&& other) noexcept : active_(std::exchange(other.active_, false)) {}
  CharacterMode(const CharacterMode&) = delete;
  auto operator=(const CharacterMode&) -> CharacterMode& = delete;
  auto operator=(CharacterMode&&) -> CharacterMode& = delete;
  ~CharacterMode();

  [[nodiscard]] auto active() const -> bool { return active_; }

 private:
  bool active_ = false;
};

}  // namespace capstan
