// SPDX-License-Identifier: Apache-2.0
// The motor board as data: pins, clocks, scales. Nothing here runs; README.md has the same wiring as a table.
#pragma once

#include <array>
#include <cstdint>

#include "capstan/hal/stm32f4/clocks.hpp"
#include "capstan/hal/stm32f4/gpio.hpp"
#include "capstan/hal/stm32f4/quadrature.hpp"
#include "capstan/hal/stm32f4/usart.hpp"
#include "capstan/model/fixed.hpp"

namespace capstan::stm32f405 {

/// Axes of the image, from CMake's CAPSTAN_AXES. The board has connectors for four.
inline constexpr std::size_t kAxes = CAPSTAN_AXES;
inline constexpr std::size_t kMostAxes = 4;
static_assert(kAxes >= 1 && kAxes <= kMostAxes, "CAPSTAN_AXES must be 1 to 4");

inline constexpr std::uint32_t kConsoleBaud = 115'200;
/// The emulated image's line to the plant; the emulator moves bytes at once, whatever the rate.
inline constexpr std::uint32_t kPlantBaud = 2'000'000;

// Alternate functions from the datasheet's table of them (STM32F405RG, LQFP64).
using stm32f4::CounterWidth;
using stm32f4::Pin;
using stm32f4::PinMode;
using stm32f4::Port;
using stm32f4::Pull;
inline constexpr Pin kConsoleTx{Port::kA, 9, PinMode::kAlternate, 7, Pull::kNone, "USART1_TX"};
inline constexpr Pin kConsoleRx{Port::kA, 10, PinMode::kAlternate, 7, Pull::kUp, "USART1_RX"};
inline constexpr Pin kPlantTx{Port::kA, 2, PinMode::kAlternate, 7, Pull::kNone, "USART2_TX"};
inline constexpr Pin kPlantRx{Port::kA, 3, PinMode::kAlternate, 7, Pull::kUp, "USART2_RX"};

/// Advanced timers for the set values.
enum class PwmTimer : std::uint8_t { kTim1, kTim8 };

/// What one axis is wired to.
struct AxisWiring {
  std::uint8_t encoder_timer;  ///< 2 to 5
  CounterWidth encoder_width;
  Pin encoder_a, encoder_b;
  PwmTimer pwm_timer;
  std::uint8_t pwm_channel;  ///< from 0
  Pin set_value;
  std::uint8_t current_channel;  ///< of ADC1
  Pin current;
  Pin enable;
  Pin index;  ///< rising at the encoder's index
  bool encoder_inverted = false;
};

[[nodiscard]] constexpr auto encoder_pin(Port port, std::uint8_t number, std::uint8_t function, const char* signal)
    -> Pin {
  return {port, number, PinMode::kAlternate, function, Pull::kUp, signal};
}
[[nodiscard]] constexpr auto index_pin(std::uint8_t number, const char* signal) -> Pin {
  return {Port::kB, number, PinMode::kInput, 0, Pull::kDown, signal};
}
[[nodiscard]] constexpr auto set_value_pin(Port port, std::uint8_t number, std::uint8_t function, const char* signal)
    -> Pin {
  return {port, number, PinMode::kAlternate, function, Pull::kDown, signal};
}
[[nodiscard]] constexpr auto analogue_pin(std::uint8_t number, const char* signal) -> Pin {
  return {Port::kC, number, PinMode::kAnalog, 0, Pull::kNone, signal};
}
[[nodiscard]] constexpr auto enable_pin(Port port, std::uint8_t number) -> Pin {
  return {port, number, PinMode::kOutput, 0, Pull::kDown, "GPIO"};
}

inline constexpr std::array<AxisWiring, kMostAxes> kAxisWiring = {{
    {2, CounterWidth::k32, encoder_pin(Port::kA, 15, 1, "TIM2_CH1"), encoder_pin(Port::kB, 3, 1, "TIM2_CH2"),
     PwmTimer::kTim1, 0, set_value_pin(Port::kA, 8, 1, "TIM1_CH1"), 10, analogue_pin(0, "ADC1_IN10"),
     enable_pin(Port::kC, 10), index_pin(10, "EXTI10")},
    {5, CounterWidth::k32, encoder_pin(Port::kA, 0, 2, "TIM5_CH1"), encoder_pin(Port::kA, 1, 2, "TIM5_CH2"),
     PwmTimer::kTim1, 3, set_value_pin(Port::kA, 11, 1, "TIM1_CH4"), 11, analogue_pin(1, "ADC1_IN11"),
     enable_pin(Port::kC, 11), index_pin(13, "EXTI13")},
    {3, CounterWidth::k16, encoder_pin(Port::kB, 4, 2, "TIM3_CH1"), encoder_pin(Port::kB, 5, 2, "TIM3_CH2"),
     PwmTimer::kTim8, 2, set_value_pin(Port::kC, 8, 3, "TIM8_CH3"), 12, analogue_pin(2, "ADC1_IN12"),
     enable_pin(Port::kC, 12), index_pin(14, "EXTI14")},
    {4, CounterWidth::k16, encoder_pin(Port::kB, 6, 2, "TIM4_CH1"), encoder_pin(Port::kB, 7, 2, "TIM4_CH2"),
     PwmTimer::kTim8, 3, set_value_pin(Port::kC, 9, 3, "TIM8_CH4"), 13, analogue_pin(3, "ADC1_IN13"),
     enable_pin(Port::kD, 2), index_pin(15, "EXTI15")},
}};

inline constexpr Pin kSupply = analogue_pin(4, "ADC1_IN14");
inline constexpr std::uint8_t kSupplyChannel = 14;
inline constexpr Pin kThermometer = analogue_pin(5, "ADC1_IN15");
inline constexpr std::uint8_t kThermometerChannel = 15;
/// Thermometer of voltage linear in temperature, from CMake's CAPSTAN_THERMOMETER_UV_PER_K (0: none) and _UV_AT_0C.
inline constexpr std::int32_t kThermometerUvPerK = CAPSTAN_THERMOMETER_UV_PER_K;
inline constexpr std::int32_t kThermometerUvAt0C = CAPSTAN_THERMOMETER_UV_AT_0C;
static_assert(kThermometerUvPerK == 0 || (kThermometerUvPerK >= 1'000 && kThermometerUvPerK <= 50'000),
              "CAPSTAN_THERMOMETER_UV_PER_K must be 0, or 1000 to 50000");
static_assert(kThermometerUvAt0C >= -1'000'000 && kThermometerUvAt0C <= 3'000'000,
              "CAPSTAN_THERMOMETER_UV_AT_0C is impossible");
/// Read as pins and wired to the breaks of both timers: low, or an open wire, cuts the set values in hardware.
inline constexpr Pin kEstop1{Port::kB, 12, PinMode::kAlternate, 1, Pull::kDown, "TIM1_BKIN"};
inline constexpr Pin kEstop8{Port::kA, 6, PinMode::kAlternate, 3, Pull::kDown, "TIM8_BKIN"};
inline constexpr Pin kCanRx{Port::kB, 8, PinMode::kAlternate, 9, Pull::kUp, "CAN1_RX"};
inline constexpr Pin kCanTx{Port::kB, 9, PinMode::kAlternate, 9, Pull::kNone, "CAN1_TX"};

/// Counts from one index to the next, from CMake's CAPSTAN_INDEX_COUNTS: four times the lines of the encoder's disc; 0
/// if the encoders have no index.
inline constexpr std::uint32_t kIndexCounts = CAPSTAN_INDEX_COUNTS;
static_assert(kIndexCounts == 0 || (kIndexCounts >= 64 && kIndexCounts <= 1'000'000),
              "CAPSTAN_INDEX_COUNTS is impossible");

/// Node of the board on CAN, from CMake's CAPSTAN_CAN_NODE.
inline constexpr std::uint8_t kCanNode = CAPSTAN_CAN_NODE;
static_assert(kCanNode >= 1 && kCanNode <= 127, "CAPSTAN_CAN_NODE must be 1 to 127");

inline constexpr std::array kCommonPins = {kConsoleTx, kConsoleRx, kCanRx, kCanTx};
inline constexpr std::array kPlantPins = {kPlantTx, kPlantRx};

inline constexpr std::size_t kPinsPerAxis = 6;
[[nodiscard]] constexpr auto axis_pins(const AxisWiring& axis) -> std::array<Pin, kPinsPerAxis> {
  return {axis.encoder_a, axis.encoder_b, axis.set_value, axis.current, axis.enable, axis.index};
}
inline constexpr std::array kSharedMotorPins = {kSupply, kThermometer, kEstop1, kEstop8};

/// The set values' frequency: the highest that common servo amplifiers take (10 Hz to 5 kHz).
inline constexpr std::uint32_t kSetValueHz = 5'000;
/// Current of the amplifier at 90 % duty, and of its monitor at either end of the analogue range, A.
inline constexpr Q24 kAmplifierFullScaleA = Q24::from_int(5);
inline constexpr Q24 kMonitorFullScaleA = Q24::from_int(6);
/// Supply behind the divider of 10:1 (100 kOhm to 10 kOhm) that gives the full analogue range of 3.3 V, V.
inline constexpr Q24 kSupplyFullScaleV = Q24::from_double(36.3);
/// Input filter code of the encoders: an edge counts after 8 equal samples at half the timer's clock of 84 MHz
/// (RM0090 18.4.7), so pulses under 190 ns do not. 40000 counts a turn at 60 rad/s, the default speed limit, are 2.6 us
/// apart.
inline constexpr std::uint32_t kEncoderFilter = 5;

[[nodiscard]] constexpr auto pins_are_distinct() -> bool {
  std::array<Pin, kCommonPins.size() + kPlantPins.size() + kSharedMotorPins.size() + kMostAxes * kPinsPerAxis> all{};
  std::size_t count = 0;
  const auto add = [&all, &count](const auto& pins) {
    for (const Pin& pin : pins) {
      all[count++] = pin;
    }
  };
  add(kCommonPins);
  add(kPlantPins);
  add(kSharedMotorPins);
  for (const AxisWiring& axis : kAxisWiring) {
    add(axis_pins(axis));
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      if (all[i].same_pin(all[j])) {
        return false;
      }
    }
  }
  return count == all.size();
}
static_assert(pins_are_distinct(), "two signals share a pin");
static_assert(stm32f4::detail::full_speed(stm32f4::ClockSource::kCrystalPll).apb2_hz == 84'000'000);
static_assert(stm32f4::baud_error_permille(84'000'000, kConsoleBaud) < 20);
static_assert(stm32f4::baud_error_permille(stm32f4::kInternalHz, kConsoleBaud) < 20);
static_assert(2 * 84'000'000 / kSetValueHz <= 0x1'0000, "the set values' timers have 16 bits");
static_assert(2 * stm32f4::kInternalHz / kSetValueHz > 1'000, "even at 16 MHz the set value must resolve 0.1 %");

}  // namespace capstan::stm32f405
