// SPDX-License-Identifier: Apache-2.0
// Our own definitions of the CAN controller's registers: RM0090 section 32.9.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "capstan/hal/stm32f4/register.hpp"

namespace capstan::stm32f4 {

/// One mailbox: identifier, length, first and last four bytes. Three to send, one at the head of each receive FIFO.
template <RegisterCell Cell>
struct CanMailboxRegisters {
  Cell identifier, length, low, high;
};

template <RegisterCell Cell>
struct CanRegisters {
  Cell mcr, msr, tsr;
  std::array<Cell, 2> rfr;  // one for each receive FIFO
  Cell ier, esr, btr;
  std::array<Cell, 88> reserved0;
  std::array<CanMailboxRegisters<Cell>, 3> send;
  std::array<CanMailboxRegisters<Cell>, 2> receive;
  std::array<Cell, 12> reserved1;
  Cell fmr, fm1r, reserved2, fs1r, reserved3, ffa1r, reserved4, fa1r;
  std::array<Cell, 8> reserved5;
  std::array<std::array<Cell, 2>, 28> filter;
};
static_assert(offsetof(CanRegisters<MemoryRegister>, send) == 0x180);
static_assert(offsetof(CanRegisters<MemoryRegister>, receive) == 0x1B0);
static_assert(offsetof(CanRegisters<MemoryRegister>, fmr) == 0x200);
static_assert(offsetof(CanRegisters<MemoryRegister>, fa1r) == 0x21C);
static_assert(offsetof(CanRegisters<MemoryRegister>, filter) == 0x240);

namespace can {
inline constexpr std::uint32_t kMcrInit = 1U << 0;
inline constexpr std::uint32_t kMcrInOrder = 1U << 2;  // TXFP: frames leave in the order in which they were given
inline constexpr std::uint32_t kMsrInit = 1U << 0;
inline constexpr std::uint32_t kTsrDone =
    (1U << 0) | (1U << 8) | (1U << 16);            // RQCP; write 1 to clear, with its result
inline constexpr std::uint32_t kTsrSentShift = 1;  // TXOK beside each of them
inline constexpr std::uint32_t kTsrAbort = (1U << 7) | (1U << 15) | (1U << 23);
inline constexpr std::uint32_t kTsrEmptyShift = 26;
inline constexpr std::uint32_t kTsrEmpty = 7U << kTsrEmptyShift;
inline constexpr std::uint32_t kRfrPending = 3U;       // frames in the FIFO
inline constexpr std::uint32_t kRfrFull = 1U << 3;     // write 1 to clear
inline constexpr std::uint32_t kRfrOverrun = 1U << 4;  // write 1 to clear
inline constexpr std::uint32_t kRfrRelease = 1U << 5;
inline constexpr std::uint32_t kIerPending = (1U << 1) | (1U << 4);  // both FIFOs
inline constexpr std::uint32_t kEsrPassive = 1U << 1;
inline constexpr std::uint32_t kEsrBusOff = 1U << 2;
inline constexpr std::uint32_t kTransmitRequest = 1U << 0;
inline constexpr std::uint32_t kIdentifierShift = 21;
inline constexpr std::uint32_t kNotStandard = (1U << 1) | (1U << 2);  // remote or extended
inline constexpr std::uint32_t kFmrInit = 1U << 0;
}  // namespace can

}  // namespace capstan::stm32f4
