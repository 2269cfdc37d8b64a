// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/exponential.hpp"
#include "capstan/model/reciprocal.hpp"
#include "capstan/model/term.hpp"

namespace capstan::effort {

/// Friction that is larger at low speed, where the lubricant does not carry yet: the excess over coulomb_friction,
///   F_s (2J - 1) e^-(q1'/v_s)^2
template <typename Scalar>
class StribeckFriction {
 public:
  static constexpr TermInfo<1, 1> kInfo = {
      .name = "stribeck_friction",
      .equation = "F_s (2J - 1) exp(-(q1'/v_s)^2)",
      .source = "Stribeck, with the Gaussian of Armstrong-Helouvry",
      .confusable_with = "coulomb_friction, play_friction",
      .exciting_motion = "six constant speeds or more, from v_s/10 to 10 v_s, both ways",
      .coefficients = {{{"excess", "Nm", Sign::kNonNegative, "static friction beyond that of fast motion"}}},
      .shapes = {{{"speed", "rad/s", 1e-5, 60.0, 0.1, "v_s: speed at which 37 % of the excess are left",
                   ShapeScale::kRatio, ShapeOf::kMotorSpeed}}},
      .relations = {.doubles = {"coulomb_friction", "play_friction"},
                    .builds_on = {"coulomb_friction", "play_friction"},
                    .shown_by = Motion::kSpeeds | Motion::kSmall},
  };
  static constexpr bool kStaysInRange = true;

  constexpr StribeckFriction(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 1>& shape)
      : speed_(shape[0]), per_speed_(shape[0]) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> {
    return directed(s, undirected(s));
  }
  /// What is left of the excess at this speed.
  [[nodiscard]] constexpr auto undirected(const Sample<Scalar>& s) const -> Scalar {
    return speed_ > Scalar{} ? bell(s.dq1 * per_speed_) : Scalar{};
  }
  [[nodiscard]] constexpr auto directed(const Sample<Scalar>& s, Scalar left) const -> std::array<Scalar, 1> {
    return {ScalarTraits<Scalar>::part(left, ScalarTraits<Scalar>::share_of(s.slide()))};
  }

 private:
  Scalar speed_;
  Reciprocal<Scalar> per_speed_;
};

}  // namespace capstan::effort
