// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/term.hpp"

namespace capstan {

/// Large constant pretension: a constant per direction, J g_t Lambda + (1 - J) g_b Lambda                 (5.30, 7.5)
/// Together with joint_offset only the contrast can be seen, so there is one regressor, 2J - 1. Its coefficient is
/// (g_t - g_b) Lambda / 2. From (5.33)-(5.38), with a < b while the top is pulled and a > b otherwise, it is positive:
/// pretension narrows the loop (Fig. 7.6).
template <typename Scalar>
class PretensionOffset {
 public:
  static constexpr TermInfo<1, 0> kInfo = {
      .name = "pretension_offset",
      .equation = "(2J - 1) c",
      .source = "(5.30), (5.33)-(5.38)",
      .confusable_with = "tendon_elongation where all reversals have one torque",
      .exciting_motion = "nested loops with at least four different torques at reversal, of both signs",
      .coefficients = {{{"contrast", "rad", Sign::kNonNegative, "half the difference of the two directions' offsets"}}},
      .shapes = {},
  };

  static constexpr bool kStaysInRange = true;

  constexpr PretensionOffset(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return settled(s); }
  [[nodiscard]] constexpr auto settled(const Sample<Scalar>& s) const -> std::array<Scalar, 1> {
    constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);  // constant: the target converts no double at run time
    return {s.forward ? kOne : -kOne};
  }
};

}  // namespace capstan
