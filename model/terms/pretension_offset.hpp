// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan {

/// Large constant pretension: a constant per direction, J g_t Lambda + (1 - J) g_b Lambda                 (5.30, 7.5)
/// Together with joint_offset only the contrast can be seen, so there is one regressor, 2J - 1. Its coefficient is
/// (g_t - g_b) Lambda / 2.
///
/// Sign, by regime. While the pushed tendon goes slack under the load, (5.33)-(5.38) with a < b while the top is pulled
/// and a > b otherwise make it positive: pretension narrows the loop (Fig. 7.6), by 1 / (2 K r2) per newton up to
/// I = F (e^eta - 1) / eta. While both stay taut all further pretension is friction: each tendon's tension falls from
/// T to T e^-eta along the way, the difference of the two directions is a torque that never reaches the joint, and in
/// place of narrowing the loop widens: c = -I tanh(eta / 2) / (2 K r2), in a play's half width
/// I tanh(eta / 2) / (2 K r2 beta).
template <typename Scalar>
class PretensionOffset {
 public:
  static constexpr TermInfo<1, 0> kInfo = {
      .name = "pretension_offset",
      .equation = "(2J - 1) c",
      .source = "(5.30), (5.33)-(5.38)",
      .confusable_with = "tendon_elongation where all reversals have one torque",
      .exciting_motion = "nested loops with at least four different torques at reversal, of both signs",
      .coefficients = {{{"contrast", "rad", Sign::kAny, "half the difference of the two directions' offsets",
                         Sign::kNonNegative,
                         "both tendons stay taut under this load, so pretension only adds friction and widens the "
                         "loop"}}},
      .shapes = {},
      .relations = {.doubles = {"tendon_elongation"}, .shown_by = Motion::kLoops},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kOfDirection;
  static constexpr bool kStaysInRange = true;

  constexpr PretensionOffset(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> {
    constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);  // constant: the target converts no double at run time
    return {s.forward ? kOne : -kOne};
  }
};

}  // namespace capstan
