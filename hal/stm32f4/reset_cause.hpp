// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "capstan/hal/stm32f4/registers.hpp"

namespace capstan::stm32f4 {

/// Why the core started. The flags of the chip add up over resets until they are removed, and the pin flag is set by
/// every internal reset too (RM0090 section 6.1), so the most telling one is named.
enum class ResetCause : std::uint8_t {
  kUnknown,
  kPowerOn,
  kBrownOut,
  kPin,
  kSoftware,
  kIndependentWatchdog,
  kWindowWatchdog,
  kLowPower,
};

[[nodiscard]] constexpr auto decode_reset_cause(std::uint32_t csr) -> ResetCause {
  if ((csr & rcc::kCsrIndependentWatchdog) != 0) {
    return ResetCause::kIndependentWatchdog;
  }
  if ((csr & rcc::kCsrWindowWatchdog) != 0) {
    return ResetCause::kWindowWatchdog;
  }
  if ((csr & rcc::kCsrLowPower) != 0) {
    return ResetCause::kLowPower;
  }
  if ((csr & rcc::kCsrSoftware) != 0) {
    return ResetCause::kSoftware;
  }
  if ((csr & rcc::kCsrPowerOn) != 0) {
    return ResetCause::kPowerOn;  // before brown-out, whose flag a power-on sets as well
  }
  if ((csr & rcc::kCsrBrownOut) != 0) {
    return ResetCause::kBrownOut;
  }
  return (csr & rcc::kCsrPin) != 0 ? ResetCause::kPin : ResetCause::kUnknown;
}

[[nodiscard]] constexpr auto name(ResetCause cause) -> const char* {
  switch (cause) {
    case ResetCause::kPowerOn:
      return "power on";
    case ResetCause::kBrownOut:
      return "brown-out";
    case ResetCause::kPin:
      return "reset pin";
    case ResetCause::kSoftware:
      return "software";
    case ResetCause::kIndependentWatchdog:
      return "watchdog";
    case ResetCause::kWindowWatchdog:
      return "window watchdog";
    case ResetCause::kLowPower:
      return "low power";
    case ResetCause::kUnknown:
      break;
  }
  return "unknown";
}

/// True: the brown-out reset holds the core wherever its supply is below what it needs for this clock and for writing
/// flash by words, 2.7 V. It is off as the chip is delivered (RM0090 section 3.9.10); option bytes set it.
template <RegisterCell Cell>
[[nodiscard]] auto brown_out_watched(const FlashRegisters<Cell>& flash) noexcept -> bool {
  return (flash.optcr.read() & flash::kOptcrBrownOutMask) == 0;
}

/// Reads the cause and removes the flags, so that the next reset is told apart from this one. Call once, at start.
template <RegisterCell Cell>
[[nodiscard]] auto take_reset_cause(RccRegisters<Cell>& rcc) noexcept -> ResetCause {
  const ResetCause cause = decode_reset_cause(rcc.csr.read());
  set_bits(rcc.csr, rcc::kCsrRemoveFlags);
  return cause;
}

}  // namespace capstan::stm32f4
