// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace capstan::tools {

/// How far the joint may be from a law's estimate where its logs have been: the parameters `error_bar` of a board.
struct ErrorBarNumbers {
  static constexpr std::size_t kCount = 6;
  static constexpr std::array<const char*, kCount> kNames = {"steady", "turning", "turn", "from", "to", "torque"};
  static constexpr std::array<const char*, kCount> kUnits = {"rad", "rad", "rad", "rad", "rad", "Nm"};

  /// In their order: what 95 of 100 samples kept within; the same of those nearer to a reversal than `turn` of the
  /// motor; the motor angles of the logs, and their largest motor torque.
  std::array<double, kCount> values{};

  [[nodiscard]] auto steady_rad() const -> double { return values[0]; }
  [[nodiscard]] auto turning_rad() const -> double { return values[1]; }
};

}  // namespace capstan::tools
