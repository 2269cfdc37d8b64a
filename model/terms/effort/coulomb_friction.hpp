// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan::effort {

/// Dry friction, as large at any speed. J is the direction switch with memory, so at rest the friction of the last
/// motion is held: what a joint does that rests in its stiction.
template <typename Scalar>
class CoulombFriction {
 public:
  static constexpr TermInfo<1, 0> kInfo = {
      .name = "coulomb_friction",
      .equation = "F (2J - 1)",
      .source = "Coulomb",
      .confusable_with = "stribeck_friction, play_friction",
      .exciting_motion = "a ladder of speeds, both ways, with a change of load",
      .coefficients = {{{"level", "Nm", Sign::kNonNegative, "effort against any motion"}}},
      .shapes = {},
      .relations = {.doubles = {"stribeck_friction", "play_friction"}, .shown_by = Motion::kSpeeds | Motion::kSmall},
  };
  static constexpr SteadyState kSteadyState = SteadyState::kOfDirection;
  static constexpr bool kStaysInRange = true;

  constexpr CoulombFriction(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> {
    return {s.slide()};
  }
};

}  // namespace capstan::effort
