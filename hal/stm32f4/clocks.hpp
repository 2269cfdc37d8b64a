// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "capstan/hal/stm32f4/registers.hpp"

namespace capstan::stm32f4 {

/// Where the core's clock comes from. Anything but kCrystalPll is a fault the board must report: its timing is then
/// only as good as the internal oscillator's 1 % (datasheet, table of HSI accuracy), or unknown.
enum class ClockSource : std::uint8_t {
  kCrystalPll,    ///< 8 MHz crystal through the PLL: 168 MHz
  kInternalPll,   ///< the crystal did not start; the 16 MHz internal oscillator through the PLL: 168 MHz
  kInternal,      ///< the PLL did not lock either: 16 MHz
  kNotAnswering,  ///< the clock control reads as if it were not there (an emulated core); the frequencies are assumed
};

/// What start_clocks() reached, and the frequencies every divider is worked out from.
struct ClockStatus {
  ClockSource source = ClockSource::kNotAnswering;
  std::uint32_t core_hz = 0;
  std::uint32_t apb1_hz = 0;  ///< USART2; TIM2..5 run at twice this when the bus is divided
  std::uint32_t apb2_hz = 0;  ///< USART1, ADC1; TIM1 runs at twice this when the bus is divided

  [[nodiscard]] constexpr auto is_fault() const -> bool { return source != ClockSource::kCrystalPll; }
  /// True on the internal oscillator, whose 1 % the law's constant dt does not know.
  [[nodiscard]] constexpr auto fell_back() const -> bool {
    return source == ClockSource::kInternalPll || source == ClockSource::kInternal;
  }
  /// Clock of a timer on a bus of `bus_hz`: doubled when that bus is divided (RM0090 section 7.2).
  [[nodiscard]] constexpr auto timer_hz(std::uint32_t bus_hz) const -> std::uint32_t {
    return bus_hz == core_hz ? bus_hz : 2 * bus_hz;
  }
};

/// Why `status` is a fault and what to do, or an empty text.
[[nodiscard]] constexpr auto describe(ClockSource source) -> const char* {
  switch (source) {
    case ClockSource::kCrystalPll:
      return "";
    case ClockSource::kInternalPll:
      return "the 8 MHz crystal did not start and the internal oscillator runs instead; check the crystal and its "
             "capacitors";
    case ClockSource::kInternal:
      return "neither crystal nor PLL started and the core runs at 16 MHz; check the supply and the crystal";
    case ClockSource::kNotAnswering:
      break;
  }
  return "the clock control does not answer and 168 MHz is assumed; expected in an emulator, on a board replace the "
         "chip";
}

/// The clock tree as checked constants (RM0090 section 7.3.2: f = source / M * N / P).
struct PllSetting {
  std::uint32_t source_hz;
  std::uint32_t m;
  [[nodiscard]] constexpr auto vco_in_hz() const -> std::uint32_t { return source_hz / m; }
  [[nodiscard]] constexpr auto vco_hz() const -> std::uint32_t { return vco_in_hz() * kN; }
  [[nodiscard]] constexpr auto core_hz() const -> std::uint32_t { return vco_hz() / kP; }
  /// PLLCFGR without the source bit. P is coded as P/2-1; Q = 7 gives the 48 MHz USB would need.
  [[nodiscard]] constexpr auto bits() const -> std::uint32_t {
    return m | (kN << 6) | ((kP / 2 - 1) << 16) | (kQ << 24);
  }
  static constexpr std::uint32_t kN = 336;
  static constexpr std::uint32_t kP = 2;
  static constexpr std::uint32_t kQ = 7;
};
inline constexpr std::uint32_t kCrystalHz = 8'000'000;
inline constexpr std::uint32_t kInternalHz = 16'000'000;
inline constexpr PllSetting kCrystalPll{.source_hz = kCrystalHz, .m = 8};
inline constexpr PllSetting kInternalPll{.source_hz = kInternalHz, .m = 16};
static_assert(kCrystalPll.core_hz() == 168'000'000 && kInternalPll.core_hz() == 168'000'000);
static_assert(kCrystalPll.vco_in_hz() == 1'000'000, "the PLL's input must be 1 to 2 MHz");
static_assert(kCrystalPll.vco_hz() == 336'000'000, "the VCO must run at 100 to 432 MHz");
static_assert(kCrystalPll.vco_hz() / PllSetting::kQ == 48'000'000);

/// Bounds of the waits, in polls of at least 4 core cycles at 16 MHz (a poll is a load, a mask, a compare and a
/// branch). The crystal gets at least 25 ms (datasheet: 2 ms typical), the PLL and the switch at least 2.5 ms (0.3 ms
/// maximum).
struct ClockBounds {
  std::uint32_t internal_polls = 1'000;
  std::uint32_t crystal_polls = 100'000;
  std::uint32_t pll_polls = 10'000;
};

namespace detail {

/// Flash wait states for 168 MHz at 2.7-3.6 V (RM0090 table 10), set and read back before the clock is raised.
inline constexpr std::uint32_t kFlashWaitStates = 5;

template <RegisterCell Cell>
auto switch_to_pll(RccRegisters<Cell>& rcc, const PllSetting& pll, std::uint32_t source_bit, const ClockBounds& bounds)
    -> bool {
  clear_bits(rcc.cr, rcc::kCrPllOn);
  if (!wait_for(rcc.cr, rcc::kCrPllReady, 0, bounds.pll_polls)) {
    return false;  // PLLCFGR may only be written while the PLL is off
  }
  rcc.pllcfgr.write(pll.bits() | source_bit);
  set_bits(rcc.cr, rcc::kCrPllOn);
  if (!wait_for(rcc.cr, rcc::kCrPllReady, rcc::kCrPllReady, bounds.pll_polls)) {
    clear_bits(rcc.cr, rcc::kCrPllOn);
    return false;
  }
  modify(rcc.cfgr, rcc::kCfgrSwitchMask, rcc::kCfgrSwitchPll);
  return wait_for(rcc.cfgr, rcc::kCfgrStatusMask, rcc::kCfgrStatusPll, bounds.pll_polls);
}

[[nodiscard]] constexpr auto full_speed(ClockSource source) -> ClockStatus {
  constexpr std::uint32_t kCore = kCrystalPll.core_hz();
  static_assert(kCore / 4 <= 42'000'000 && kCore / 2 <= 84'000'000, "limits of the two peripheral buses");
  return {.source = source, .core_hz = kCore, .apb1_hz = kCore / 4, .apb2_hz = kCore / 2};
}

}  // namespace detail

/// Brings the core to 168 MHz from the crystal; failing that from the internal oscillator; failing that leaves it at 16
/// MHz. Every wait is bounded. On an emulator without clock control it returns kNotAnswering with the frequencies of
/// full speed, because there the core's timer counts at 168 MHz whatever is written.
template <RegisterCell Cell>
[[nodiscard]] auto start_clocks(RccRegisters<Cell>& rcc, PowerRegisters<Cell>& power, FlashRegisters<Cell>& flash,
                                const ClockBounds& bounds = {}) noexcept -> ClockStatus {
  set_bits(rcc.cr, rcc::kCrHsiOn);
  if (!wait_for(rcc.cr, rcc::kCrHsiReady, rcc::kCrHsiReady, bounds.internal_polls)) {
    return detail::full_speed(
        ClockSource::kNotAnswering);  // this code runs on that very oscillator, so it cannot be off
  }
  constexpr ClockStatus kSlow{
      .source = ClockSource::kInternal, .core_hz = kInternalHz, .apb1_hz = kInternalHz, .apb2_hz = kInternalHz};
  set_bits(rcc.apb1enr, rcc::kApb1Power);
  set_bits(power.cr, power::kCrScale1);
  flash.acr.write(detail::kFlashWaitStates | flash::kAcrPrefetch | flash::kAcrInstructionCache | flash::kAcrDataCache);
  if (!wait_for(flash.acr, flash::kAcrLatencyMask, detail::kFlashWaitStates, bounds.internal_polls)) {
    return kSlow;  // raising the clock without the wait states would make the core read garbage
  }
  modify(rcc.cfgr, rcc::kCfgrPrescalerMask, rcc::kCfgrApb1Div4 | rcc::kCfgrApb2Div2);

  set_bits(rcc.cr, rcc::kCrHseOn);
  if (wait_for(rcc.cr, rcc::kCrHseReady, rcc::kCrHseReady, bounds.crystal_polls) &&
      detail::switch_to_pll(rcc, kCrystalPll, rcc::kPllSourceHse, bounds)) {
    set_bits(rcc.cr, rcc::kCrSecurityOn);  // from here on a crystal that stops raises an NMI
    return detail::full_speed(ClockSource::kCrystalPll);
  }
  clear_bits(rcc.cr, rcc::kCrHseOn);
  if (detail::switch_to_pll(rcc, kInternalPll, 0, bounds)) {
    return detail::full_speed(ClockSource::kInternalPll);
  }
  modify(rcc.cfgr, rcc::kCfgrPrescalerMask | rcc::kCfgrSwitchMask, 0);
  return kSlow;
}

}  // namespace capstan::stm32f4
