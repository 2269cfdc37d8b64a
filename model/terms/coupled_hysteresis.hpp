// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan {

/// Another joint's tendon passes this joint, and what it does here comes through a hysteresis of its own:
///   b q_o + k (q_o - p),   p = play(q_o, r), o the other joint
/// b = -k is play(q_o, r) alone, k = 0 the coupling of (6.14) without torques. One term for each slot of the coupling,
/// since a wrist's joint has the tendons of three others pass by.
template <typename Scalar, std::size_t Slot>
class CoupledHysteresisOf {
 public:
  static_assert(Slot < kMostOthers);
  static constexpr TermInfo<2, 1> kInfo = {
      .name = std::array{"coupled_hysteresis", "coupled_hysteresis_2", "coupled_hysteresis_3"}[Slot],
      .equation = std::array{"b q1o + k (q1o - play(q1o, r)), o the other joint",
                             "b q1o + k (q1o - play(q1o, r)), o the second other joint",
                             "b q1o + k (q1o - play(q1o, r)), o the third other joint"}[Slot],
      .source = "(6.8), (6.14) behind the play operator",
      .confusable_with = "axis_coupling, whatever moves in step with the other joint",
      .exciting_motion = "the other joint alone, loops of several sizes, then both without a common multiple",
      .coefficients = {{{"angle", "1", Sign::kAny, "joint angle per motor angle of the other joint"},
                        {"lost", "1", Sign::kAny, "joint angle per motion of it that its play takes up"}}},
      .shapes = {{{"half_width", "rad", 1e-6, 60.0, 0.02, "half the play of the other joint's tendon, at its motor",
                   ShapeScale::kRatio, ShapeOf::kOtherRange}}},
      .relations = {.doubles = {"axis_coupling"},
                    .shown_by = Motion::kOthers | Motion::kSmall,
                    .slots = Slot + 1,
                    .placed = true},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kAsItIs;

  constexpr CoupledHysteresisOf(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 1>& shape)
      : half_width_(clamp(shape[0], Scalar{}, kMost)) {}
  constexpr void restart() { started_ = false; }
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 2> {
    const Scalar other = s.others[Slot].q1;
    if (!started_) {
      started_ = true;
      position_ = other;
    }
    position_ = clamp(position_, other - half_width_, other + half_width_);
    return steady_state(s);
  }
  /// The other motor is where it is, whatever this one is about to do.
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 2> {
    const Scalar other = s.others[Slot].q1;
    return {other, other - position_};
  }

 private:
  static constexpr Scalar kMost = ScalarTraits<Scalar>::from(60.0);
  Scalar half_width_;
  Scalar position_{};
  bool started_ = false;
};

template <typename Scalar>
using CoupledHysteresis = CoupledHysteresisOf<Scalar, 0>;
template <typename Scalar>
using CoupledHysteresis2 = CoupledHysteresisOf<Scalar, 1>;
template <typename Scalar>
using CoupledHysteresis3 = CoupledHysteresisOf<Scalar, 2>;

}  // namespace capstan
