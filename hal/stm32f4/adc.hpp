// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "capstan/hal/stm32f4/adc_registers.hpp"
#include "capstan/hal/stm32f4/dma_registers.hpp"

namespace capstan::stm32f4 {

inline constexpr std::uint32_t kAdcFullScale = 4095;  ///< 12 bits

/// A sequence of channels of the analogue converter, started by software once a cycle and carried to memory by the DMA
/// controller (ADC1: DMA2, stream 0, channel 0; RM0090 table 43). Each conversion takes 12 + 28 clocks of 21 MHz, 1.9
/// us, so six are there 11.5 us after rt_begin(): what a cycle reads was measured in that cycle.
///
/// An overrun stops the transfers until converter and stream are set up anew (RM0090 section 13.8.1), and a transfer
/// error stops the stream: both, and a sequence that does not end, cost one snapshot and are mended in the rt_finish()
/// that saw it. So the converter, which needs 3 us after it was switched on (t_STAB of the datasheet), has a cycle for
/// that.
template <RegisterCell Cell, std::size_t Channels>
class AdcScan {
  static_assert(Channels >= 1 && Channels <= 6, "the sequence is kept in one register");

 public:
  AdcScan(AdcRegisters<Cell>& registers, AdcCommonRegisters<Cell>& common, DmaRegisters<Cell>& dma) noexcept
      : registers_(registers), common_(common), dma_(dma) {}

  /// `channels` 0 to 18, in the order of the results. The clocks of both peripherals must be on.
  void start(const std::array<std::uint8_t, Channels>& channels) noexcept {
    modify(common_.ccr, adc::kCcrClockMask, adc::kCcrClockDiv4);
    std::uint32_t sequence = 0;
    for (std::size_t rank = 0; rank < Channels; ++rank) {
      const std::uint32_t channel = channels[rank];
      const std::uint32_t shift = 3 * (channel % 10);
      modify(registers_.smpr[channel >= 10 ? 0 : 1], 7U << shift, adc::kSample28Cycles << shift);
      sequence |= channel << (5 * rank);
    }
    registers_.cr1.write(adc::kCr1Scan);
    registers_.sqr[0].write(static_cast<std::uint32_t>(Channels - 1) << adc::kSqrLengthShift);
    registers_.sqr[2].write(sequence);
    mended_ = set_up();
  }

  /// Starts one sequence; rt_finish() waits for it.
  void rt_begin() noexcept {
    if (mended_) {
      dma_.ifcr[0].write(dma::kFlags);
      set_bits(registers_.cr2, adc::kCr2Start);
    }
  }

  /// Results of the sequence begun last. False: it did not end within the bound, was overrun, or did not reach memory;
  /// `raw` is unchanged.
  [[nodiscard]] auto rt_finish(std::span<std::uint32_t, Channels> raw) noexcept -> bool {
    constexpr std::uint32_t kBad = dma::kDirectError | dma::kTransferError;
    const bool whole = mended_ && wait_for(dma_.isr[0], dma::kComplete, dma::kComplete, kPolls) &&
                       (registers_.sr.read() & adc::kSrOverrun) == 0 && (dma_.isr[0].read() & kBad) == 0;
    if (!whole) {
      ++failures_;
      mended_ = set_up();
      return false;
    }
    for (std::size_t i = 0; i < Channels; ++i) {
      raw[i] = results_[i].read();
    }
    return true;
  }

  /// Sequences without a result since start; wraps.
  [[nodiscard]] auto failures() const noexcept -> std::uint32_t { return failures_; }

 private:
  /// Converter and stream from scratch. False: the stream does not let itself be switched off.
  [[nodiscard]] auto set_up() noexcept -> bool {
    registers_.cr2.write(0);  // off, which ends a sequence that hangs
    registers_.sr.write(0);   // its flags are cleared by writing 0
    DmaStreamRegisters<Cell>& stream = dma_.stream[0];
    clear_bits(stream.cr, dma::kCrEnable);
    if (!wait_for(stream.cr, dma::kCrEnable, 0, kPolls)) {
      return false;  // settings may only change while it is off (RM0090 section 10.5.5)
    }
    dma_.ifcr[0].write(dma::kFlags);
    stream.ndtr.write(Channels);
    stream.par.write(address_of(registers_.dr));
    stream.m0ar.write(address_of(results_[0]));
    stream.fcr.write(0);  // no FIFO between the two
    stream.cr.write(dma::kCrWords | dma::kCrMemoryIncrement | dma::kCrCircular | dma::kCrHighPriority);
    set_bits(stream.cr, dma::kCrEnable);
    registers_.cr2.write(adc::kCr2Dma | adc::kCr2DmaGoesOn | adc::kCr2On);
    return true;
  }

  /// The chip's addresses have 32 bits.
  static auto address_of(const Cell& cell) noexcept -> std::uint32_t {
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(&cell));
  }

  /// Two and a half times the six conversions' 1920 core cycles at 168 MHz, with at least 8 cycles a poll.
  static constexpr std::uint32_t kPolls = 600;

  AdcRegisters<Cell>& registers_;
  AdcCommonRegisters<Cell>& common_;
  DmaRegisters<Cell>& dma_;
  std::array<Cell, Channels> results_{};
  std::uint32_t failures_ = 0;
  bool mended_ = false;
};

}  // namespace capstan::stm32f4
