// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "firmware/text.hpp"

namespace capstan {

/// What the shell asks of the board it runs on. For the background only.
class Board {
 public:
  [[nodiscard]] virtual auto name() const -> const char* = 0;
  /// What tells this very image from others of its version, as words that follow the version; nothing where a board has
  /// no images.
  virtual void print_image(Print& /*out*/) const {}
  /// How well the cycle keeps its time and what the console lost, in lines that end in CR LF.
  virtual void print_timing(Print& out) const = 0;
  /// Starts the firmware anew, after the answer has gone out. The shell has seen to it that no joint has torque.
  virtual void reboot() = 0;

 protected:
  ~Board() = default;  // never owned through this face: a virtual one would need operator delete
};

}  // namespace capstan
