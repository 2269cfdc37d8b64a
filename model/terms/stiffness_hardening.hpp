// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/term.hpp"

namespace capstan {

/// A rope gets stiffer as its strands settle: the elongation grows less than the torque,
///   J h_t tau |tau| + (1 - J) h_b tau |tau|
/// the first correction that is odd in the torque. h >= 0 takes back a part of a tau, a <= 0.
template <typename Scalar>
class StiffnessHardening {
 public:
  static constexpr TermInfo<2, 0> kInfo = {
      .name = "stiffness_hardening",
      .equation = "J h_t tau |tau| + (1 - J) h_b tau |tau|",
      .source = "next order of (5.28) in the torque; thesis 3 takes the tendon's stiffness as constant",
      .confusable_with = "gravity on one sine, tendon_elongation where all loads are alike",
      .exciting_motion = "a ladder of amplitudes under loads that do not depend on the angle",
      .coefficients = {{{"top", "rad/Nm2", Sign::kNonNegative, "while the top tendon is pulled, h_t"},
                        {"bottom", "rad/Nm2", Sign::kNonNegative, "while the bottom tendon is pulled, h_b"}}},
      .shapes = {},
  };

  constexpr StiffnessHardening(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> ByDirection<Scalar> { return settled(s); }
  [[nodiscard]] constexpr auto settled(const Sample<Scalar>& s) const -> ByDirection<Scalar> {
    return {.value = s.tau * abs(s.tau), .forward = s.forward};
  }
};

}  // namespace capstan
