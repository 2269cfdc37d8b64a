// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace capstan::tools {

/// What the motor's torque is made of while both tendons slide and the joint follows. With s the direction of motion,
///   tau = f s + c + b q1' + m q1'' + (sine + s odd_sine) sin q2 + (cosine + s odd_cosine) (1 - cos q2)
/// Tendons that stay taut pass what the joint takes on to the motor one to one, times beta (5.35): so a weight is in
/// the parts that do not turn with s, friction that hangs on the place in those that do, a mass in m, drag in b.
struct TorqueParts {
  static constexpr std::size_t kCount = 8;
  static constexpr std::array<const char*, kCount> kNames = {"friction", "offset", "viscous",  "inertia",
                                                             "sine",     "cosine", "odd_sine", "odd_cosine"};
  static constexpr std::array<const char*, kCount> kUnits = {"Nm", "Nm", "Nms/rad", "kgm2", "Nm", "Nm", "Nm", "Nm"};
  std::array<double, kCount> values{};

  [[nodiscard]] auto friction() const -> double { return values[0]; }
  [[nodiscard]] auto viscous() const -> double { return values[2]; }  ///< Nms/rad
};

}  // namespace capstan::tools
