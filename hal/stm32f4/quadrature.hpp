// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "capstan/hal/stm32f4/timer_registers.hpp"

namespace capstan::stm32f4 {

/// Bits of a timer's counter: 32 in TIM2 and TIM5, 16 in TIM3 and TIM4.
enum class CounterWidth : std::uint8_t { k16 = 16, k32 = 32 };

/// Incremental encoder on a timer. Position is the sum of the counter's differences modulo its width, so a counter of
/// 16 bits gives 32 as long as it moves less than half of its range between two reads: 32767 counts a cycle, eighty
/// times what the fastest joint does. No interrupt is needed, and none could come too late.
///
/// A counter of 16 bits that was not read for long (the core stands still while flash is erased) may have gone round.
/// Its update flag tells: it says that the counter passed the end of its range where the difference did not. A position
/// that is lost, by that or because the timer lost its settings, is missing for one read and then comes back a quarter
/// of the 32-bit range away: the firmware takes that for the jump it is, and asks the operator to zero the joint.
///
/// With an index, whose interrupt calls rt_index(), turns are checked too: from one index to any other there must be
/// whole turns. Counts that were lost or added on the way (a torn wire, interference) are found within a turn, and the
/// position is lost as above.
template <RegisterCell Cell>
class QuadratureEncoder {
 public:
  QuadratureEncoder(TimerRegisters<Cell>& registers, CounterWidth width) noexcept
      : registers_(registers), width_(static_cast<std::uint32_t>(width)) {}

  /// `filter` is the timer's input filter code 0 to 15 (RM0090 section 18.4.7): an edge counts after that many equal
  /// samples. `inverted` turns the counting direction round. False: the counter did not take over its settings (clock
  /// off, or not there), and read() will say so. `counts_per_index` 0: there is no index, or nobody asks for it.
  [[nodiscard]] auto start(std::uint32_t filter, bool inverted, std::uint32_t counts_per_index = 0) noexcept -> bool {
    filter_ = filter;
    inverted_ = inverted;
    counts_per_index_ = counts_per_index;
    index_known_ = false;
    index_seen_.store(false, std::memory_order_relaxed);
    registers_.cr1.write(0);
    registers_.smcr.write(timer::kSmcrQuadrature);
    registers_.ccmr[0].write(timer::kCcmrInputs | (filter << timer::kCcmrFilter1Shift) |
                             (filter << timer::kCcmrFilter2Shift));
    registers_.ccer.write(inverted ? timer::kCcerInvert1 : 0);
    registers_.psc.write(0);
    registers_.arr.write(0xFFFF'FFFFU);
    registers_.cnt.write(kMiddle);  // away from the end of the range, where a trembling encoder would pass it for ever
    registers_.sr.write(0);
    registers_.cr1.write(timer::kCr1Enable);
    last_ = kMiddle;
    counts_ = 0;
    return runs();
  }

  /// Counts since start, modulo 2^32. False: the timer is not counting edges or has lost count, and `counts` is
  /// unchanged.
  [[nodiscard]] auto rt_read(std::int32_t& counts) noexcept -> bool {
    if (!runs() || !count()) {
      const std::uint32_t elsewhere = counts_ + (lost_ ? 0 : kJump);
      static_cast<void>(start(filter_, inverted_, counts_per_index_));
      counts_ = elsewhere;
      lost_ = true;
      return false;
    }
    lost_ = false;
    counts = static_cast<std::int32_t>(counts_);
    return true;
  }

  /// The index has just passed. In its interrupt, which is more urgent than whoever calls rt_read().
  void rt_index() noexcept {
    index_counter_.store(registers_.cnt.read(), std::memory_order_relaxed);
    index_seen_.store(true, std::memory_order_release);
  }

 private:
  static constexpr std::uint32_t kMiddle = 0x8000;
  static constexpr std::uint32_t kJump = 0x4000'0000;
  /// Counts from the end of the range within which it may be passed and passed again between two reads: two and a half
  /// cycles at the default speed limit.
  static constexpr std::uint32_t kNear = 1'000;
  /// A motion beyond this between two reads could as well be one the other way round.
  static constexpr std::int32_t kMost = 0x4000;
  /// The index is up to four counts wide and seen from its other side when the encoder turns back; at 391 counts a ms
  /// ten microseconds until its interrupt are four more.
  static constexpr std::int32_t kIndexTolerance = 8;

  /// A register that lost its setting (a glitch, a clock that was switched off) must not pass for a joint at rest.
  [[nodiscard]] auto runs() const noexcept -> bool {
    return (registers_.cr1.read() & timer::kCr1Enable) != 0 && registers_.smcr.read() == timer::kSmcrQuadrature;
  }
  /// Adds what moved since the last time. False: that is not known.
  [[nodiscard]] auto count() noexcept -> bool {
    const bool passed = (registers_.sr.read() & timer::kSrUpdate) != 0;
    if (passed) {
      registers_.sr.write(~timer::kSrUpdate);  // before the counter is read: what passes later is for the next read
    }
    const std::uint32_t now = registers_.cnt.read();
    const std::uint32_t before = last_;
    const std::int32_t moved = difference(now, before);
    last_ = now;
    counts_ += static_cast<std::uint32_t>(moved);
    if (!index_fits(now)) {
      return false;
    }
    const bool moved_past_end = moved >= 0 ? now < before : now > before;
    return moved >= -kMost && moved <= kMost && (!passed || moved_past_end || near_end(now));
  }
  /// In the counter's width.
  [[nodiscard]] auto difference(std::uint32_t to, std::uint32_t from) const noexcept -> std::int32_t {
    const std::uint32_t unused = 32 - width_;
    return static_cast<std::int32_t>((to - from) << unused) >> unused;
  }
  /// An index since the last time stands on the grid of the first one. `now`: the counter, of which counts_ is the sum.
  [[nodiscard]] auto index_fits(std::uint32_t now) noexcept -> bool {
    if (counts_per_index_ == 0 || !index_seen_.exchange(false, std::memory_order_acquire)) {
      return true;
    }
    const auto since = difference(now, index_counter_.load(std::memory_order_relaxed));
    const std::uint32_t at = counts_ - static_cast<std::uint32_t>(since);
    if (!index_known_) {
      index_known_ = true;
      index_at_ = at;
      return true;
    }
    const auto every = static_cast<std::int32_t>(counts_per_index_);
    std::int32_t off = static_cast<std::int32_t>(at - index_at_) % every;
    off -= off > every / 2 ? every : 0;
    off += off < -every / 2 ? every : 0;
    index_at_ = at - static_cast<std::uint32_t>(off);
    return off >= -kIndexTolerance && off <= kIndexTolerance;
  }
  [[nodiscard]] auto near_end(std::uint32_t now) const noexcept -> bool {
    const std::uint32_t top = 0xFFFF'FFFFU >> (32 - width_);
    return now < kNear || top - now < kNear;
  }

  TimerRegisters<Cell>& registers_;
  std::uint32_t width_;
  std::uint32_t last_ = 0;
  std::uint32_t counts_ = 0;
  std::uint32_t filter_ = 0;
  bool inverted_ = false;
  bool lost_ = false;  // since the last good read
  std::uint32_t counts_per_index_ = 0;
  std::uint32_t index_at_ = 0;  // one of its places, in counts_
  bool index_known_ = false;
  std::atomic<std::uint32_t> index_counter_{0};  // where the timer stood
  std::atomic<bool> index_seen_{false};
};

}  // namespace capstan::stm32f4
