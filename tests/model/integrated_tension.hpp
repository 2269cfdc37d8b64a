// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace capstan::test {

/// Tension along a tendon by steps of Runge and Kutta through dT/dphi = -eta T s (2.4), less the viscous drag b L v of
/// the whole tendon (6.17), and the integral of it by Simpson on the same steps: no exponential anywhere.
struct Integrated {
  double end_tension;
  double area;
};
inline auto integrate(double eta, double s, double tension, double to = 1.0, double drag_n = 0.0) -> Integrated {
  constexpr int kSteps = 4000;
  const double h = to / kSteps;
  const double rate = -eta * s;
  auto step = [rate, drag_n](double t, double dphi) {
    const double k1 = rate * t - drag_n;
    const double k2 = rate * (t + 0.5 * dphi * k1) - drag_n;
    const double k3 = rate * (t + 0.5 * dphi * k2) - drag_n;
    const double k4 = rate * (t + dphi * k3) - drag_n;
    return t + dphi * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
  };
  double area = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double middle = step(tension, 0.5 * h);
    const double next = step(tension, h);
    area += h * (tension + 4.0 * middle + next) / 6.0;
    tension = next;
  }
  return {tension, area};
}

}  // namespace capstan::test
