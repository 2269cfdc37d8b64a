// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan::effort {

/// A constant effort. Its namesake for the joint angle is joint_offset.
template <typename Scalar>
class Offset {
 public:
  static constexpr TermInfo<1, 0> kInfo = {
      .name = "offset",
      .equation = "offset",
      .source = "bias of the effort sensor, a constant load",
      .confusable_with = "gravity, friction_asymmetry",
      .exciting_motion = "rest in a known pose, motion both ways",
      .coefficients = {{{"offset", "Nm", Sign::kAny, "effort at rest without friction"}}},
      .shapes = {},
      .relations = {.doubles = {"gravity", "friction_asymmetry"}},
  };
  static constexpr SteadyState kSteadyState = SteadyState::kEitherWay;
  static constexpr bool kStaysInRange = true;

  constexpr Offset(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& /*s*/) const -> std::array<Scalar, 1> {
    constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);  // constant: the target converts no double at run time
    return {kOne};
  }
};

}  // namespace capstan::effort
