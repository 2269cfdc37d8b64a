// SPDX-License-Identifier: Apache-2.0
// Our own definitions of a DMA controller's registers: RM0090 section 10.5.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "capstan/hal/stm32f4/register.hpp"

namespace capstan::stm32f4 {

template <RegisterCell Cell>
struct DmaStreamRegisters {
  Cell cr, ndtr, par, m0ar, m1ar, fcr;
};

template <RegisterCell Cell>
struct DmaRegisters {
  std::array<Cell, 2> isr;   // [0] streams 0 to 3, [1] streams 4 to 7
  std::array<Cell, 2> ifcr;  // write 1 to clear the flag of the same place in isr
  std::array<DmaStreamRegisters<Cell>, 8> stream;
};
static_assert(offsetof(DmaRegisters<MemoryRegister>, stream) == 0x10);
static_assert(sizeof(DmaRegisters<MemoryRegister>) == 0xD0);

/// Bits of stream 0, which is the only one in use.
namespace dma {
inline constexpr std::uint32_t kFlags = 0x3D;  // all five of the stream
inline constexpr std::uint32_t kDirectError = 1U << 2;
inline constexpr std::uint32_t kTransferError = 1U << 3;
inline constexpr std::uint32_t kComplete = 1U << 5;
inline constexpr std::uint32_t kCrEnable = 1U << 0;
inline constexpr std::uint32_t kCrCircular = 1U << 8;
inline constexpr std::uint32_t kCrMemoryIncrement = 1U << 10;
inline constexpr std::uint32_t kCrWords = (2U << 11) | (2U << 13);  // 32 bits on both sides; from peripheral to memory
inline constexpr std::uint32_t kCrHighPriority = 2U << 16;
}  // namespace dma

}  // namespace capstan::stm32f4
