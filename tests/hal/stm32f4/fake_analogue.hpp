// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "capstan/hal/stm32f4/adc_registers.hpp"
#include "capstan/hal/stm32f4/dma_registers.hpp"
#include "capstan/tests/hal/stm32f4/fake_register.hpp"

namespace capstan::stm32f4 {

/// ADC1 and stream 0 of DMA2 as RM0090 sections 13.8.1 and 10.3 describe them: one start bit converts a whole sequence;
/// each result asks for a transfer; an overrun stops the requests until the flag is cleared and the DMA bit set anew; a
/// stream's settings are closed while it is enabled; in circular mode its counter reloads; flags are cleared through
/// another register by writing 1.
class FakeAnalogue {
 public:
  FakeAnalogue() {
    adc1.sr.on_write = write_zero_to_clear(0x3F);
    adc1.cr2.on_write = [this](std::uint32_t old, std::uint32_t written) {
      requests_stopped = requests_stopped && (written & adc::kCr2Dma) != 0;
      settled = settled && (old & written & adc::kCr2On) != 0;
      if ((written & adc::kCr2Start) != 0 && (old & written & adc::kCr2On) != 0) {
        convert(written);
      }
      return written & ~adc::kCr2Start;
    };
    dma2.ifcr[0].on_write = [this](std::uint32_t, std::uint32_t written) {
      dma2.isr[0].value &= ~written;
      return 0U;
    };
    auto& stream = dma2.stream[0];
    stream.cr.on_write = [this](std::uint32_t old, std::uint32_t written) {
      const bool was_on = (old & dma::kCrEnable) != 0;
      if (was_on && ((written & dma::kCrEnable) != 0 || stream_stays_on)) {
        return old;
      }
      if (!was_on && (written & dma::kCrEnable) != 0) {
        reload = dma2.stream[0].ndtr.value;
      }
      return written;
    };
    stream.ndtr.on_write = [this](std::uint32_t old, std::uint32_t written) {
      return (dma2.stream[0].cr.value & dma::kCrEnable) != 0 ? old : written;
    };
  }

  AdcRegisters<FakeRegister> adc1;
  AdcCommonRegisters<FakeRegister> adc_common;
  DmaRegisters<FakeRegister> dma2;
  std::vector<std::uint32_t> channel_values = std::vector<std::uint32_t>(19, 2048);

  bool converter_answers = true;
  bool stream_stays_on = false;            ///< its enable bit can not be cleared
  bool transfer_error_next = false;        ///< at the next transfer: the stream switches itself off
  std::optional<std::size_t> overrun_at;   ///< rank whose result is not fetched in time, once
  const void* memory_neighbour = nullptr;  ///< anything near the buffer: gives the upper half of its address
  std::uint32_t reload = 0;
  int unsettled_conversions = 0;  ///< begun right after the converter was switched on

  void millisecond_passes() { settled = true; }

 private:
  void convert(std::uint32_t cr2) {
    unsettled_conversions += settled ? 0 : 1;
    if (!converter_answers) {
      return;
    }
    const std::size_t length = 1 + ((adc1.sqr[0].value >> 20) & 0xFU);
    for (std::size_t rank = 0; rank < length; ++rank) {
      adc1.dr.value = channel_values.at((adc1.sqr[2].value >> (5 * rank)) & 0x1FU);
      if (overrun_at == rank) {
        adc1.sr.value |= adc::kSrOverrun;
        requests_stopped = true;
        overrun_at.reset();
      }
      if ((cr2 & adc::kCr2Dma) != 0 && !requests_stopped && (adc1.sr.value & adc::kSrOverrun) == 0) {
        transfer();
      }
    }
  }

  void transfer() {
    auto& stream = dma2.stream[0];
    if ((stream.cr.value & dma::kCrEnable) == 0) {
      return;
    }
    if (transfer_error_next) {
      transfer_error_next = false;
      dma2.isr[0].value |= dma::kTransferError;
      stream.cr.value &= ~dma::kCrEnable;
      return;
    }
    const std::uintptr_t upper = reinterpret_cast<std::uintptr_t>(memory_neighbour) & ~std::uintptr_t{0xFFFF'FFFF};
    auto* memory = reinterpret_cast<FakeRegister*>(upper | stream.m0ar.value);
    memory[reload - stream.ndtr.value].value = adc1.dr.value;
    if (--stream.ndtr.value == 0) {
      dma2.isr[0].value |= dma::kComplete;
      if ((stream.cr.value & dma::kCrCircular) != 0) {
        stream.ndtr.value = reload;
      } else {
        stream.cr.value &= ~dma::kCrEnable;
      }
    }
  }

  bool requests_stopped = false;
  bool settled = false;
};

}  // namespace capstan::stm32f4
