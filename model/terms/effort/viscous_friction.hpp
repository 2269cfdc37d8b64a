// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan::effort {

/// Drag in proportion to the speed.
template <typename Scalar>
class ViscousFriction {
 public:
  static constexpr TermInfo<1, 0> kInfo = {
      .name = "viscous_friction",
      .equation = "b q1'",
      .source = "linear damping",
      .confusable_with = "offset and coulomb_friction at one speed, transport_delay",
      .exciting_motion = "constant speeds over a decade, both ways",
      .coefficients = {{{"drag", "Nms/rad", Sign::kNonNegative, "effort per speed"}}},
      .shapes = {},
      .relations = {.doubles = {"coulomb_friction", "offset"}, .shown_by = Motion::kSpeeds},
  };
  static constexpr SteadyState kSteadyState = SteadyState::kEitherWay;
  static constexpr bool kStaysInRange = true;

  constexpr ViscousFriction(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> { return {s.dq1}; }
};

}  // namespace capstan::effort
