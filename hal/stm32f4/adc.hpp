// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "hal/stm32f4/adc_registers.hpp"

namespace capstan::stm32f4 {

inline constexpr std::uint32_t kAdcFullScale = 4095;  ///< 12 bits

/// One channel of the analogue converter at a time, started by software and waited for: a conversion takes 12 + 28
/// clocks of 21 MHz, 1.9 us.
template <RegisterCell Cell>
class Adc {
 public:
  Adc(AdcRegisters<Cell>& registers, AdcCommonRegisters<Cell>& common) noexcept
      : registers_(registers), common_(common) {}

  void start() noexcept {
    modify(common_.ccr, adc::kCcrClockMask, adc::kCcrClockDiv4);
    registers_.cr1.write(0);
    registers_.cr2.write(adc::kCr2EachConversion | adc::kCr2On);
    registers_.sqr[0].write(0);  // a sequence of one
  }

  /// Converts channel 0 to 18. False: no result within the bound, or it was overrun; `raw` is unchanged.
  [[nodiscard]] auto rt_convert(std::uint32_t channel, std::uint32_t& raw) noexcept -> bool {
    const std::uint32_t shift = 3 * (channel % 10);
    modify(registers_.smpr[channel >= 10 ? 0 : 1], 7U << shift, adc::kSample28Cycles << shift);
    registers_.sqr[2].write(channel);
    registers_.sr.write(0);  // its flags are cleared by writing 0
    set_bits(registers_.cr2, adc::kCr2Start);
    if (!wait_for(registers_.sr, adc::kSrEndOfConversion, adc::kSrEndOfConversion, kPolls)) {
      return false;
    }
    const bool overrun = (registers_.sr.read() & adc::kSrOverrun) != 0;
    const std::uint32_t value = registers_.dr.read();
    if (overrun || value > kAdcFullScale) {
      return false;
    }
    raw = value;
    return true;
  }

 private:
  /// Five times the conversion's 320 core cycles at 168 MHz, with at least 8 cycles a poll.
  static constexpr std::uint32_t kPolls = 200;

  AdcRegisters<Cell>& registers_;
  AdcCommonRegisters<Cell>& common_;
};

}  // namespace capstan::stm32f4
