// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "capstan/tools/response/tuning.hpp"

namespace capstan::tools::test {

inline constexpr double kPi = std::numbers::pi;

/// A motor on a viscous bearing behind `delay` cycles, exactly discretised for a torque that is held: nothing of the
/// product's. The control is written out as the firmware's documentation gives it.
struct Motor {
  double inertia = 2e-5, drag = 2e-4;
  int delay = 1;
  double swing_hz = 0.0;  ///< a mass on a spring beyond the encoder; 0: none

  [[nodiscard]] auto plant(double hz) const -> Complex {
    const Complex back = std::polar(1.0, -2e-3 * kPi * hz);
    const double a = std::exp(-drag / inertia * 1e-3);
    const double b1 = 1e-3 / drag - inertia / (drag * drag) * (1.0 - a);
    const double b2 = inertia / (drag * drag) * (1.0 - a) - 1e-3 / drag * a;
    Complex value = std::pow(back, delay) * (b1 * back + b2 * back * back) / ((1.0 - back) * (1.0 - a * back));
    if (swing_hz > 0.0) {
      const double ratio = hz / swing_hz;
      value *= 1.0 + ratio * ratio / (Complex(1.0 - ratio * ratio, 0.04 * ratio));
    }
    return value;
  }
  [[nodiscard]] static auto control(const LoopGains& gains, double hz) -> Complex {
    const Complex back = std::polar(1.0, -2e-3 * kPi * hz);
    const double share = 0.001 / (gains.rate_time_constant_s + 0.001);
    return gains.stiffness * (1.0 + gains.kp + gains.ki_per_s * 1e-3 / (1.0 - back)) +
           gains.damping * (1.0 - back) * 1e3 * share / (1.0 - (1.0 - share) * back);
  }

  /// As a perfect log would show it.
  [[nodiscard]] auto response(const LoopGains& gains, double circle = 1e-3) const -> Response {
    Response all{.name = "known", .points = {}, .distortion = {}};
    for (double hz = 1.0; hz < 400.0; hz *= 1.12) {
      ResponsePoint point{.hz = hz};
      point.motor = {plant(hz), circle * std::abs(plant(hz))};
      point.joint = {1.0, 0.0};
      point.loop = {plant(hz) * control(gains, hz), circle * std::abs(plant(hz) * control(gains, hz))};
      point.coherence = 1.0;
      all.points.push_back(point);
    }
    return all;
  }

  /// Where a loop of `factor` times all gains ends after 3 s from a small push: growth over the push.
  [[nodiscard]] auto grows(const LoopGains& gains, double factor) const -> bool {
    const double a = std::exp(-drag / inertia * 1e-3);
    const double share = 0.001 / (gains.rate_time_constant_s + 0.001);
    double angle = 1e-3;
    double speed = 0.0;
    double rate = 0.0;
    double before = angle;
    double integral = 0.0;
    std::vector<double> torques(static_cast<std::size_t>(delay), 0.0);
    double early = 0.0;
    double late = 0.0;
    for (int i = 0; i < 3000; ++i) {
      rate += share * ((angle - before) * 1e3 - rate);
      before = angle;
      integral += gains.ki_per_s * 1e-3 * angle;
      torques.push_back(-factor * (gains.stiffness * (angle * (1.0 + gains.kp) + integral) + gains.damping * rate));
      const double torque = torques[torques.size() - 1 - static_cast<std::size_t>(delay)];
      angle += inertia / drag * (1.0 - a) * (speed - torque / drag) + torque / drag * 1e-3;
      speed = a * speed + (1.0 - a) * torque / drag;
      (i < 1500 ? early : late) = std::max(i < 1500 ? early : late, i < 500 ? 0.0 : std::fabs(angle));
    }
    return late > early;
  }
};

/// With which the motor is stable, as one whose log there is.
inline auto gentle() -> LoopGains {
  LoopGains gains;
  gains.stiffness = 0.2;
  gains.damping = 0.003;
  return gains;
}

/// On a grid a thousand times finer than the lines.
inline auto true_margins(const Motor& motor, const LoopGains& gains) -> Margins {
  Margins margins;
  Complex before = motor.plant(1.0) * Motor::control(gains, 1.0);
  for (double hz = 1.0; hz < 400.0; hz *= 1.0002) {
    const Complex now = motor.plant(hz) * Motor::control(gains, hz);
    margins.modulus = std::min(margins.modulus, std::abs(1.0 + now));
    if ((std::abs(before) > 1.0) != (std::abs(now) > 1.0)) {
      margins.crossover_hz = hz;
      margins.phase_deg = std::min(margins.phase_deg, std::fabs(std::arg(-now)) * 180.0 / kPi);
    }
    if (now.real() < 0.0 && (before.imag() < 0.0) != (now.imag() < 0.0)) {
      margins.gain_db = std::min(margins.gain_db, std::fabs(20.0 * std::log10(std::abs(now))));
    }
    before = now;
  }
  return margins;
}

}  // namespace capstan::tools::test
