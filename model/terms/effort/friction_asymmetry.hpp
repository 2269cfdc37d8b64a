// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan::effort {

/// What the way forward has in friction beyond the way back.
template <typename Scalar>
class FrictionAsymmetry {
 public:
  static constexpr TermInfo<2, 0> kInfo = {
      .name = "friction_asymmetry",
      .equation = "J dF + J db q1'",
      .source = "Coulomb and viscous friction, each with its own value per direction",
      .confusable_with = "offset: once coulomb_friction is in the law, J and 1 are one column while the joint moves",
      .exciting_motion = "constant speeds over a decade, both ways",
      .coefficients = {{{"level", "Nm", Sign::kAny, "dry friction forward beyond that backward"},
                        {"drag", "Nms/rad", Sign::kAny, "drag forward beyond that backward"}}},
      .shapes = {},
      .relations = {.doubles = {"offset"},
                    .builds_on = {"coulomb_friction", "play_friction"},
                    .special_cases_of_effort = {"offset"},
                    .shown_by = Motion::kSpeeds},
  };
  static constexpr bool kStaysInRange = true;

  constexpr FrictionAsymmetry(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 2> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 2> {
    constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);  // constant: the target converts no double at run time
    return {ScalarTraits<Scalar>::template shifted_down<1>(kOne + s.slide()), s.forward ? s.dq1 : Scalar{}};
  }
};

}  // namespace capstan::effort
