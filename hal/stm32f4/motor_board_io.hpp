// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "capstan/hal/joint_io.hpp"
#include "capstan/hal/stm32f4/adc.hpp"
#include "capstan/hal/stm32f4/gpio.hpp"
#include "capstan/hal/stm32f4/pwm_set_value.hpp"
#include "capstan/hal/stm32f4/quadrature.hpp"

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

/// Divider of the amplifiers' supply at its analogue input.
struct SupplyScale {
  Q24 full_scale_v = Q24::from_int(36);  ///< supply that gives the full range
  [[nodiscard]] constexpr auto voltage(std::uint32_t raw) const -> Q24 {
    return Q24::from_wide(shift_right_rounded<12>(std::int64_t{raw} * full_scale_v.raw()));
  }
};

/// A thermometer of voltage linear in temperature at its analogue input of 3.3 V. Its mean is taken over about a
/// second: what it measures is slower, and one step of the converter is 0.08 K of a sensor of 10 mV/K.
class Thermometer {
 public:
  /// @param uv_per_k  0: there is none   @param uv_at_0c  at 0 degrees C
  constexpr Thermometer(std::int64_t uv_per_k, std::int64_t uv_at_0c)
      : kelvin_per_count_(uv_per_k == 0 ? 0 : (kFullScaleUv << kGainBits) / uv_per_k / (kAdcFullScale + 1)),
        zero_k_(uv_per_k == 0 ? 0 : (uv_at_0c << Q24::kFrac) / uv_per_k) {}

  /// Missing: there is none. Invalid: too near the ends of the range, which is a broken or a shorted wire, or outside
  /// -55 to 125 C.
  constexpr auto rt_read(std::uint32_t raw, Q24& celsius) -> Quality {
    constexpr Q24 kColdest = Q24::from_int(-55);
    constexpr Q24 kHottest = Q24::from_int(125);
    if (kelvin_per_count_ == 0) {
      return Quality::kMissing;
    }
    if (raw < CurrentScale::kMargin || raw > kAdcFullScale - CurrentScale::kMargin) {
      mean_ = 0;
      return Quality::kInvalid;
    }
    const auto now = static_cast<std::int32_t>(raw << kMeanBits);
    mean_ = mean_ == 0 ? now : mean_ + (now - mean_) / kCycles;
    celsius =
        Q24::from_wide(shift_right_rounded<kMeanBits + kGainBits - Q24::kFrac>(mean_ * kelvin_per_count_) - zero_k_);
    return celsius >= kColdest && celsius <= kHottest ? Quality::kOk : Quality::kInvalid;
  }

 private:
  static constexpr std::int32_t kCycles = 1024;  // of the mean
  static constexpr int kMeanBits = 16;
  static constexpr int kGainBits = 32;
  static constexpr std::int64_t kFullScaleUv = 3'300'000;
  std::int64_t kelvin_per_count_;  // 2^-32 K
  std::int64_t zero_k_;            // 0 degrees C above 0 V, 2^-24 K
  std::int32_t mean_ = 0;          // 2^-16 counts; 0: none yet
};

/// One axis' share of the board, all built by the board's main.
template <RegisterCell Cell>
struct AxisHardware {
  QuadratureEncoder<Cell>& encoder;
  PwmSetValue<Cell>& set_value;
  GpioRegisters<Cell>& enable_port;
  Pin enable;
};

/// Where the emergency stop is read: the pins of the break inputs themselves, one for each timer in use.
template <RegisterCell Cell>
struct StopInput {
  const GpioRegisters<Cell>& port;
  Pin pin;
};

/// Joint input and output of the motor board: encoders on timers, currents and supply by the analogue converter, set
/// values by pulse width, one enable line per amplifier, one emergency-stop line that is also both timers' break input.
template <RegisterCell Cell, std::size_t Axes>
class MotorBoardIo {
 public:
  static constexpr std::size_t kAxes = Axes;
  /// Results in this order: the axes' currents, the supply, the thermometer.
  using Analogue = AdcScan<Cell, Axes + 2>;

  struct Scales {
    CurrentScale current;
    SupplyScale supply;
    Thermometer thermometer{0, 0};
  };

  MotorBoardIo(const std::array<AxisHardware<Cell>, Axes>& axes, Analogue& analogue,
               const std::array<StopInput<Cell>, 2>& stop, const Scales& scales) noexcept
      : axes_(axes), analogue_(analogue), stop_(stop), scales_(scales) {}

  [[nodiscard]] auto read(Sensed<Axes>& in) noexcept -> Status {
    analogue_.rt_begin();  // converts while the rest is read
    in = {};
    in.overruns = overruns_;
    for (const StopInput<Cell>& input : stop_) {
      in.estop = in.estop || !pin_is_high(input.port, input.pin);
    }
    Status status = Status::kOk;
    for (std::size_t i = 0; i < Axes; ++i) {
      in.estop = in.estop || axes_[i].set_value.rt_break_seen();
      if (axes_[i].encoder.rt_read(in.axis[i].encoder_counts)) {
        in.axis[i].encoder = Quality::kOk;
      } else {
        status = Status::kTimeout;
      }
    }
    return read_analogue(in) ? status : Status::kTimeout;
  }

  /// kFailed: an output that should be on is held off by the break input.
  [[nodiscard]] auto write(const Drive<Axes>& out) noexcept -> Status {
    Status status = Status::kOk;
    bool any = false;
    for (std::size_t i = 0; i < Axes; ++i) {
      AxisHardware<Cell>& axis = axes_[i];
      any = any || out.axis[i].enabled;
      if (!out.axis[i].enabled) {
        rt_release_axis(axis);
      } else if (axis.set_value.rt_drive(out.axis[i].current_a)) {
        set_pin(axis.enable_port, axis.enable, true);  // last: the amplifier wakes to a set value that is right already
      } else {
        rt_release_axis(axis);
        status = Status::kFailed;
      }
    }
    if (!any) {  // a past break has been reported by read(); the next enabling may try again
      for (AxisHardware<Cell>& axis : axes_) {
        axis.set_value.rt_rearm();
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

  /// The amplifiers' supply in the last snapshot, V; 0 if it was missing. Callable from the background.
  [[nodiscard]] auto supply_v() const noexcept -> Q24 {
    return scales_.supply.voltage(supply_raw_.load(std::memory_order_relaxed));
  }

 private:
  /// False: no result.
  [[nodiscard]] auto read_analogue(Sensed<Axes>& in) noexcept -> bool {
    std::array<std::uint32_t, Axes + 2> raw{};
    if (!analogue_.rt_finish(raw)) {
      supply_raw_.store(0, std::memory_order_relaxed);
      return false;
    }
    const Q24 supply_v = scales_.supply.voltage(raw[Axes]);
    for (std::size_t i = 0; i < Axes; ++i) {
      in.axis[i].supply = Quality::kOk;
      in.axis[i].supply_v = supply_v;
      in.axis[i].current = scales_.current.plausible(raw[i]) ? Quality::kOk : Quality::kInvalid;
      in.axis[i].current_a = scales_.current.current(raw[i]);
    }
    in.temperature = scales_.thermometer.rt_read(raw[Axes + 1], in.temperature_c);
    supply_raw_.store(raw[Axes], std::memory_order_relaxed);
    return true;
  }

  static void rt_release_axis(AxisHardware<Cell>& axis) noexcept {
    set_pin(axis.enable_port, axis.enable, false);
    axis.set_value.rt_release();
  }

  std::array<AxisHardware<Cell>, Axes> axes_;
  Analogue& analogue_;
  std::array<StopInput<Cell>, 2> stop_;
  Scales scales_;
  std::uint32_t overruns_ = 0;
  std::atomic<std::uint32_t> supply_raw_{0};
};
static_assert(JointIo<MotorBoardIo<MemoryRegister, 1>>);
static_assert(JointIo<MotorBoardIo<MemoryRegister, 4>>);

}  // namespace capstan::stm32f4
