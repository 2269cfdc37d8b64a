// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "capstan/boards/stm32f405/board.hpp"
#include "capstan/hal/stm32f4/memory_map.hpp"
#include "capstan/hal/stm32f4/motor_board_io.hpp"

namespace capstan::stm32f405 {

/// The drivers of the motor board's joints, built from the wiring table, and the joint I/O made of them.
class MotorHardware {
 public:
  using Io = stm32f4::MotorBoardIo<stm32f4::MemoryRegister, kAxes>;

  [[nodiscard]] auto io() noexcept -> Io& { return io_; }

  /// Clocks, drivers, then pins: no pin changes hands before its peripheral is at rest. Ends with every output off.
  void start(const stm32f4::ClockStatus& clock) noexcept;

  /// An encoder's index has passed.
  void rt_index_isr() noexcept;

  /// Every enable line low and both main outputs off, by registers alone.
  static void release_by_registers() noexcept;

 private:
  using Cell = stm32f4::MemoryRegister;
  using Encoder = stm32f4::QuadratureEncoder<Cell>;
  using SetValue = stm32f4::PwmSetValue<Cell>;
  using Hardware = stm32f4::AxisHardware<Cell>;

  template <std::size_t... I>
  explicit MotorHardware(std::index_sequence<I...> /*axes*/) noexcept
      : encoders_{{Encoder(stm32f4::encoder_timer_registers(kAxisWiring[I].encoder_timer),
                           kAxisWiring[I].encoder_width)...}},
        set_values_{{SetValue(pwm_registers(kAxisWiring[I].pwm_timer), kAxisWiring[I].pwm_channel)...}},
        analogue_(stm32f4::adc1_registers(), stm32f4::adc_common_registers(), stm32f4::dma2_registers()),
        io_({Hardware{encoders_[I], set_values_[I], stm32f4::gpio_registers(kAxisWiring[I].enable.port),
                      kAxisWiring[I].enable}...},
            analogue_,
            {stm32f4::StopInput<Cell>{stm32f4::gpio_registers(kEstop1.port), kEstop1},
             stm32f4::StopInput<Cell>{stm32f4::gpio_registers(kEstop8.port), kEstop8}},
            {.current = {kMonitorFullScaleA},
             .supply = {kSupplyFullScaleV},
             .thermometer = {kThermometerUvPerK, kThermometerUvAt0C}}) {}

  [[nodiscard]] static auto pwm_registers(PwmTimer timer) noexcept -> stm32f4::TimerRegisters<Cell>& {
    return timer == PwmTimer::kTim1 ? stm32f4::tim1_registers() : stm32f4::tim8_registers();
  }

  std::array<Encoder, kAxes> encoders_;
  std::array<SetValue, kAxes> set_values_;
  Io::Analogue analogue_;
  Io io_;

 public:
  MotorHardware() noexcept : MotorHardware(std::make_index_sequence<kAxes>{}) {}
};

}  // namespace capstan::stm32f405
