// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan {

/// The joint angle where the motor angle is zero: the law's integration constant, since (5.28) is in differences.
template <typename Scalar>
class JointOffset {
 public:
  static constexpr TermInfo<1, 0> kInfo = {
      .name = "joint_offset",
      .equation = "offset",
      .source = "(5.28), constant of integration",
      .confusable_with = "gravity, thermal_drift",
      .exciting_motion = "any motion from a known pose",
      .coefficients = {{{"offset", "rad", Sign::kAny, "joint angle at motor angle zero"}}},
      .shapes = {},
      .relations = {.doubles = {"gravity", "thermal_drift"}},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kEitherWay;
  static constexpr bool kStaysInRange = true;

  constexpr JointOffset(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& /*s*/) const -> std::array<Scalar, 1> {
    constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);  // constant: the target converts no double at run time
    return {kOne};
  }
};

}  // namespace capstan
