// SPDX-License-Identifier: Apache-2.0
// Our own definitions of the few registers this firmware touches; no vendor header is packaged. Layouts and bits are
// those of the reference manual RM0090 (STM32F405/407), section numbers beside each block, and for the core of the
// ARMv7-M architecture manual. Only bits that are used have a name.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "capstan/hal/stm32f4/register.hpp"

namespace capstan::stm32f4 {

/// Reset and clock control, RM0090 section 7.3.
template <RegisterCell Cell>
struct RccRegisters {
  Cell cr, pllcfgr, cfgr, cir;
  Cell ahb1rstr, ahb2rstr, ahb3rstr, reserved0;
  Cell apb1rstr, apb2rstr, reserved1, reserved2;
  Cell ahb1enr, ahb2enr, ahb3enr, reserved3;
  Cell apb1enr, apb2enr, reserved4, reserved5;
  std::array<Cell, 8> low_power;  // the peripherals' clocks in sleep mode: left as they are after reset
  Cell bdcr, csr;
};
static_assert(offsetof(RccRegisters<MemoryRegister>, apb2enr) == 0x44);
static_assert(offsetof(RccRegisters<MemoryRegister>, csr) == 0x74);

namespace rcc {
inline constexpr std::uint32_t kCrHsiOn = 1U << 0;
inline constexpr std::uint32_t kCrHsiReady = 1U << 1;
inline constexpr std::uint32_t kCrHseOn = 1U << 16;
inline constexpr std::uint32_t kCrHseReady = 1U << 17;
inline constexpr std::uint32_t kCrSecurityOn = 1U << 19;
inline constexpr std::uint32_t kCrPllOn = 1U << 24;
inline constexpr std::uint32_t kCrPllReady = 1U << 25;
inline constexpr std::uint32_t kPllSourceHse = 1U << 22;
inline constexpr std::uint32_t kCfgrSwitchMask = 3U << 0;
inline constexpr std::uint32_t kCfgrSwitchPll = 2U << 0;
inline constexpr std::uint32_t kCfgrStatusMask = 3U << 2;
inline constexpr std::uint32_t kCfgrStatusPll = 2U << 2;
inline constexpr std::uint32_t kCfgrPrescalerMask = (0xFU << 4) | (7U << 10) | (7U << 13);
inline constexpr std::uint32_t kCfgrApb1Div4 = 5U << 10;
inline constexpr std::uint32_t kCfgrApb2Div2 = 4U << 13;
inline constexpr std::uint32_t kAhb1GpioA = 1U << 0;
inline constexpr std::uint32_t kAhb1GpioB = 1U << 1;
inline constexpr std::uint32_t kAhb1GpioC = 1U << 2;
inline constexpr std::uint32_t kAhb1GpioD = 1U << 3;
inline constexpr std::uint32_t kAhb1Dma2 = 1U << 22;
inline constexpr std::uint32_t kApb1Tim2 = 1U << 0;
inline constexpr std::uint32_t kApb1Tim3 = 1U << 1;
inline constexpr std::uint32_t kApb1Tim4 = 1U << 2;
inline constexpr std::uint32_t kApb1Tim5 = 1U << 3;
inline constexpr std::uint32_t kApb1Usart2 = 1U << 17;
inline constexpr std::uint32_t kApb1Can1 = 1U << 25;
inline constexpr std::uint32_t kApb1Power = 1U << 28;
inline constexpr std::uint32_t kApb2Tim1 = 1U << 0;
inline constexpr std::uint32_t kApb2Tim8 = 1U << 1;
inline constexpr std::uint32_t kApb2Usart1 = 1U << 4;
inline constexpr std::uint32_t kApb2Adc1 = 1U << 8;
inline constexpr std::uint32_t kApb2Syscfg = 1U << 14;
inline constexpr std::uint32_t kCsrRemoveFlags = 1U << 24;
inline constexpr std::uint32_t kCsrBrownOut = 1U << 25;
inline constexpr std::uint32_t kCsrPin = 1U << 26;
inline constexpr std::uint32_t kCsrPowerOn = 1U << 27;
inline constexpr std::uint32_t kCsrSoftware = 1U << 28;
inline constexpr std::uint32_t kCsrIndependentWatchdog = 1U << 29;
inline constexpr std::uint32_t kCsrWindowWatchdog = 1U << 30;
inline constexpr std::uint32_t kCsrLowPower = 1U << 31;
}  // namespace rcc

/// Power control, RM0090 section 5.4.
template <RegisterCell Cell>
struct PowerRegisters {
  Cell cr, csr;
};
namespace power {
inline constexpr std::uint32_t kCrScale1 = 1U << 14;  // the core voltage 168 MHz needs
}

/// Flash interface, RM0090 section 3.9.
template <RegisterCell Cell>
struct FlashRegisters {
  Cell acr, keyr, optkeyr, sr, cr, optcr;
};
namespace flash {
inline constexpr std::uint32_t kAcrLatencyMask = 7U;
inline constexpr std::uint32_t kAcrPrefetch = 1U << 8;
inline constexpr std::uint32_t kAcrInstructionCache = 1U << 9;
inline constexpr std::uint32_t kAcrDataCache = 1U << 10;
inline constexpr std::uint32_t kAcrDataCacheReset = 1U << 12;
inline constexpr std::uint32_t kKey1 = 0x4567'0123;
inline constexpr std::uint32_t kKey2 = 0xCDEF'89AB;
inline constexpr std::uint32_t kSrErrors =
    0xF2;  // operation, write protection, alignment, size, sequence; write 1 to clear
inline constexpr std::uint32_t kSrBusy = 1U << 16;
inline constexpr std::uint32_t kCrProgram = 1U << 0;
inline constexpr std::uint32_t kCrSectorErase = 1U << 1;
inline constexpr std::uint32_t kCrSectorShift = 3;
inline constexpr std::uint32_t kCrWordSize = 2U << 8;  // 32 bits at a time: needs 2.7 V or more
inline constexpr std::uint32_t kCrStart = 1U << 16;
inline constexpr std::uint32_t kCrLock = 1U << 31;
inline constexpr std::uint32_t kOptcrBrownOutMask = 3U << 2;  // BOR_LEV: 0 is level 3, from 2.7 V; 3 is off
}  // namespace flash

/// General-purpose pins, RM0090 section 8.4.
template <RegisterCell Cell>
struct GpioRegisters {
  Cell moder, otyper, ospeedr, pupdr, idr, odr, bsrr, lckr;
  std::array<Cell, 2> afr;
};
static_assert(offsetof(GpioRegisters<MemoryRegister>, afr) == 0x20);

/// Serial port, RM0090 section 30.6.
template <RegisterCell Cell>
struct UsartRegisters {
  Cell sr, dr, brr, cr1, cr2, cr3, gtpr;
};
namespace usart {
inline constexpr std::uint32_t kSrFraming = 1U << 1;
inline constexpr std::uint32_t kSrNoise = 1U << 2;
inline constexpr std::uint32_t kSrOverrun = 1U << 3;
inline constexpr std::uint32_t kSrReceived = 1U << 5;       // RXNE
inline constexpr std::uint32_t kSrTransmitEmpty = 1U << 7;  // TXE
inline constexpr std::uint32_t kCr1Receive = 1U << 2;
inline constexpr std::uint32_t kCr1Transmit = 1U << 3;
inline constexpr std::uint32_t kCr1ReceiveInterrupt = 1U << 5;
inline constexpr std::uint32_t kCr1TransmitInterrupt = 1U << 7;
inline constexpr std::uint32_t kCr1Enable = 1U << 13;
}  // namespace usart

/// Independent watchdog, RM0090 section 21.4.
template <RegisterCell Cell>
struct WatchdogRegisters {
  Cell kr, pr, rlr, sr;
};
namespace watchdog {
inline constexpr std::uint32_t kKeyReload = 0xAAAA;
inline constexpr std::uint32_t kKeyUnlock = 0x5555;
inline constexpr std::uint32_t kKeyStart = 0xCCCC;
inline constexpr std::uint32_t kSrBusy =
    3U;  // PVU and RVU: the new divider and reload are still on their way to the LSI side
}  // namespace watchdog

/// System timer of the core, ARMv7-M B3.3.
template <RegisterCell Cell>
struct SysTickRegisters {
  Cell csr, rvr, cvr, calib;
};
namespace systick {
inline constexpr std::uint32_t kCsrEnable = 1U << 0;
inline constexpr std::uint32_t kCsrInterrupt = 1U << 1;
inline constexpr std::uint32_t kCsrCoreClock = 1U << 2;
inline constexpr std::uint32_t kCsrCounted = 1U << 16;  // to 0 since this was last read
inline constexpr std::uint32_t kMaxReload = 0x00FF'FFFF;
}  // namespace systick

/// Interrupt controller, ARMv7-M B3.4. Priorities are bytes in four-byte words.
template <RegisterCell Cell>
struct NvicRegisters {
  std::array<Cell, 32> iser, icer, ispr, icpr, iabr;
  std::array<Cell, 32> reserved;
  std::array<Cell, 60> ipr;
};
static_assert(offsetof(NvicRegisters<MemoryRegister>, ispr) == 0x100);
static_assert(offsetof(NvicRegisters<MemoryRegister>, ipr) == 0x300);

/// System control block, ARMv7-M B3.2.
template <RegisterCell Cell>
struct ScbRegisters {
  Cell cpuid, icsr, vtor, aircr, scr, ccr;
  std::array<Cell, 3> shpr;
  Cell shcsr, cfsr, hfsr, dfsr, mmfar, bfar;
};
static_assert(offsetof(ScbRegisters<MemoryRegister>, bfar) == 0x38);
namespace scb {
inline constexpr std::uint32_t kIcsrPendSv = 1U << 28;
inline constexpr std::uint32_t kAircrReset = (0x05FAU << 16) | (1U << 2);
inline constexpr std::uint32_t kCcrTrapDivideByZero = 1U << 4;
inline constexpr std::uint32_t kShcsrFaultsOn = 7U << 16;  // usage, bus and memory faults get handlers of their own
}  // namespace scb

}  // namespace capstan::stm32f4
