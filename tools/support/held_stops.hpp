// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <csignal>

namespace capstan::tools {

/// Keeps Ctrl-C and SIGTERM from ending this program while it lives; one that came ends it afterwards.
class HeldStops {
 public:
  HeldStops();
  HeldStops(const HeldStops&) = delete;
  auto operator=(const HeldStops&) -> HeldStops& = delete;
  ~HeldStops();
  /// Whether one came within this time, or before.
  [[nodiscard]] auto came(std::chrono::milliseconds wait) -> bool;
  [[nodiscard]] auto came() const -> bool { return came_; }
  /// What a program is to begin with.
  [[nodiscard]] auto usual() const -> const sigset_t& { return usual_; }

 private:
  sigset_t stops_{}, usual_{};
  bool came_ = false;
};

}  // namespace capstan::tools
