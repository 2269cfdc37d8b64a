// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/term.hpp"

namespace capstan {

/// The rigid transmission: the joint follows the motor by the ratio of the pulley radii.
template <typename Scalar>
class MotorAngle {
 public:
  static constexpr TermInfo<1, 0> kInfo = {
      .name = "motor_angle",
      .equation = "beta q1",
      .source = "(1.22), (5.28)",
      .confusable_with = "",
      .exciting_motion = "any motion",
      .coefficients = {{{"beta", "1", Sign::kAny, "joint angle per motor angle, r1/r2"}}},
      .shapes = {},
  };

  static constexpr bool kStaysInRange = true;

  constexpr MotorAngle(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return settled(s); }
  [[nodiscard]] constexpr auto settled(const Sample<Scalar>& s) const -> std::array<Scalar, 1> { return {s.q1}; }
};

}  // namespace capstan
