// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "capstan/hal/stm32f4/registers.hpp"

namespace capstan::stm32f4 {

enum class Port : std::uint8_t { kA, kB, kC, kD };
/// What a pin is used as; the value is the mode field (RM0090 section 8.4.1).
enum class PinMode : std::uint8_t { kInput = 0, kOutput = 1, kAlternate = 2, kAnalog = 3 };
enum class Pull : std::uint8_t { kNone = 0, kUp = 1, kDown = 2 };

/// One line of a board's wiring table.
struct Pin {
  Port port;
  std::uint8_t number;
  PinMode mode;
  std::uint8_t alternate = 0;
  Pull pull = Pull::kNone;
  const char* signal = "";

  [[nodiscard]] constexpr auto same_pin(const Pin& other) const -> bool {
    return port == other.port && number == other.number;
  }
  [[nodiscard]] constexpr auto mask() const -> std::uint32_t { return 1U << number; }
};

/// Puts one pin into its mode. Pull and alternate function go first, so that the pin never shows a state nobody asked
/// for.
template <RegisterCell Cell>
void configure_pin(GpioRegisters<Cell>& gpio, const Pin& pin) noexcept {
  const std::uint32_t two = 2U * pin.number;
  const std::uint32_t four = 4U * (pin.number % 8U);
  modify(gpio.pupdr, 3U << two, static_cast<std::uint32_t>(pin.pull) << two);
  modify(gpio.afr[pin.number / 8U], 0xFU << four, static_cast<std::uint32_t>(pin.alternate) << four);
  modify(gpio.moder, 3U << two, static_cast<std::uint32_t>(pin.mode) << two);
}

/// Set and reset in one write, so an interrupt between cannot be lost: bits 0-15 set, 16-31 reset (RM0090
/// section 8.4.7).
template <RegisterCell Cell>
void set_pin(GpioRegisters<Cell>& gpio, const Pin& pin, bool high) noexcept {
  gpio.bsrr.write(high ? pin.mask() : pin.mask() << 16U);
}

template <RegisterCell Cell>
[[nodiscard]] auto pin_is_high(const GpioRegisters<Cell>& gpio, const Pin& pin) noexcept -> bool {
  return (gpio.idr.read() & pin.mask()) != 0;
}

}  // namespace capstan::stm32f4
