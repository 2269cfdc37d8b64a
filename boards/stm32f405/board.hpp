// SPDX-License-Identifier: Apache-2.0
// The motor board as data: pins, clocks, scales. Nothing here runs; README.md has the same wiring as a table.
#pragma once

#include <array>
#include <cstdint>

#include "hal/stm32f4/clocks.hpp"
#include "hal/stm32f4/gpio.hpp"
#include "hal/stm32f4/usart.hpp"
#include "model/fixed.hpp"

namespace capstan::stm32f405 {

inline constexpr std::size_t kAxes = 1;
inline constexpr std::uint32_t kConsoleBaud = 115'200;
/// The emulated image's line to the plant; the emulator moves bytes at once, whatever the rate.
inline constexpr std::uint32_t kPlantBaud = 2'000'000;

// Alternate functions from the datasheet's table of them (STM32F405RG, LQFP64).
using stm32f4::Pin;
using stm32f4::PinMode;
using stm32f4::Port;
using stm32f4::Pull;
inline constexpr Pin kConsoleTx{Port::kA, 9, PinMode::kAlternate, 7, Pull::kNone, "USART1_TX"};
inline constexpr Pin kConsoleRx{Port::kA, 10, PinMode::kAlternate, 7, Pull::kUp, "USART1_RX"};
inline constexpr Pin kPlantTx{Port::kA, 2, PinMode::kAlternate, 7, Pull::kNone, "USART2_TX"};
inline constexpr Pin kPlantRx{Port::kA, 3, PinMode::kAlternate, 7, Pull::kUp, "USART2_RX"};
inline constexpr Pin kEncoder0A{Port::kA, 15, PinMode::kAlternate, 1, Pull::kUp, "TIM2_CH1"};
inline constexpr Pin kEncoder0B{Port::kB, 3, PinMode::kAlternate, 1, Pull::kUp, "TIM2_CH2"};
inline constexpr Pin kSetValue0{Port::kA, 8, PinMode::kAlternate, 1, Pull::kDown, "TIM1_CH1"};
inline constexpr Pin kCurrent0{Port::kC, 0, PinMode::kAnalog, 0, Pull::kNone, "ADC1_IN10"};
inline constexpr Pin kEnable0{Port::kC, 10, PinMode::kOutput, 0, Pull::kDown, "GPIO"};
/// Read as a pin and wired to TIM1's break: low, or an open wire, cuts the set value in hardware.
inline constexpr Pin kEstop{Port::kB, 12, PinMode::kAlternate, 1, Pull::kDown, "TIM1_BKIN"};
inline constexpr std::uint32_t kCurrent0Channel = 10;

inline constexpr std::array kCommonPins = {kConsoleTx, kConsoleRx};
inline constexpr std::array kPlantPins = {kPlantTx, kPlantRx};
inline constexpr std::array kMotorPins = {kEncoder0A, kEncoder0B, kSetValue0, kCurrent0, kEnable0, kEstop};

/// The set value's frequency: the highest that common servo amplifiers take (10 Hz to 5 kHz).
inline constexpr std::uint32_t kSetValueHz = 5'000;
/// Current of the amplifier at 90 % duty, and of its monitor at either end of the analogue range, A.
inline constexpr Q24 kAmplifierFullScaleA = Q24::from_int(5);
inline constexpr Q24 kMonitorFullScaleA = Q24::from_int(6);
/// Input filter code of the encoder: an edge counts after 8 equal samples at half the timer's clock of 84 MHz
/// (RM0090 18.4.7), so pulses under 190 ns do not. 40000 counts a turn at 60 rad/s, the default speed limit, are 2.6 us
/// apart.
inline constexpr std::uint32_t kEncoderFilter = 5;
inline constexpr bool kEncoder0Inverted = false;

[[nodiscard]] constexpr auto pins_are_distinct() -> bool {
  std::array<Pin, kCommonPins.size() + kPlantPins.size() + kMotorPins.size()> all{};
  std::size_t count = 0;
  for (const auto& pin : kCommonPins) {
    all[count++] = pin;
  }
  for (const auto& pin : kPlantPins) {
    all[count++] = pin;
  }
  for (const auto& pin : kMotorPins) {
    all[count++] = pin;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      if (all[i].same_pin(all[j])) {
        return false;
      }
    }
  }
  return true;
}
static_assert(pins_are_distinct(), "two signals share a pin");
static_assert(stm32f4::detail::full_speed(stm32f4::ClockSource::kCrystalPll).apb2_hz == 84'000'000);
static_assert(stm32f4::baud_error_permille(84'000'000, kConsoleBaud) < 20);
static_assert(stm32f4::baud_error_permille(stm32f4::kInternalHz, kConsoleBaud) < 20);
static_assert(2 * 84'000'000 / kSetValueHz <= 0x1'0000, "TIM1 has 16 bits");
static_assert(2 * stm32f4::kInternalHz / kSetValueHz > 1'000, "even at 16 MHz the set value must resolve 0.1 %");

}  // namespace capstan::stm32f405
