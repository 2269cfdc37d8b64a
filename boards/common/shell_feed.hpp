// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "capstan/boards/common/console.hpp"
#include "capstan/firmware/console/shell_input.hpp"

namespace capstan {

/// Carries characters from a console to the shell by the rules of ShellInput. What finds no room there waits in the
/// operating system, so a host that sends everything at once loses nothing; but for the lines behind a log or an
/// experiment under torque, which are read at once because one of them may stop it. A banner is printed on connect.
class ShellFeed {
 public:
  /// Both outlive this object.
  ShellFeed(Console& console, Shell& shell) : console_(console), shell_(shell), input_(shell) {}

  /// Call it in the background loop. True: the peer has just gone, so whatever moves must stop. A line it left half
  /// typed and lines that still waited are forgotten then; only a script (input given as a whole) is carried out to its
  /// end first.
  [[nodiscard]] auto poll() -> bool;
  /// True when nobody can come any more and everything is answered.
  [[nodiscard]] auto done() const -> bool { return console_.finished() && input_.empty() && !ended_ && !shell_.busy(); }
  /// Sleeps until there may be something to do, at most this long.
  void wait(std::chrono::milliseconds at_most);

 private:
  void take();

  Console& console_;
  Shell& shell_;
  ShellInput input_;
  bool met_ = false;    // whoever is there now
  bool ended_ = false;  // a script has ended but is not carried out yet
};

}  // namespace capstan
