// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace capstan::tools {

/// Counts what waits for somebody who listens to a board, bytes.
class Backlog {
 public:
  using Clock = std::chrono::steady_clock;

  /// Two minutes of eight signals at 1 kHz; who has not taken as much by then will not any more.
  static constexpr std::size_t kMost = std::size_t{8} << 20U;
  /// So much that the board had better be heard later: an answer stands behind what waits.
  static constexpr std::size_t kMuch = std::size_t{256} << 10U;
  /// With somebody who takes nothing: he must not stop the others.
  static constexpr std::chrono::seconds kPatience{1};

  void add(std::size_t count, Clock::time_point now) {
    if (waiting_ == 0) {
      took_ = now;
    }
    waiting_ += count;
  }
  void take(std::size_t count, Clock::time_point now) {
    waiting_ -= std::min(count, waiting_);
    took_ = now;
  }
  /// True while much waits and some of it is being taken.
  [[nodiscard]] auto behind(Clock::time_point now) const -> bool { return waiting_ > kMuch && now - took_ < kPatience; }
  [[nodiscard]] auto has_room_for(std::size_t count) const -> bool { return waiting_ + count <= kMost; }

 private:
  std::size_t waiting_ = 0;
  Clock::time_point took_{};
};

}  // namespace capstan::tools
