// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan {

/// Tendons that pass another joint are moved and stretched with it: a row of Theta = B Q + A S tau outside the
/// diagonal,                                                                                       (6.8)
///   b q1o + J_o a_t tau_o + (1 - J_o) a_b tau_o,  o the other axis.
/// In the da Vinci wrist the grasps have it from the pitch, one way: b of (6.14), a = K times the pitch's pair (6.16).
/// One term for each slot of the coupling, so that three of them are a whole row for four axes.
template <typename Scalar, std::size_t Slot>
class AxisCouplingOf {
 public:
  static_assert(Slot < kMostOthers);
  static constexpr TermInfo<3, 0> kInfo = {
      .name = std::array{"axis_coupling", "axis_coupling_2", "axis_coupling_3"}[Slot],
      .equation = std::array{"b q1o + J_o a_t tau_o + (1 - J_o) a_b tau_o, o the other axis",
                             "b q1o + J_o a_t tau_o + (1 - J_o) a_b tau_o, o the second other axis",
                             "b q1o + J_o a_t tau_o + (1 - J_o) a_b tau_o, o the third other axis"}[Slot],
      .source = "(6.8), (6.14), (6.16)",
      .confusable_with = "the base law where both axes move in step, transport_delay",
      .exciting_motion = "the other axis alone, then both at frequencies without a common multiple",
      .coefficients = {{{"angle", "1", Sign::kAny, "joint angle per motor angle of the other axis"},
                        {"top", "rad/Nm", Sign::kAny, "joint angle per torque of the other axis on its way forward"},
                        {"bottom", "rad/Nm", Sign::kAny, "joint angle per torque of the other axis on its way back"}}},
      .shapes = {},
      // Diagnosis asks for the first only: of further joints it asks for their angles, by coupled_hysteresis.
      .relations = {.doubles = {"transport_delay", "coupled_hysteresis"},
                    .shown_by = Motion::kOthers,
                    .slots = Slot + 1,
                    .placed = Slot > 0},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kAsItIs;

  constexpr AxisCouplingOf(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> ByDirection<Scalar, 1, false> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> ByDirection<Scalar, 1, false> {
    const auto& other = s.others[Slot];
    return {.common = {other.q1}, .value = other.tau, .forward = other.forward};
  }
};

template <typename Scalar>
using AxisCoupling = AxisCouplingOf<Scalar, 0>;
template <typename Scalar>
using AxisCoupling2 = AxisCouplingOf<Scalar, 1>;
template <typename Scalar>
using AxisCoupling3 = AxisCouplingOf<Scalar, 2>;

}  // namespace capstan
