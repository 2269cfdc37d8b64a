// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/joint_io.hpp"
#include "hal/stm32f4/adc.hpp"
#include "hal/stm32f4/gpio.hpp"
#include "hal/stm32f4/pwm_set_value.hpp"
#include "hal/stm32f4/quadrature.hpp"

namespace capstan::stm32f4 {

/// Amplifier's current monitor at the analogue input: half of the range is zero, both ends are plus and minus full
/// scale.
struct CurrentScale {
  Q24 full_scale_a = Q24::from_raw(1 << 24);

  static constexpr std::uint32_t kZero = (kAdcFullScale + 1) / 2;
  /// A reading this close to either end is a broken wire or a monitor beyond its range: 0.8 % of the range.
  static constexpr std::uint32_t kMargin = 32;

  [[nodiscard]] constexpr auto plausible(std::uint32_t raw) const -> bool {
    return raw >= kMargin && raw <= kAdcFullScale - kMargin;
  }
  [[nodiscard]] constexpr auto current(std::uint32_t raw) const -> Q24 {
    const std::int64_t offset = std::int64_t{raw} - kZero;
    return Q24::from_wide(shift_right_rounded<11>(offset * full_scale_a.raw()));  // 2^11 counts are full scale
  }
};
static_assert(CurrentScale::kZero == 1U << 11U);

/// One axis' share of the board, all built by the board's main.
template <RegisterCell Cell>
struct AxisHardware {
  QuadratureEncoder<Cell>& encoder;
  PwmSetValue<Cell>& set_value;
  GpioRegisters<Cell>& enable_port;
  Pin enable;
  std::uint32_t current_channel;
  CurrentScale current_scale;
};

/// Joint input and output of the motor board: encoders on timers, currents by the analogue converter, set values by
/// pulse width, one enable line per amplifier, one emergency-stop line that is also the timer's break input.
template <RegisterCell Cell, std::size_t Axes>
class MotorBoardIo {
 public:
  static constexpr std::size_t kAxes = Axes;

  MotorBoardIo(std::array<AxisHardware<Cell>, Axes> axes, Adc<Cell>& adc, const GpioRegisters<Cell>& estop_port,
               const Pin& estop) noexcept
      : axes_(axes), adc_(adc), estop_port_(estop_port), estop_(estop) {}

  [[nodiscard]] auto read(Sensed<Axes>& in) noexcept -> Status {
    in = {};
    in.overruns = overruns_;
    in.estop = !pin_is_high(estop_port_, estop_);
    Status status = Status::kOk;
    for (std::size_t i = 0; i < Axes; ++i) {
      in.estop = in.estop || axes_[i].set_value.rt_break_seen();
      read_axis(axes_[i], in.axis[i]);
      if (in.axis[i].encoder == Quality::kMissing || in.axis[i].current == Quality::kMissing) {
        status = Status::kTimeout;
      }
    }
    return status;
  }

  /// kFailed: an output that should be on is held off by the break input.
  [[nodiscard]] auto write(const Drive<Axes>& out) noexcept -> Status {
    Status status = Status::kOk;
    for (std::size_t i = 0; i < Axes; ++i) {
      AxisHardware<Cell>& axis = axes_[i];
      if (!out.axis[i].enabled) {
        rt_release_axis(axis);
        axis.set_value.rt_rearm();  // a past break has been reported by read(); the next enabling may try again
      } else if (axis.set_value.rt_drive(out.axis[i].current_a)) {
        set_pin(axis.enable_port, axis.enable, true);  // last: the amplifier wakes to a set value that is right already
      } else {
        rt_release_axis(axis);
        status = Status::kFailed;
      }
    }
    return status;
  }

  void release() noexcept {
    for (AxisHardware<Cell>& axis : axes_) {
      rt_release_axis(axis);
    }
  }

  /// Cycles the board skipped or began late since start: handed on in every snapshot.
  void set_overruns(std::uint32_t overruns) noexcept { overruns_ = overruns; }

 private:
  void read_axis(AxisHardware<Cell>& axis, AxisSensed& in) noexcept {
    if (axis.encoder.rt_read(in.encoder_counts)) {
      in.encoder = Quality::kOk;
    }
    std::uint32_t raw = 0;
    if (adc_.rt_convert(axis.current_channel, raw)) {
      in.current = axis.current_scale.plausible(raw) ? Quality::kOk : Quality::kInvalid;
      in.current_a = axis.current_scale.current(raw);
    }
  }

  static void rt_release_axis(AxisHardware<Cell>& axis) noexcept {
    set_pin(axis.enable_port, axis.enable, false);
    axis.set_value.rt_release();
  }

  std::array<AxisHardware<Cell>, Axes> axes_;
  Adc<Cell>& adc_;
  const GpioRegisters<Cell>& estop_port_;
  Pin estop_;
  std::uint32_t overruns_ = 0;
};
static_assert(JointIo<MotorBoardIo<MemoryRegister, 1>>);

}  // namespace capstan::stm32f4
