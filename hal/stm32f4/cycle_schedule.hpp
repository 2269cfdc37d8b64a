// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace capstan::stm32f4 {

/// Decides which ticks get a cycle. The policy for overruns is: skip to the next edge and count what was skipped; never
/// catch up with cycles that follow each other too closely, since the law's dt is a constant.
class CycleSchedule {
 public:
  /// A cycle may begin this fraction of a period after its edge. The serial interrupts that may go first take
  /// microseconds.
  static constexpr std::uint32_t kLatestFraction = 8;

  /// @param tick  ticks since start  @param since_edge  core cycles since the last of them  @param period  core cycles
  /// of one True: run a cycle now.
  [[nodiscard]] constexpr auto rt_begin(std::uint32_t tick, std::uint32_t since_edge, std::uint32_t period) noexcept
      -> bool {
    const std::uint32_t passed = tick - last_;
    last_ = tick;
    if (passed == 0) {
      return false;  // pended twice for one edge
    }
    const bool late = since_edge > period / kLatestFraction;
    overruns_ += passed - 1 + (late ? 1U : 0U);
    return !late;
  }

  /// Cycles that were skipped since start. Wraps.
  [[nodiscard]] constexpr auto overruns() const noexcept -> std::uint32_t { return overruns_; }

 private:
  std::uint32_t last_ = 0;
  std::uint32_t overruns_ = 0;
};

}  // namespace capstan::stm32f4
