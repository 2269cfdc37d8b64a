// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "hal/stm32f4/timer_registers.hpp"

namespace capstan::stm32f4 {

/// Incremental encoder on a 32-bit timer (TIM2, TIM5). The counter runs over all 2^32 counts, so its difference modulo
/// 2^32 is the motion and no interrupt is needed.
template <RegisterCell Cell>
class QuadratureEncoder {
 public:
  explicit QuadratureEncoder(TimerRegisters<Cell>& registers) noexcept : registers_(registers) {}

  /// `filter` is the timer's input filter code 0 to 15 (RM0090 section 18.4.7): an edge counts after that many equal
  /// samples. `inverted` turns the counting direction round. False: the counter did not take over its settings (clock
  /// off, or not there), and read() will say so.
  [[nodiscard]] auto start(std::uint32_t filter, bool inverted) noexcept -> bool {
    registers_.cr1.write(0);
    registers_.smcr.write(timer::kSmcrQuadrature);
    registers_.ccmr[0].write(timer::kCcmrInputs | (filter << timer::kCcmrFilter1Shift) |
                             (filter << timer::kCcmrFilter2Shift));
    registers_.ccer.write(inverted ? timer::kCcerInvert1 : 0);
    registers_.psc.write(0);
    registers_.arr.write(0xFFFF'FFFFU);
    registers_.cnt.write(0);
    registers_.cr1.write(timer::kCr1Enable);
    return runs();
  }

  /// Counts since start, modulo 2^32. False: the timer is not counting edges, and `counts` is unchanged.
  [[nodiscard]] auto rt_read(std::int32_t& counts) const noexcept -> bool {
    if (!runs()) {
      return false;
    }
    counts = static_cast<std::int32_t>(registers_.cnt.read());
    return true;
  }

 private:
  /// A register that lost its setting (a glitch, a clock that was switched off) must not pass for a joint at rest.
  [[nodiscard]] auto runs() const noexcept -> bool {
    return (registers_.cr1.read() & timer::kCr1Enable) != 0 && registers_.smcr.read() == timer::kSmcrQuadrature;
  }

  TimerRegisters<Cell>& registers_;
};

}  // namespace capstan::stm32f4
