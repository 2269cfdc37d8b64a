// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/term.hpp"

namespace capstan {

/// Viscous drag along the tendons: a lag in proportion to speed, one coefficient per pulled tendon.
/// (6.21) writes J g_t v + (1 - J) g_b v with v = (r1 q1' + r2 q2')/2. With q2' = (r1/r2) q1' to first order v = r1
/// q1', so the coefficients here are g r1, in seconds.
template <typename Scalar>
class TransmissionViscous {
 public:
  static constexpr TermInfo<2, 0> kInfo = {
      .name = "transmission_viscous",
      .equation = "J g_t r1 q1' + (1 - J) g_b r1 q1'",
      .source = "(6.17)-(6.21)",
      .confusable_with = "transport_delay, viscoelastic_creep at one frequency",
      .exciting_motion =
          "the same path at three speeds over a decade; fast reversals, where a delay also shifts the torque",
      .coefficients = {{{"top", "s", Sign::kNonPositive, "lag per motor speed while the top tendon is pulled, g_t r1"},
                        {"bottom", "s", Sign::kNonPositive,
                         "lag per motor speed while the bottom tendon is pulled, g_b r1"}}},
      .shapes = {},
  };

  static constexpr bool kStaysInRange = true;

  constexpr TransmissionViscous(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> ByDirection<Scalar> { return settled(s); }
  [[nodiscard]] constexpr auto settled(const Sample<Scalar>& s) const -> ByDirection<Scalar> {
    return {.value = s.dq1, .forward = s.forward};
  }
};

}  // namespace capstan
