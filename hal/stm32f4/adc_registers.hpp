// SPDX-License-Identifier: Apache-2.0
// Our own definitions of the analogue converter's registers: RM0090 section 13.13.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "capstan/hal/stm32f4/register.hpp"

namespace capstan::stm32f4 {

template <RegisterCell Cell>
struct AdcRegisters {
  Cell sr, cr1, cr2;
  std::array<Cell, 2> smpr;  // [0] channels 10 to 18, [1] channels 0 to 9
  std::array<Cell, 4> jofr;
  Cell htr, ltr;
  std::array<Cell, 3> sqr;  // [0] length and ranks 13 to 16, [2] ranks 1 to 6
  Cell jsqr;
  std::array<Cell, 4> jdr;
  Cell dr;
};
static_assert(offsetof(AdcRegisters<MemoryRegister>, sqr) == 0x2C);
static_assert(offsetof(AdcRegisters<MemoryRegister>, dr) == 0x4C);

template <RegisterCell Cell>
struct AdcCommonRegisters {
  Cell csr, ccr, cdr;
};

namespace adc {
inline constexpr std::uint32_t kSrOverrun = 1U << 5;
inline constexpr std::uint32_t kCr2On = 1U << 0;
inline constexpr std::uint32_t kCr1Scan = 1U << 8;
inline constexpr std::uint32_t kCr2Dma = 1U << 8;
inline constexpr std::uint32_t kCr2DmaGoesOn = 1U << 9;  // DDS: requests after the last transfer of a round too
inline constexpr std::uint32_t kCr2Start = 1U << 30;
inline constexpr std::uint32_t kCcrClockMask = 3U << 16;
inline constexpr std::uint32_t kCcrClockDiv4 = 1U << 16;
inline constexpr std::uint32_t kSqrLengthShift = 20;
inline constexpr std::uint32_t kSample28Cycles = 2U;  // field of SMPR
}  // namespace adc

}  // namespace capstan::stm32f4
