// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan::effort {

/// The mass that is moved. Acceleration counts in krad/s2 (see Sample), so the coefficient is in 1e-3 kg m2; for a
/// linear axis in 1e-3 kg.
template <typename Scalar>
class Inertia {
 public:
  static constexpr TermInfo<1, 0> kInfo = {
      .name = "inertia",
      .equation = "I q1''",
      .source = "Newton",
      .confusable_with = "transport_delay, stiffness on one sine",
      .exciting_motion = "a chirp or multisine over a decade",
      .coefficients = {{{"inertia", "Nms2/krad", Sign::kNonNegative, "effort per acceleration; 1 is 1e-3 kg m2"}}},
      .shapes = {},
      .relations = {.doubles = {"transport_delay"}, .shown_by = Motion::kFast},
  };
  static constexpr SteadyState kSteadyState = SteadyState::kEitherWay;
  static constexpr bool kStaysInRange = true;

  constexpr Inertia(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> { return {s.ddq1}; }
};

}  // namespace capstan::effort
