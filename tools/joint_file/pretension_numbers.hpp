// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace capstan::tools {

/// What logs told of the pretension of a joint's tendons, each number with half the width of its 95 % interval behind
/// it; 0: not told. A free tip tells the friction torque, the product eta I r1, alone; its parts take a log with the
/// tip held; newtons take the motor pulley's radius, which no log of angles and torques holds.
struct PretensionNumbers {
  static constexpr std::size_t kCount = 9;
  static constexpr std::array<const char*, kCount> kNames = {"friction", "friction_95", "torque", "torque_95", "eta",
                                                             "eta_95",   "radius",      "force",  "force_95"};
  static constexpr std::array<const char*, kCount> kUnits = {"Nm", "Nm", "Nm", "Nm", "1", "1", "m", "N", "N"};
  static constexpr double kMost = 1e6;  ///< a machine's tendons may bear more newtons than a board's numbers hold

  std::array<double, kCount> values{};

  [[nodiscard]] auto friction_nm() const -> double { return values[0]; }
  [[nodiscard]] auto friction_95_nm() const -> double { return values[1]; }
  [[nodiscard]] auto torque_nm() const -> double { return values[2]; }
  [[nodiscard]] auto torque_95_nm() const -> double { return values[3]; }
  [[nodiscard]] auto eta() const -> double { return values[4]; }
  [[nodiscard]] auto eta_95() const -> double { return values[5]; }
  [[nodiscard]] auto radius_m() const -> double { return values[6]; }
  [[nodiscard]] auto force_n() const -> double { return values[7]; }
  [[nodiscard]] auto force_95_n() const -> double { return values[8]; }
};

}  // namespace capstan::tools
