// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "capstan/hal/stm32f4/timer_registers.hpp"
#include "capstan/model/fixed.hpp"

namespace capstan::stm32f4 {

/// Set value for a servo amplifier as a pulse width: 50 % is zero, 10 % and 90 % are minus and plus full scale.
/// Anything outside 10 to 90 %, a line that stays low included, is not a set value at all, so a broken wire commands
/// nothing.
struct PwmScale {
  std::uint32_t period = 2;                   ///< timer counts
  Q24 full_scale_a = Q24::from_raw(1 << 24);  ///< current the amplifier gives at 90 %, more than 0

  /// Compare value for a current, saturated at the ends of the scale: 0.5 period + 0.4 period * current / full scale.
  [[nodiscard]] constexpr auto compare(Q24 current_a) const -> std::uint32_t {
    const Q24 limited =
        current_a > full_scale_a ? full_scale_a : (current_a < -full_scale_a ? -full_scale_a : current_a);
    const std::int64_t span = std::int64_t{period} * 2 * limited.raw();
    const std::int64_t unit = std::int64_t{full_scale_a.raw()} * 5;
    const std::int64_t shift = (span + (span < 0 ? -unit / 2 : unit / 2)) / unit;  // to nearest
    return static_cast<std::uint32_t>(std::int64_t{period / 2} + shift);
  }
};

/// One output channel of an advanced timer (TIM1, TIM8) whose break input cuts all of its outputs in hardware, without
/// the core. A break is latched by the timer: however short it was, the outputs stay off until rt_rearm(). Channels of
/// one timer share its break and its main output, which goes off with the last of them.
template <RegisterCell Cell>
class PwmSetValue {
 public:
  /// `channel` counts from 0.
  PwmSetValue(TimerRegisters<Cell>& registers, std::uint32_t channel) noexcept
      : registers_(registers), channel_(channel) {}

  /// Starts with the output off; channels of one timer one after the other, and with the same period. The break input
  /// is active low: an open wire is an emergency stop.
  void start(const PwmScale& scale) noexcept {
    scale_ = scale;
    registers_.cr1.write(0);
    registers_.bdtr.write(timer::kBdtrIdleDriven | timer::kBdtrBreakEnable);
    registers_.psc.write(0);
    registers_.arr.write(scale_.period - 1);
    registers_.ccr[channel_].write(scale_.compare(Q24{}));
    const std::uint32_t shift = 8 * (channel_ % 2);
    modify(registers_.ccmr[channel_ / 2], 0xFFU << shift, timer::kCcmrPwm << shift);
    clear_bits(registers_.ccer, output_bit());
    registers_.egr.write(timer::kEgrUpdate);  // takes the preloaded values over before the first period
    registers_.cr1.write(timer::kCr1PreloadReload | timer::kCr1Enable);
  }

  /// Sets the current and switches the output on. False: a break has it off.
  [[nodiscard]] auto rt_drive(Q24 current_a) noexcept -> bool {
    registers_.ccr[channel_].write(scale_.compare(current_a));
    if (rt_break_seen()) {
      return false;
    }
    set_bits(registers_.ccer, output_bit());
    // Written only when it is off: a read-modify-write every cycle could undo a break that fell between its two halves.
    if ((registers_.bdtr.read() & timer::kBdtrMainOutput) == 0) {
      set_bits(registers_.bdtr, timer::kBdtrMainOutput);
    }
    return (registers_.bdtr.read() & timer::kBdtrMainOutput) != 0;
  }

  /// Output off, then the set value back to zero. Legal at any time, from any interrupt.
  void rt_release() noexcept {
    clear_bits(registers_.ccer, output_bit());
    if ((registers_.ccer.read() & timer::kCcerOutputs) == 0) {
      clear_bits(registers_.bdtr, timer::kBdtrMainOutput);
    }
    registers_.ccr[channel_].write(scale_.compare(Q24{}));
  }

  /// Forgets a past break of the timer. While the input is still active the flag comes straight back.
  void rt_rearm() noexcept { registers_.sr.write(~timer::kSrBreak); }

  [[nodiscard]] auto rt_break_seen() const noexcept -> bool { return (registers_.sr.read() & timer::kSrBreak) != 0; }

 private:
  [[nodiscard]] auto output_bit() const noexcept -> std::uint32_t { return 1U << (4 * channel_); }

  TimerRegisters<Cell>& registers_;
  std::uint32_t channel_;
  PwmScale scale_;
};

}  // namespace capstan::stm32f4
