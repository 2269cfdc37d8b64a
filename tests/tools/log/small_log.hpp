// SPDX-License-Identifier: Apache-2.0
// A joint of two sines, its friction smooth in speed, with a little noise.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>

namespace capstan::tools::test {

using Eigen::Index;
using Eigen::VectorXd;

inline constexpr Index kRows = 4000;
inline constexpr double kPeriod = 0.005;

inline auto signal(double (*of)(double)) -> VectorXd {
  VectorXd x(kRows);
  std::uint32_t noise = 1;
  for (Index i = 0; i < kRows; ++i) {
    noise = noise * 1664525U + 1013904223U;
    x[i] = of(kPeriod * static_cast<double>(i)) + 1e-4 * (static_cast<double>(noise >> 8U) / 16777216.0 - 0.5);
  }
  return x;
}

inline auto motor(double t) -> double {
  return 0.8 * std::sin(1.3 * t) + 0.3 * std::sin(4.1 * t + 1.0);
}
inline auto torque(double t) -> double {
  const double speed = 1.04 * std::cos(1.3 * t) + 1.23 * std::cos(4.1 * t + 1.0);
  return 0.4 * motor(t) + 0.2 * std::tanh(20.0 * speed) + 0.05;
}
inline auto joint(double t) -> double {
  return 0.7 * motor(t) - 0.05 * torque(t);
}

struct Log {
  VectorXd q1 = signal(motor), tau = signal(torque), q2 = signal(joint);
};

/// The same so many rows later.
inline auto held_back(const VectorXd& x, Index rows) -> VectorXd {
  VectorXd late = x;
  late.tail(x.size() - rows) = x.head(x.size() - rows);
  return late;
}

}  // namespace capstan::tools::test
