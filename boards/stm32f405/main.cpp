// SPDX-License-Identifier: Apache-2.0
// The motor board: every object is built here, once.
#include "boards/stm32f405/banks.hpp"
#include "boards/stm32f405/board.hpp"
#include "boards/stm32f405/runtime.hpp"
#include "hal/stm32f4/memory_map.hpp"
#include "hal/stm32f4/motor_board_io.hpp"

// From the linker script: the two parameter banks.
extern "C" capstan::stm32f4::MemoryRegister capstan_bank_a[];
extern "C" capstan::stm32f4::MemoryRegister capstan_bank_b[];

namespace {

using namespace capstan;
using stm32f4::MemoryRegister;
using MotorIo = stm32f4::MotorBoardIo<MemoryRegister, stm32f405::kAxes>;

constexpr std::size_t kBankWords = stm32f405::kBankBytes / sizeof(std::uint32_t);

stm32f405::SerialPort console{stm32f4::usart1_registers(), stm32f4::nvic_registers(), stm32f4::Interrupt::kUsart1};
stm32f405::BoardTick tick{stm32f4::systick_registers()};
stm32f4::Watchdog<MemoryRegister> watchdog{stm32f4::watchdog_registers()};
stm32f405::FlashBanks<MemoryRegister> banks{
    stm32f4::flash_registers(),
    watchdog,
    {std::span(capstan_bank_a, kBankWords), std::span(capstan_bank_b, kBankWords)}};
stm32f4::QuadratureEncoder<MemoryRegister> encoder0{stm32f4::tim2_registers()};
stm32f4::PwmSetValue<MemoryRegister> set_value0{stm32f4::tim1_registers(), 0};
stm32f4::Adc<MemoryRegister> adc{stm32f4::adc1_registers(), stm32f4::adc_common_registers()};
MotorIo io{{stm32f4::AxisHardware<MemoryRegister>{encoder0,
                                                  set_value0,
                                                  stm32f4::gpio_registers(stm32f405::kEnable0.port),
                                                  stm32f405::kEnable0,
                                                  stm32f405::kCurrent0Channel,
                                                  {stm32f405::kMonitorFullScaleA}}},
           adc,
           stm32f4::gpio_registers(stm32f405::kEstop.port),
           stm32f405::kEstop};
stm32f405::Runtime<MotorIo> runtime{io, {console, tick, watchdog, banks}, "stm32f405"};

void start_motor_peripherals(const stm32f4::ClockStatus& clock) {
  namespace rcc = stm32f4::rcc;
  auto& registers = stm32f4::rcc_registers();
  stm32f4::set_bits(registers.apb1enr, rcc::kApb1Tim2);
  stm32f4::set_bits(registers.apb2enr, rcc::kApb2Tim1 | rcc::kApb2Adc1);
  set_value0.start({.period = clock.timer_hz(clock.apb2_hz) / stm32f405::kSetValueHz,
                    .full_scale_a = stm32f405::kAmplifierFullScaleA});
  adc.start();
  // An encoder that does not start is reported by every read: the firmware then shows a missing sensor and does not
  // arm.
  static_cast<void>(encoder0.start(stm32f405::kEncoderFilter, stm32f405::kEncoder0Inverted));
  stm32f405::start_pins(stm32f405::kMotorPins);  // last: no pin changes hands before its peripheral is at rest
  io.release();
}

}  // namespace

extern "C" {

/// By registers alone: enable line low, set value off by the timer's main output.
void rt_release_outputs() {
  stm32f4::set_pin(stm32f4::gpio_registers(stm32f405::kEnable0.port), stm32f405::kEnable0, false);
  stm32f4::clear_bits(stm32f4::tim1_registers().bdtr, stm32f4::timer::kBdtrMainOutput);
}

void rt_systick_isr() {
  tick.rt_isr();
  stm32f4::pend_cycle(stm32f4::scb_registers());
}

void rt_cycle_isr() {
  runtime.rt_cycle();
}
void rt_usart1_isr() {
  console.rt_isr();
}

}  // extern "C"

int main() {
  using namespace capstan;
  stm32f405::StartReport report = stm32f405::start_core();
  start_motor_peripherals(report.clock);
  console.start(report.clock.apb2_hz, stm32f405::kConsoleBaud);
  report.watchdog_set = watchdog.start(stm32f4::kCycleWatchdog);
  if (!tick.start(report.clock.core_hz, kCycleRateHz)) {
    rt_release_outputs();
    stm32f405::reset_core();
  }
  runtime.run(report);
}
