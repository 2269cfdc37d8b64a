// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "capstan/hal/stm32f4/registers.hpp"

namespace capstan::stm32f4 {

/// Positions in the vector table after the 16 of the core (RM0090 table 61). Only those in use.
enum class Interrupt : std::uint8_t {
  kCan1Receive0 = 20,
  kCan1Receive1 = 21,
  kUsart1 = 37,
  kUsart2 = 38,
  kExti15To10 = 40
};
inline constexpr std::uint32_t kInterruptCount = 82;

/// Urgency, most urgent first; the chip decodes the upper four bits of each priority byte.
/// The tick only counts, so it may delay nothing and must never be delayed: with it on top the count of ticks is exact
/// even when a cycle overruns. The serial ports come next, as they have one byte of buffer (87 us at 115200 baud) and
/// the cycle may take longer. The cycle itself has the least urgency of all interrupts and thus preempts the shell
/// only. An encoder's index is as urgent as the tick: it takes down where the counter stands, and is over.
enum class Priority : std::uint8_t { kTick = 0x10, kIndex = 0x10, kSerial = 0x20, kCycle = 0xF0 };

template <RegisterCell Cell>
void set_priority(NvicRegisters<Cell>& nvic, Interrupt interrupt, Priority priority) noexcept {
  const auto number = static_cast<std::uint32_t>(interrupt);
  const std::uint32_t shift = 8 * (number % 4);
  modify(nvic.ipr[number / 4], 0xFFU << shift, static_cast<std::uint32_t>(priority) << shift);
}

/// Set-enable and set-pending registers: writing 0 to the other bits leaves them alone.
template <RegisterCell Cell>
void enable_interrupt(NvicRegisters<Cell>& nvic, Interrupt interrupt) noexcept {
  const auto number = static_cast<std::uint32_t>(interrupt);
  nvic.iser[number / 32].write(1U << (number % 32));
}

template <RegisterCell Cell>
void pend_interrupt(NvicRegisters<Cell>& nvic, Interrupt interrupt) noexcept {
  const auto number = static_cast<std::uint32_t>(interrupt);
  nvic.ispr[number / 32].write(1U << (number % 32));
}

/// PendSV (exception 14) and SysTick (15) are the upper half of the third system priority register.
template <RegisterCell Cell>
void set_core_priorities(ScbRegisters<Cell>& scb, Priority cycle, Priority tick) noexcept {
  modify(scb.shpr[2], 0xFFFF'0000U,
         (static_cast<std::uint32_t>(cycle) << 16) | (static_cast<std::uint32_t>(tick) << 24));
}

template <RegisterCell Cell>
void pend_cycle(ScbRegisters<Cell>& scb) noexcept {
  scb.icsr.write(scb::kIcsrPendSv);
}

}  // namespace capstan::stm32f4
