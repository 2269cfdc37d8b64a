// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

namespace capstan::sim {

/// exp and sin from IEEE additions and multiplications only. The C library's versions differ in the last bit between
/// machines (and, with run-time dispatch, between processors), which would break "bit-identical for a seed".
/// Relative error below 4e-16 for |x| < 100 (exp), absolute error below 4e-16 for |x| < 1e4 (sin).
[[nodiscard]] inline double det_exp(double x) {
  constexpr double kLn2High = 0x1.62e42fefa0000p-1;  // 40 bits, so that n * kLn2High is exact
  constexpr double kLn2Low = 0x1.cf79abc9e3b3ap-40;
  const double n = std::floor(x * (1.0 / std::numbers::ln2) + 0.5);
  const double r = (x - n * kLn2High) - n * kLn2Low;
  double sum = 1.0;
  for (int k = 16; k >= 1; --k)
    sum = 1.0 + sum * r / static_cast<double>(k);
  return std::ldexp(sum, static_cast<int>(n));
}

[[nodiscard]] inline double det_sin(double x) {
  constexpr double kHalfPiHigh = 0x1.921fb54400000p+0;  // 33 bits
  constexpr double kHalfPiMid = 0x1.0b4611a600000p-34;
  constexpr double kHalfPiLow = 0x1.3198a2e037073p-69;
  const double n = std::floor(x * (2.0 / std::numbers::pi) + 0.5);
  const double r = ((x - n * kHalfPiHigh) - n * kHalfPiMid) - n * kHalfPiLow;
  const auto quadrant = static_cast<long long>(n) & 3;
  const bool cosine = (quadrant & 1) != 0;
  const double square = r * r;
  double sum = 1.0;
  for (int k = 9; k >= 1; --k) {
    const int last = cosine ? 2 * k : 2 * k + 1;
    sum = 1.0 - sum * square / static_cast<double>(last * (last - 1));
  }
  const double value = cosine ? sum : r * sum;
  return quadrant >= 2 ? -value : value;
}

[[nodiscard]] inline double det_cos(double x) {
  return det_sin(x + std::numbers::pi / 2.0);
}

}  // namespace capstan::sim
