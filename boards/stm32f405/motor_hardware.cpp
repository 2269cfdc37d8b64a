// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/stm32f405/motor_hardware.hpp"

#include "capstan/boards/stm32f405/runtime.hpp"

namespace capstan::stm32f405 {

void MotorHardware::start(const stm32f4::ClockStatus& clock) noexcept {
  namespace rcc = stm32f4::rcc;
  auto& registers = stm32f4::rcc_registers();
  stm32f4::set_bits(registers.ahb1enr, rcc::kAhb1Dma2);
  stm32f4::set_bits(registers.apb1enr, rcc::kApb1Tim2 | rcc::kApb1Tim3 | rcc::kApb1Tim4 | rcc::kApb1Tim5);
  stm32f4::set_bits(registers.apb2enr, rcc::kApb2Tim1 | rcc::kApb2Tim8 | rcc::kApb2Adc1 | rcc::kApb2Syscfg);
  const stm32f4::PwmScale scale{.period = clock.timer_hz(clock.apb2_hz) / kSetValueHz,
                                .full_scale_a = kAmplifierFullScaleA};
  std::array<std::uint8_t, kAxes + 2> channels{};
  for (std::size_t i = 0; i < kAxes; ++i) {
    set_values_[i].start(scale);
    channels[i] = kAxisWiring[i].current_channel;
    // An encoder that does not start is reported by every read: the firmware then shows a missing sensor and does not
    // arm.
    static_cast<void>(encoders_[i].start(kEncoderFilter, kAxisWiring[i].encoder_inverted, kIndexCounts));
  }
  channels[kAxes] = kSupplyChannel;
  channels[kAxes + 1] = kThermometerChannel;
  analogue_.start(channels);
  start_pins(kSharedMotorPins);
  for (std::size_t i = 0; i < kAxes; ++i) {
    start_pins(axis_pins(kAxisWiring[i]));
    if (kIndexCounts != 0) {
      stm32f4::start_rising_edge(stm32f4::exti_registers(), stm32f4::syscfg_registers(), kAxisWiring[i].index);
    }
  }
  stm32f4::set_priority(stm32f4::nvic_registers(), stm32f4::Interrupt::kExti15To10, stm32f4::Priority::kIndex);
  stm32f4::enable_interrupt(stm32f4::nvic_registers(), stm32f4::Interrupt::kExti15To10);
  io_.release();
}

void MotorHardware::rt_index_isr() noexcept {
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (stm32f4::rt_take_edge(stm32f4::exti_registers(), kAxisWiring[i].index)) {
      encoders_[i].rt_index();
    }
  }
}

void MotorHardware::release_by_registers() noexcept {
  for (const AxisWiring& axis : kAxisWiring) {
    stm32f4::set_pin(stm32f4::gpio_registers(axis.enable.port), axis.enable, false);
  }
  stm32f4::clear_bits(stm32f4::tim1_registers().bdtr, stm32f4::timer::kBdtrMainOutput);
  stm32f4::clear_bits(stm32f4::tim8_registers().bdtr, stm32f4::timer::kBdtrMainOutput);
}

}  // namespace capstan::stm32f405
