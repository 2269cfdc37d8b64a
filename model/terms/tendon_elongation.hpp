// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan {

/// The pulled tendon stretches by what friction leaves of the motor torque along it, and the joint lags by as much:
///   J a_t tau + (1 - J) a_b tau,  a = -(1 - e^-eta) / (r1 r2 eta Kn)                                  (5.28)
/// The thesis prints a1 with e^+eta in (5.26); integrating (5.24) gives the form above, and every identified value is
/// negative.
template <typename Scalar>
class TendonElongation {
 public:
  static constexpr TermInfo<2, 0> kInfo = {
      .name = "tendon_elongation",
      .equation = "J a_t tau + (1 - J) a_b tau",
      .source = "(5.28)",
      .confusable_with = "play, where the torque hardly varies",
      .exciting_motion = "reversals at several amplitudes and loads",
      .coefficients =
          {{{"top", "rad/Nm", Sign::kNonPositive, "elongation per torque while the top tendon is pulled, a_t"},
            {"bottom", "rad/Nm", Sign::kNonPositive, "elongation per torque while the bottom tendon is pulled, a_b"}}},
      .shapes = {},
      .relations = {.doubles = {"play", "hysteresis"}, .shown_by = Motion::kLoops},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kOfDirection;
  static constexpr bool kStaysInRange = true;

  constexpr TendonElongation(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> ByDirection<Scalar> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> ByDirection<Scalar> {
    return {.value = s.tau, .forward = s.forward};
  }
};

}  // namespace capstan
