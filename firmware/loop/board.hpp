// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "capstan/firmware/console/text.hpp"
#include "capstan/firmware/safety/safe_stop.hpp"

namespace capstan {

/// What came of a command of the board's own. kRefused: the error is already printed.
enum class BoardAnswer : std::uint8_t { kUnknown, kDone, kRefused };

/// What the shell asks of the board it runs on. For the background only.
class Board {
 public:
  [[nodiscard]] virtual auto name() const -> const char* = 0;
  /// What tells this very image from others of its version, as words that follow the version; nothing where a board has
  /// no images.
  virtual void print_image(Print& /*out*/) const {}
  /// How well the cycle keeps its time and what the console lost, in lines that end in CR LF.
  virtual void print_timing(Print& out) const = 0;
  /// Its joints are programs: nobody can be hurt, and what protects people from a joint may be left out.
  [[nodiscard]] virtual auto simulated() const -> bool { return false; }
  /// What it can stop a joint with.
  [[nodiscard]] virtual auto stop_means() const -> StopMeans { return {}; }
  /// Starts the firmware anew, after the answer has gone out. The shell has seen to it that no joint has torque.
  virtual void reboot() = 0;
  /// Carries out a command that only this board knows. An answer of its own it ends in CR LF, as an error in the
  /// shell's form.
  virtual auto run_command(std::string_view /*word*/, std::string_view /*rest*/, Print& /*out*/) -> BoardAnswer {
    return BoardAnswer::kUnknown;
  }
  /// The lines of `help` about these commands.
  virtual void print_commands(Print& /*out*/) const {}

 protected:
  ~Board() = default;  // never owned through this face: a virtual one would need operator delete
};

}  // namespace capstan
