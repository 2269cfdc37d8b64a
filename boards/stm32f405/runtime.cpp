// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/stm32f405/runtime.hpp"

#include "capstan/hal/stm32f4/memory_map.hpp"
#include "capstan/hal/stm32f4/nvic.hpp"

namespace capstan::stm32f405 {

void print_hex(Print& out, std::uint32_t value) {
  for (int shift = 28; shift >= 0; shift -= 4) {
    out << "0123456789abcdef"[(value >> shift) & 0xFU];
  }
}

auto start_core() noexcept -> StartReport {
  auto& rcc = stm32f4::rcc_registers();
  StartReport report;
  report.reset_cause = stm32f4::take_reset_cause(rcc);
  report.faulted = take_fault_record(report.fault);
  report.clock = stm32f4::start_clocks(rcc, stm32f4::power_registers(), stm32f4::flash_registers());
  report.brown_out_watched = stm32f4::brown_out_watched(stm32f4::flash_registers());
  auto& nvic = stm32f4::nvic_registers();
  stm32f4::set_priority(nvic, stm32f4::Interrupt::kUsart1, stm32f4::Priority::kSerial);
  stm32f4::set_priority(nvic, stm32f4::Interrupt::kUsart2, stm32f4::Priority::kSerial);
  for (const stm32f4::Interrupt interrupt : {stm32f4::Interrupt::kCan1Receive0, stm32f4::Interrupt::kCan1Receive1}) {
    stm32f4::set_priority(nvic, interrupt, stm32f4::Priority::kSerial);
    stm32f4::enable_interrupt(nvic, interrupt);  // silent until the controller is started
  }
  stm32f4::set_core_priorities(stm32f4::scb_registers(), stm32f4::Priority::kCycle, stm32f4::Priority::kTick);
  return report;
}

void start_pins(std::span<const stm32f4::Pin> pins) noexcept {
  namespace rcc = stm32f4::rcc;
  auto& registers = stm32f4::rcc_registers();
  stm32f4::set_bits(registers.ahb1enr, rcc::kAhb1GpioA | rcc::kAhb1GpioB | rcc::kAhb1GpioC | rcc::kAhb1GpioD);
  stm32f4::set_bits(registers.apb2enr, rcc::kApb2Usart1);
  stm32f4::set_bits(registers.apb1enr, rcc::kApb1Can1);
  for (const stm32f4::Pin& pin : kCommonPins) {
    stm32f4::configure_pin(stm32f4::gpio_registers(pin.port), pin);
  }
  for (const stm32f4::Pin& pin : pins) {
    stm32f4::configure_pin(stm32f4::gpio_registers(pin.port), pin);
  }
}

void print_start(Print& out, const StartReport& report) {
  out << "# reset by " << name(report.reset_cause) << ", core at " << report.clock.core_hz / 1'000'000 << " MHz\r\n";
  if (report.clock.is_fault()) {
    out << "# clock fault: " << describe(report.clock.source) << "\r\n";
  }
  if (!report.brown_out_watched) {
    out << "# brown-out reset is off or below 2.7 V, so a supply that sags lets the core run outside its limits; set "
           "the "
           "option bits BOR_LEV to 0 (level 3) with the programmer's tool\r\n";
  }
  if (!report.watchdog_set) {
    out << "# watchdog fault: it did not take its setting and resets too late; restart the board, and replace it if "
           "this happens again\r\n";
  }
  if (report.faulted) {
    out << "# the last run ended in a " << fault_name(report.fault) << " at 0x";
    print_hex(out, report.fault.program_counter);
    out << " called from 0x";
    print_hex(out, report.fault.link_register);
    out << ", status 0x";
    print_hex(out, report.fault.fault_status);
    out << " address 0x";
    print_hex(out, report.fault.address);
    out << "; look both up in the image's map and report it\r\n";
  }
}

void print_timing(Print& out, const Timing& timing, std::uint32_t core_hz) {
  const auto line = [&out, core_hz](const char* what, const stm32f4::CycleMeter& meter) {
    out << what << " last " << meter.last() << " max " << meter.max() << " core cycles ("
        << stm32f4::emulated_instructions(meter.last(), core_hz) << " and "
        << stm32f4::emulated_instructions(meter.max(), core_hz) << " instructions in the emulator)";
  };
  line("cycle", timing.cycle);
  line(", its input and output", timing.hardware);
  out << ", overruns " << timing.overruns.load(std::memory_order_relaxed) << ", stack unused " << stack_unused_bytes()
      << " of " << stack_size_bytes() << " bytes\r\n";
}

}  // namespace capstan::stm32f405
