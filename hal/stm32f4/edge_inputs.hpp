// SPDX-License-Identifier: Apache-2.0
// Rising edges of pins as interrupts: EXTI (RM0090 section 12.3) and the multiplexer before it (section 9.2).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "capstan/hal/stm32f4/gpio.hpp"
#include "capstan/hal/stm32f4/register.hpp"

namespace capstan::stm32f4 {

template <RegisterCell Cell>
struct ExtiRegisters {
  Cell imr, emr, rtsr, ftsr, swier, pr;
};
static_assert(offsetof(ExtiRegisters<MemoryRegister>, pr) == 0x14);

template <RegisterCell Cell>
struct SyscfgRegisters {
  Cell memrmp, pmc;
  std::array<Cell, 4> exticr;
};
static_assert(offsetof(SyscfgRegisters<MemoryRegister>, exticr) == 0x08);

/// Pins of one number share one line, so their numbers must differ. The pin must be an input.
template <RegisterCell Cell>
void start_rising_edge(ExtiRegisters<Cell>& exti, SyscfgRegisters<Cell>& syscfg, const Pin& pin) noexcept {
  const std::uint32_t shift = 4U * (pin.number % 4U);
  modify(syscfg.exticr[pin.number / 4U], 0xFU << shift, static_cast<std::uint32_t>(pin.port) << shift);
  set_bits(exti.rtsr, pin.mask());
  exti.pr.write(pin.mask());  // an edge from before
  set_bits(exti.imr, pin.mask());
}

/// Whether the pin had its edge; forgets it. Flags are cleared by writing 1, and 0 leaves the others alone.
template <RegisterCell Cell>
[[nodiscard]] auto rt_take_edge(ExtiRegisters<Cell>& exti, const Pin& pin) noexcept -> bool {
  if ((exti.pr.read() & pin.mask()) == 0) {
    return false;
  }
  exti.pr.write(pin.mask());
  return true;
}

}  // namespace capstan::stm32f4
