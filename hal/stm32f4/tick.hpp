// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "capstan/hal/stm32f4/registers.hpp"

namespace capstan::stm32f4 {

/// The board's time base: the core's 24-bit down counter, which raises its interrupt once per cycle period.
template <RegisterCell Cell>
class Tick {
 public:
  explicit Tick(SysTickRegisters<Cell>& registers) noexcept : registers_(registers) {}

  /// False: the period does not fit into 24 bits and nothing was started.
  [[nodiscard]] auto start(std::uint32_t core_hz, std::uint32_t rate_hz) noexcept -> bool {
    const std::uint32_t period = core_hz / rate_hz;
    if (period < 2 || period - 1 > systick::kMaxReload) {
      return false;
    }
    period_ = period;
    registers_.csr.write(0);
    registers_.rvr.write(period - 1);
    registers_.cvr.write(0);
    resume();
    return true;
  }

  /// The board's time stands still from pause() to resume(): for a lock-step with something that has no real time. On
  /// the chip the running period may begin anew then.
  void pause() noexcept { registers_.csr.write(systick::kCsrInterrupt | systick::kCsrCoreClock); }
  void resume() noexcept {
    registers_.csr.write(systick::kCsrEnable | systick::kCsrInterrupt | systick::kCsrCoreClock);
  }

  void rt_isr() noexcept { count_.store(count_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

  /// Periods since start; wraps.
  [[nodiscard]] auto count() const noexcept -> std::uint32_t { return count_.load(std::memory_order_acquire); }
  /// Core cycles in a period.
  [[nodiscard]] auto period() const noexcept -> std::uint32_t { return period_; }

  /// Core cycles since the last edge.
  [[nodiscard]] auto since_edge() const noexcept -> std::uint32_t { return period_ - 1 - registers_.cvr.read(); }

  /// Core cycles since start, modulo 2^32: good for differences up to 25 s at 168 MHz. Callable wherever the tick's own
  /// interrupt can get in; the second look at the count catches a period that ended between the two reads.
  [[nodiscard]] auto core_cycles() const noexcept -> std::uint32_t {
    std::uint32_t before = count();
    std::uint32_t left = registers_.cvr.read();
    const std::uint32_t after = count();
    if (after != before) {
      before = after;
      left = registers_.cvr.read();
    }
    return before * period_ + (period_ - 1 - left);
  }

 private:
  SysTickRegisters<Cell>& registers_;
  std::uint32_t period_ = 0;
  std::atomic<std::uint32_t> count_{0};
};

/// Cost of one piece of code in core cycles: the last and the worst. Written in the interrupt, read anywhere.
class CycleMeter {
 public:
  void rt_add(std::uint32_t core_cycles) noexcept {
    last_.store(core_cycles, std::memory_order_relaxed);
    if (core_cycles > max()) {
      max_.store(core_cycles, std::memory_order_relaxed);
    }
  }
  [[nodiscard]] auto last() const noexcept -> std::uint32_t { return last_.load(std::memory_order_relaxed); }
  [[nodiscard]] auto max() const noexcept -> std::uint32_t { return max_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint32_t> last_{0};
  std::atomic<std::uint32_t> max_{0};
};

/// Instructions behind a number of timer ticks in the emulator at one instruction per nanosecond. On the chip the
/// figure has no meaning: there a tick is a clock cycle and instructions take one or more.
[[nodiscard]] constexpr auto emulated_instructions(std::uint32_t ticks, std::uint32_t core_hz) -> std::uint32_t {
  return static_cast<std::uint32_t>(std::uint64_t{ticks} * 1'000'000'000U / core_hz);
}
static_assert(emulated_instructions(2354, 168'000'000) == 14'011);

}  // namespace capstan::stm32f4
