// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan {

/// Moderate pretension: the tension that the last stroke left in the tendons still shows in this one,
///   J a'_t tau0 + (1 - J) a'_b tau0,  tau0 the torque where the motor turned                           (A.16)
/// From (A.15) a' = c d / (r1 r2 (c + d)), positive, in rad per N m. Since c and d are b and a of the other direction,
/// a'(forward) is -a(backward): with those very values the memory of one stroke cancels against the elongation at the
/// end of the last, and (5.28) is left. The coefficients are free, because the front rarely reaches the joint.
template <typename Scalar>
class ReversalMemory {
 public:
  static constexpr TermInfo<2, 0> kInfo = {
      .name = "reversal_memory",
      .equation = "J a'_t tau0 + (1 - J) a'_b tau0, tau0 the torque at the last reversal",
      .source = "(A.15), (A.16)",
      .confusable_with = "pretension_offset where all reversals have one torque, slip_propagation, gravity",
      .exciting_motion = "nested loops with at least four different torques at reversal, of both signs",
      .coefficients = {{{"top", "rad/Nm", Sign::kNonNegative, "memory while the top tendon is pulled, a'_t"},
                        {"bottom", "rad/Nm", Sign::kNonNegative, "memory while the bottom tendon is pulled, a'_b"}}},
      .shapes = {},
      .relations = {.doubles = {"pretension_offset", "slip_propagation", "gravity"},
                    .builds_on = {"tendon_elongation"},
                    .shown_by = Motion::kLoops},
  };

  constexpr ReversalMemory(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> ByDirection<Scalar> { return steady_state(s); }
  /// The torque of the reversal behind a motion is the caller's to say: `tau_reversal`.
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> ByDirection<Scalar> {
    return {.value = s.tau_reversal, .forward = s.forward};
  }
};

}  // namespace capstan
