// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/reciprocal.hpp"
#include "capstan/model/term.hpp"

namespace capstan {

/// A rope gets stiffer as its strands settle: the elongation grows less than the torque,
///   (J h_t + (1 - J) h_b) tau |tau| min(1, |tau|/T)
/// the first corrections that are odd in the torque: the square where T is below every torque, the cube where it is
/// above. h >= 0 takes back a part of a tau, a <= 0.
template <typename Scalar>
class StiffnessHardening {
 public:
  static constexpr TermInfo<2, 1> kInfo = {
      .name = "stiffness_hardening",
      .equation = "(J h_t + (1 - J) h_b) tau |tau| min(1, |tau|/T)",
      .source = "next orders of (5.28) in the torque; thesis 3 takes the tendon's stiffness as constant",
      .confusable_with = "gravity on one sine, tendon_elongation where all loads are alike",
      .exciting_motion = "a ladder of amplitudes under loads that do not depend on the angle",
      .coefficients = {{{"top", "rad/Nm2", Sign::kNonNegative, "while the top tendon is pulled, h_t"},
                        {"bottom", "rad/Nm2", Sign::kNonNegative, "while the bottom tendon is pulled, h_b"}}},
      .shapes = {{{"torque", "Nm", 1e-6, 20.0, 0.002, "T: below it with the cube of the torque, above with the square",
                   ShapeScale::kRatio, ShapeOf::kTorqueRange}}},
      .relations = {.doubles = {"gravity", "tendon_elongation"},
                    .builds_on = {"tendon_elongation"},
                    .shown_by = Motion::kSpeeds | Motion::kLoops,
                    .open_shapes = true},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kOfDirection;

  constexpr StiffnessHardening(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 1>& shape)
      : torque_(shape[0]), share_of_torque_(shape[0]) {}
  constexpr auto update(const Sample<Scalar>& s) -> ByDirection<Scalar> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> ByDirection<Scalar> {
    const Scalar size = abs(s.tau);
    // In this order only the result may leave the range of fixed point, and nothing on the way to it.
    const Scalar shared = size < torque_ ? Traits::part(s.tau, Traits::share_of(size * share_of_torque_)) : s.tau;
    return {.value = shared * size, .forward = s.forward};
  }

 private:
  using Traits = ScalarTraits<Scalar>;
  Scalar torque_;                       ///< T
  Reciprocal<Scalar> share_of_torque_;  ///< of T
};

}  // namespace capstan
