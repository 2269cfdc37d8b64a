// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "capstan/hal/stm32f4/registers.hpp"

namespace capstan::stm32f4 {

/// The watchdog runs from its own oscillator, "32 kHz", which the datasheet lets be anything from 17 to 47 kHz. A
/// setting worked out for 32 kHz would be wrong by up to a factor of two, so both ends count: the slowest one bounds
/// how long a dead board may drive a motor, the fastest one how late a live cycle may be.
inline constexpr std::uint32_t kLsiSlowestHz = 17'000;
inline constexpr std::uint32_t kLsiFastestHz = 47'000;

/// Divider 4 * 2^code and down counter from reload to 0 (RM0090 section 21.3).
struct WatchdogSetting {
  std::uint32_t code = 0;
  std::uint32_t reload = 0;

  [[nodiscard]] constexpr auto oscillator_periods() const -> std::uint32_t { return (reload + 1) * (4U << code); }
  /// Longest time from the last refresh to the reset, rounded up, us.
  [[nodiscard]] constexpr auto longest_us() const -> std::uint32_t {
    return static_cast<std::uint32_t>((std::uint64_t{oscillator_periods()} * 1'000'000 + kLsiSlowestHz - 1) /
                                      kLsiSlowestHz);
  }
  /// Shortest time in which no refresh already means reset, rounded down, us.
  [[nodiscard]] constexpr auto shortest_us() const -> std::uint32_t {
    return static_cast<std::uint32_t>(std::uint64_t{oscillator_periods()} * 1'000'000 / kLsiFastestHz);
  }
};

inline constexpr std::uint32_t kWatchdogMaxReload = 0xFFF;
inline constexpr std::uint32_t kWatchdogMaxCode = 6;

/// The longest setting that still resets within `limit_us` at the slowest oscillator; the finest divider that can do
/// it.
[[nodiscard]] constexpr auto watchdog_setting_within(std::uint32_t limit_us) -> WatchdogSetting {
  const std::uint64_t periods = std::uint64_t{limit_us} * kLsiSlowestHz / 1'000'000;
  for (std::uint32_t code = 0; code <= kWatchdogMaxCode; ++code) {
    const std::uint64_t counts = periods / (4U << code);
    if (counts >= 1 && counts - 1 <= kWatchdogMaxReload) {
      return {.code = code, .reload = static_cast<std::uint32_t>(counts - 1)};
    }
  }
  return {.code = periods == 0 ? 0 : kWatchdogMaxCode, .reload = periods == 0 ? 0 : kWatchdogMaxReload};
}

/// Torque is off at most 30 ms after the last refresh, and ten whole cycles may be late before a live board is reset.
inline constexpr WatchdogSetting kCycleWatchdog = watchdog_setting_within(30'000);
static_assert(kCycleWatchdog.longest_us() <= 30'000, "a dead board would drive its motor too long");
static_assert(kCycleWatchdog.shortest_us() >= 10'000, "a live board would be reset by ten late cycles");
static_assert(kCycleWatchdog.code == 0 && kCycleWatchdog.reload == 126);

/// While a flash sector is erased the core stands still, for 0.8 s at most (datasheet, 16 KB at 16 bits). Only ever
/// used with the outputs off.
inline constexpr WatchdogSetting kEraseWatchdog{.code = 4, .reload = kWatchdogMaxReload};
static_assert(kEraseWatchdog.shortest_us() >= 2 * 800'000);

/// Cannot be stopped once started, by design of the chip: neither a fault handler nor a lost stack can keep it from
/// biting.
template <RegisterCell Cell>
class Watchdog {
 public:
  explicit Watchdog(WatchdogRegisters<Cell>& registers) noexcept : registers_(registers) {}

  /// Starts with `setting`. False: the setting was not taken over in time, and the watchdog runs with what it had (its
  /// reset value at first). A change needs up to five oscillator periods to reach the other clock: 300 us, here 1 ms at
  /// least.
  [[nodiscard]] auto start(const WatchdogSetting& setting) noexcept -> bool {
    registers_.kr.write(watchdog::kKeyStart);  // first: it also switches the oscillator on
    return change(setting);
  }

  /// Another setting, effective from the refresh this ends with. False: as for start().
  [[nodiscard]] auto change(const WatchdogSetting& setting) noexcept -> bool {
    // Every other key locks the setting again (RM0090 section 21.3.2), so a refresh in between would lose it.
    hold_refresh(true);
    registers_.kr.write(watchdog::kKeyUnlock);
    registers_.pr.write(setting.code);
    registers_.rlr.write(setting.reload);
    hold_refresh(false);
    taken_ = wait_for(registers_.sr, watchdog::kSrBusy, 0, kPolls);
    registers_.kr.write(watchdog::kKeyReload);
    return taken_;
  }

  /// What the last start() or change() returned: with false nobody knows how long a dead board would drive its motor.
  [[nodiscard]] auto taken() const noexcept -> bool { return taken_; }

  /// May interrupt change(), which refreshes by itself at its end.
  void rt_refresh() noexcept {
    if (!held_.load(std::memory_order_relaxed)) {
      registers_.kr.write(watchdog::kKeyReload);
    }
  }

 private:
  /// One core runs both sides, so the order of the program is all that is needed.
  void hold_refresh(bool hold) noexcept {
    std::atomic_signal_fence(std::memory_order_seq_cst);
    held_.store(hold, std::memory_order_relaxed);
    std::atomic_signal_fence(std::memory_order_seq_cst);
  }

  static constexpr std::uint32_t kPolls = 50'000;
  WatchdogRegisters<Cell>& registers_;
  bool taken_ = true;
  std::atomic<bool> held_ = false;  // between the key and the last register it unlocks
};

}  // namespace capstan::stm32f4
