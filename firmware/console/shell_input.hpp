// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/firmware/console/shell.hpp"

namespace capstan {

/// Carries received characters to the shell, no faster than the shell answers: what comes meanwhile waits here. Two
/// things overtake what waits: Ctrl-C ends what streams and forgets the lines before it, and the line `disarm` takes
/// torque away the moment it is complete, and is answered in its turn. Neither needs room to be heard.
class ShellInput {
 public:
  explicit ShellInput(Shell& shell) : shell_(shell) {}

  /// Characters that take() can be given before the next poll() so that none is lost.
  [[nodiscard]] auto room() const -> std::size_t { return waiting_.size() - count_; }
  /// Characters to give it before the next poll(): its room, or some without room while a joint has torque and an
  /// answer goes on, for one of them may stop it.
  [[nodiscard]] auto wants() const -> std::size_t {
    constexpr std::size_t kToHear = 64;
    return room() > 0 ? room() : shell_.must_listen() ? kToHear : 0;
  }
  [[nodiscard]] auto empty() const -> bool { return count_ == 0; }
  /// True when a line is half typed.
  [[nodiscard]] auto in_line() const -> bool { return in_line_ || !empty(); }
  /// One received character. Without room it is lost, and the shell refuses its line as damaged. Of a `disarm` that
  /// finds no room all lines before it are lost.
  /// @param urgent  false for a script that was given as a whole: in it nothing overtakes but Ctrl-C
  void take(char c, bool urgent = true);
  /// Lets the shell go on and hands it what it can take. Call it in the background loop.
  void poll();
  /// The peer is gone: so is what it still had to say, what streams to it and what it had opened.
  void peer_left();

 private:
  auto ends_disarm(char c) -> bool;
  /// False: no room.
  auto push(char c) -> bool;
  void disarm_without_room();
  /// What waits and what streams.
  void forget();

  Shell& shell_;
  std::array<char, 256> waiting_{};  // a ring
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  bool in_line_ = false;
  std::array<char, 12> start_{};  // of the line that is arriving; enough to tell "disarm" from longer words
  std::size_t length_ = 0;
  bool lost_ = false;      // characters, since the last one that found room
  bool lost_end_ = false;  // the last of them ended a line
};

}  // namespace capstan
