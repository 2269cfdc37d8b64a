// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan {

/// The rigid transmission: the joint follows the motor by the ratio of the pulley radii; where there is hysteresis in
/// front of the ratio, what that leaves of the motor angle, h.
template <typename Scalar>
class MotorAngle {
 public:
  static constexpr TermInfo<1, 0> kInfo = {
      .name = "motor_angle",
      .equation = "beta h, h = q1 without hysteresis in front",
      .source = "(1.22), (5.28)",
      .confusable_with = "",
      .exciting_motion = "any motion",
      .coefficients = {{{"beta", "1", Sign::kAny, "joint angle per motor angle, r1/r2"}}},
      .shapes = {},
  };

  static constexpr bool kStaysInRange = true;  // h that met an end is the sample's own flag
  static constexpr bool kReadsInput = true;

  constexpr MotorAngle(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> { return {s.h}; }
};

}  // namespace capstan
