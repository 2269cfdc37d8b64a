// SPDX-License-Identifier: Apache-2.0
// Our own definitions of the timers' registers: RM0090 section 17.4 (TIM1, TIM8) and 18.4 (TIM2 to TIM5), one layout
// for both.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "capstan/hal/stm32f4/register.hpp"

namespace capstan::stm32f4 {

template <RegisterCell Cell>
struct TimerRegisters {
  Cell cr1, cr2, smcr, dier, sr, egr;
  std::array<Cell, 2> ccmr;
  Cell ccer, cnt, psc, arr, rcr;
  std::array<Cell, 4> ccr;
  Cell bdtr;
};
static_assert(offsetof(TimerRegisters<MemoryRegister>, cnt) == 0x24);
static_assert(offsetof(TimerRegisters<MemoryRegister>, ccr) == 0x34);
static_assert(offsetof(TimerRegisters<MemoryRegister>, bdtr) == 0x44);

namespace timer {
inline constexpr std::uint32_t kCr1Enable = 1U << 0;
inline constexpr std::uint32_t kCr1PreloadReload = 1U << 7;
inline constexpr std::uint32_t kSmcrQuadrature = 3U;  // count on both edges of both inputs
inline constexpr std::uint32_t kEgrUpdate = 1U << 0;
inline constexpr std::uint32_t kSrUpdate = 1U << 0;
inline constexpr std::uint32_t kSrBreak = 1U << 7;
/// Both channels of CCMR1 as inputs on their own pins, with a filter field of four bits each.
inline constexpr std::uint32_t kCcmrInputs = (1U << 0) | (1U << 8);
inline constexpr std::uint32_t kCcmrFilter1Shift = 4;
inline constexpr std::uint32_t kCcmrFilter2Shift = 12;
inline constexpr std::uint32_t kCcerInvert1 = 1U << 1;
inline constexpr std::uint32_t kCcerOutputs = (1U << 0) | (1U << 4) | (1U << 8) | (1U << 12);  // all four channels
/// One output channel's byte of CCMR: PWM mode 1 (high while the counter is below the compare value), preloaded.
inline constexpr std::uint32_t kCcmrPwm = (6U << 4) | (1U << 3);
/// OSSI: while the main output is off, enabled channels are driven low. A channel that is not enabled either, as after
/// a release, is not driven: the pin's pull-down holds it (RM0090, output control bits of complementary channels).
inline constexpr std::uint32_t kBdtrIdleDriven = 1U << 10;
inline constexpr std::uint32_t kBdtrBreakEnable = 1U << 12;
inline constexpr std::uint32_t kBdtrBreakHigh = 1U << 13;
inline constexpr std::uint32_t kBdtrMainOutput = 1U << 15;
}  // namespace timer

}  // namespace capstan::stm32f4
