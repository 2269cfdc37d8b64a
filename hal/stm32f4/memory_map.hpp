// SPDX-License-Identifier: Apache-2.0
// Where the peripherals are (RM0090 table 1; ARMv7-M B3.1). Target only: on the host these addresses belong to nobody,
// and the tests hand the drivers registers of their own.
#pragma once

#include <cstdint>

#include "capstan/hal/stm32f4/adc_registers.hpp"
#include "capstan/hal/stm32f4/can_registers.hpp"
#include "capstan/hal/stm32f4/dma_registers.hpp"
#include "capstan/hal/stm32f4/edge_inputs.hpp"
#include "capstan/hal/stm32f4/gpio.hpp"
#include "capstan/hal/stm32f4/registers.hpp"
#include "capstan/hal/stm32f4/timer_registers.hpp"

namespace capstan::stm32f4 {

namespace detail {
template <typename Block, std::uintptr_t Address>
[[nodiscard]] inline auto at() noexcept -> Block& {
  return *reinterpret_cast<Block*>(Address);  // NOLINT(performance-no-int-to-ptr): that is what a peripheral is
}
}  // namespace detail

using Memory = MemoryRegister;

inline auto rcc_registers() noexcept -> auto& {
  return detail::at<RccRegisters<Memory>, 0x4002'3800>();
}
inline auto power_registers() noexcept -> auto& {
  return detail::at<PowerRegisters<Memory>, 0x4000'7000>();
}
inline auto flash_registers() noexcept -> auto& {
  return detail::at<FlashRegisters<Memory>, 0x4002'3C00>();
}
inline auto watchdog_registers() noexcept -> auto& {
  return detail::at<WatchdogRegisters<Memory>, 0x4000'3000>();
}
inline auto usart1_registers() noexcept -> auto& {
  return detail::at<UsartRegisters<Memory>, 0x4001'1000>();
}
inline auto usart2_registers() noexcept -> auto& {
  return detail::at<UsartRegisters<Memory>, 0x4000'4400>();
}
inline auto can1_registers() noexcept -> auto& {
  return detail::at<CanRegisters<Memory>, 0x4000'6400>();
}
inline auto tim1_registers() noexcept -> auto& {
  return detail::at<TimerRegisters<Memory>, 0x4001'0000>();
}
inline auto tim8_registers() noexcept -> auto& {
  return detail::at<TimerRegisters<Memory>, 0x4001'0400>();
}
/// TIM2 to TIM5 follow each other at 1 KB.
inline auto encoder_timer_registers(std::uint32_t number) noexcept -> TimerRegisters<Memory>& {
  // NOLINTNEXTLINE(performance-no-int-to-ptr)
  return *reinterpret_cast<TimerRegisters<Memory>*>(0x4000'0000U + 0x400U * (number - 2));
}
inline auto adc1_registers() noexcept -> auto& {
  return detail::at<AdcRegisters<Memory>, 0x4001'2000>();
}
inline auto adc_common_registers() noexcept -> auto& {
  return detail::at<AdcCommonRegisters<Memory>, 0x4001'2300>();
}
inline auto dma2_registers() noexcept -> auto& {
  return detail::at<DmaRegisters<Memory>, 0x4002'6400>();
}
inline auto syscfg_registers() noexcept -> auto& {
  return detail::at<SyscfgRegisters<Memory>, 0x4001'3800>();
}
inline auto exti_registers() noexcept -> auto& {
  return detail::at<ExtiRegisters<Memory>, 0x4001'3C00>();
}
inline auto systick_registers() noexcept -> auto& {
  return detail::at<SysTickRegisters<Memory>, 0xE000'E010>();
}
inline auto nvic_registers() noexcept -> auto& {
  return detail::at<NvicRegisters<Memory>, 0xE000'E100>();
}
inline auto scb_registers() noexcept -> auto& {
  return detail::at<ScbRegisters<Memory>, 0xE000'ED00>();
}
/// Ports follow each other at 1 KB.
inline auto gpio_registers(Port port) noexcept -> GpioRegisters<Memory>& {
  // NOLINTNEXTLINE(performance-no-int-to-ptr)
  return *reinterpret_cast<GpioRegisters<Memory>*>(0x4002'0000U + 0x400U * static_cast<std::uint32_t>(port));
}

}  // namespace capstan::stm32f4
