// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace capstan::tools {

/// What logs told of the pretension of a joint's tendons, each number with half the width of its 95 % interval behind
/// it; 0: not told. A free tip tells the friction torque, the product eta I r1, alone; its parts take a log with the
/// tip held; newtons take the motor pulley's radius, which no log of angles and torques holds.
struct PretensionNumbers {
  enum Place : std::size_t {
    kFriction,
    kFriction95,
    kTorque,
    kTorque95,
    kEta,
    kEta95,
    kRadius,
    kForce,
    kForce95,
    kCount
  };
  static constexpr std::array<const char*, kCount> kNames = {"friction", "friction_95", "torque", "torque_95", "eta",
                                                             "eta_95",   "radius",      "force",  "force_95"};
  static constexpr std::array<const char*, kCount> kUnits = {"Nm", "Nm", "Nm", "Nm", "1", "1", "m", "N", "N"};
  static constexpr double kMost = 1e6;  ///< a machine's tendons may bear more newtons than a board's numbers hold

  std::array<double, kCount> values{};

  [[nodiscard]] auto friction_nm() const -> double { return values[kFriction]; }
  [[nodiscard]] auto friction_95_nm() const -> double { return values[kFriction95]; }
  [[nodiscard]] auto torque_nm() const -> double { return values[kTorque]; }
  [[nodiscard]] auto torque_95_nm() const -> double { return values[kTorque95]; }
  [[nodiscard]] auto eta() const -> double { return values[kEta]; }
  [[nodiscard]] auto eta_95() const -> double { return values[kEta95]; }
  [[nodiscard]] auto radius_m() const -> double { return values[kRadius]; }
  [[nodiscard]] auto force_n() const -> double { return values[kForce]; }
  [[nodiscard]] auto force_95_n() const -> double { return values[kForce95]; }
};

}  // namespace capstan::tools
