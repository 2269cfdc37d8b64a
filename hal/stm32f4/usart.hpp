// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "capstan/hal/stm32f4/nvic.hpp"
#include "capstan/hal/stm32f4/registers.hpp"
#include "capstan/hal/stm32f4/ring_buffer.hpp"

namespace capstan::stm32f4 {

/// What went wrong on a serial line since start. Counters wrap.
struct UsartErrors {
  std::uint32_t hardware_overruns = 0;  ///< the interrupt came too late: a byte was lost in the peripheral
  std::uint32_t ring_overruns = 0;      ///< the reader came too late: a byte was lost at the full ring
  std::uint32_t line_errors = 0;        ///< framing error or noise: the byte was thrown away
};

/// Divider for 16-fold oversampling, rounded (RM0090 section 30.3.4: BRR holds the divider in sixteenths).
[[nodiscard]] constexpr auto baud_divider(std::uint32_t bus_hz, std::uint32_t baud) -> std::uint32_t {
  return (bus_hz + baud / 2) / baud;
}
/// Error of the rate reached, in parts per thousand, never negative. A receiver samples ten bits: 20 per thousand is
/// safe.
[[nodiscard]] constexpr auto baud_error_permille(std::uint32_t bus_hz, std::uint32_t baud) -> std::uint32_t {
  const std::uint32_t reached = bus_hz / baud_divider(bus_hz, baud);
  return (reached > baud ? reached - baud : baud - reached) * 1000 / baud;
}
static_assert(baud_error_permille(84'000'000, 115'200) < 5 && baud_error_permille(16'000'000, 115'200) < 5);

/// Interrupt-driven 8N1 port with bounded rings. rt_isr() runs in the port's interrupt; everything else in one other
/// context. Where bytes were lost one kGap stands before the next good one, so that no reader takes what is left of two
/// lines for a line.
template <RegisterCell Cell, std::size_t RxSize, std::size_t TxSize>
class Usart {
 public:
  static constexpr std::size_t kTxRoom = TxSize;
  static constexpr std::uint8_t kGap = 0;  ///< no text, and the end of a COBS frame

  Usart(UsartRegisters<Cell>& registers, NvicRegisters<Cell>& nvic, Interrupt interrupt) noexcept
      : registers_(registers), nvic_(nvic), interrupt_(interrupt) {}

  /// The port's clock, pins and priority are the board's business and must be on before.
  void start(std::uint32_t bus_hz, std::uint32_t baud) noexcept {
    registers_.cr1.write(0);
    registers_.cr2.write(0);
    registers_.cr3.write(0);
    registers_.brr.write(baud_divider(bus_hz, baud));
    registers_.cr1.write(kRunning);
    enable_interrupt(nvic_, interrupt_);
  }

  /// Next received byte, or false.
  [[nodiscard]] auto read(std::uint8_t& byte) noexcept -> bool { return rx_.pop(byte); }

  /// Queues as many bytes as fit and returns how many those were; never waits.
  auto write(std::span<const std::uint8_t> bytes) noexcept -> std::size_t {
    std::size_t taken = 0;
    while (taken < bytes.size() && tx_.push(bytes[taken])) {
      ++taken;
    }
    if (taken > 0) {
      registers_.cr1.write(kRunning | usart::kCr1TransmitInterrupt);
      // The empty transmit register would raise the interrupt by itself. Pending it as well costs nothing on the chip
      // and makes the same driver work on an emulated port that knows no transmit interrupt (QEMU 7.2).
      pend_interrupt(nvic_, interrupt_);
    }
    return taken;
  }
  [[nodiscard]] auto write_free() const noexcept -> std::size_t { return tx_.free(); }
  [[nodiscard]] auto errors() const noexcept -> UsartErrors { return errors_; }

  void rt_isr() noexcept {
    rt_receive();
    rt_transmit();
  }

 private:
  static constexpr std::uint32_t kRunning =
      usart::kCr1Enable | usart::kCr1Receive | usart::kCr1Transmit | usart::kCr1ReceiveInterrupt;

  void rt_receive() noexcept {
    const std::uint32_t status = registers_.sr.read();
    if ((status & (usart::kSrReceived | usart::kSrOverrun)) == 0) {
      return;
    }
    // Reading the status and then the data clears the flags (RM0090 section 30.6.1).
    const auto byte = static_cast<std::uint8_t>(registers_.dr.read() & 0xFFU);
    errors_.hardware_overruns += (status & usart::kSrOverrun) != 0 ? 1U : 0U;
    if ((status & (usart::kSrFraming | usart::kSrNoise)) != 0) {
      ++errors_.line_errors;
      gap_ = true;
    } else if ((status & usart::kSrReceived) != 0) {
      rt_keep(byte);
    }
    gap_ |= (status & usart::kSrOverrun) != 0;  // what was lost came behind this byte
  }

  void rt_keep(std::uint8_t byte) noexcept {
    gap_ = gap_ && !rx_.push(kGap);
    if (gap_ || !rx_.push(byte)) {
      ++errors_.ring_overruns;
      gap_ = true;
    }
  }

  void rt_transmit() noexcept {
    // Bounded by the ring. On the chip the flag falls with the first byte; an emulated port takes them all at once.
    for (std::size_t i = 0; i < TxSize && (registers_.sr.read() & usart::kSrTransmitEmpty) != 0; ++i) {
      std::uint8_t byte = 0;
      if (!tx_.pop(byte)) {
        registers_.cr1.write(kRunning);  // nothing left: without this the empty register would interrupt for ever
        return;
      }
      registers_.dr.write(byte);
    }
  }

  UsartRegisters<Cell>& registers_;
  NvicRegisters<Cell>& nvic_;
  Interrupt interrupt_;
  RingBuffer<RxSize> rx_;
  RingBuffer<TxSize> tx_;
  UsartErrors errors_;
  bool gap_ = false;  // bytes were lost since the last one that was kept
};

}  // namespace capstan::stm32f4
