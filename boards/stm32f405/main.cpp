// SPDX-License-Identifier: Apache-2.0
// The motor board: every object is built here, once.
#include "capstan/boards/stm32f405/banks.hpp"
#include "capstan/boards/stm32f405/board.hpp"
#include "capstan/boards/stm32f405/motor_hardware.hpp"
#include "capstan/boards/stm32f405/own_image.hpp"
#include "capstan/boards/stm32f405/runtime.hpp"
#include "capstan/hal/stm32f4/memory_map.hpp"

// From the linker script: the two parameter banks.
extern "C" capstan::stm32f4::MemoryRegister capstan_bank_a[];
extern "C" capstan::stm32f4::MemoryRegister capstan_bank_b[];

namespace {

using namespace capstan;
constexpr const char* kBoardName = "stm32f405";
[[gnu::section(".image"), gnu::used]] constinit const stm32f405::ImageHeader kImage = stm32f405::own_header(kBoardName);

using stm32f4::MemoryRegister;
using stm32f405::MotorHardware;

constexpr std::size_t kBankWords = stm32f405::kBankBytes / sizeof(std::uint32_t);

stm32f405::SerialPort console{stm32f4::usart1_registers(), stm32f4::nvic_registers(), stm32f4::Interrupt::kUsart1};
stm32f405::BoardTick tick{stm32f4::systick_registers()};
stm32f4::Watchdog<MemoryRegister> watchdog{stm32f4::watchdog_registers()};
stm32f405::CanPort can{stm32f4::can1_registers()};
stm32f405::FlashBanks<MemoryRegister> banks{
    stm32f4::flash_registers(),
    watchdog,
    {std::span(capstan_bank_a, kBankWords), std::span(capstan_bank_b, kBankWords)}};
MotorHardware hardware;
using BoardRuntime = stm32f405::Runtime<MotorHardware::Io>;
[[gnu::section(".noinit")]] BoardRuntime::FaultMemory fault_memory;
BoardRuntime runtime{hardware.io(), {console, tick, watchdog, banks, can}, fault_memory, kBoardName};

}  // namespace

extern "C" {

void rt_release_outputs() {
  MotorHardware::release_by_registers();
}

void rt_encoder_index_isr() {
  hardware.rt_index_isr();
}

}  // extern "C"

#include "capstan/boards/stm32f405/board_isrs.inc"

int main() {
  using namespace capstan;
  stm32f405::StartReport report = stm32f405::start_core();
  stm32f405::start_pins({});
  hardware.start(report.clock);
  console.start(report.clock.apb2_hz, stm32f405::kConsoleBaud);
  runtime.start_can(report.clock);
  report.watchdog_set = watchdog.start(stm32f4::kCycleWatchdog);
  if (!tick.start(report.clock.core_hz, kCycleRateHz)) {
    rt_release_outputs();
    stm32f405::reset_core();
  }
  runtime.run(report);
}
