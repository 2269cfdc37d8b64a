// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan {

/// Backlash between the pulley and the joint: the joint rests while the motor crosses a gap of 2 w.
///   p <- clamp(p, q1 - w, q1 + w);  regressor p - q1, in [-w, w]
/// The coefficient is the ratio beta for pure backlash; smaller where only part of the motion passes through the gap.
template <typename Scalar>
class Play {
 public:
  static constexpr TermInfo<1, 1> kInfo = {
      .name = "play",
      .equation = "k (p - q1), p = play(q1, w)",
      .source = "play operator; thesis 5.2 names backlash among the effects left out",
      .confusable_with = "presliding, tendon_elongation where the torque hardly varies",
      .exciting_motion = "reversals under several loads, amplitudes below and above the gap",
      .coefficients = {{{"gain", "1", Sign::kNonNegative,
                         "joint angle per motor angle through the gap; beta for pure backlash"}}},
      .shapes = {{{"half_width", "rad", 1e-6, 60.0, 0.02, "half the gap, at the motor", ShapeScale::kRatio,
                   ShapeOf::kMotorRange}}},
      .relations = {.doubles = {"presliding", "tendon_elongation"}, .shown_by = Motion::kLoops | Motion::kSmall},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kOfDirection;
  static constexpr bool kStaysInRange = true;

  constexpr Play(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 1>& shape) : half_width_(shape[0]) {}
  constexpr void restart() { started_ = false; }
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> {
    if (!started_) {
      started_ = true;
      position_ = s.q1;
    }
    position_ = clamp(position_, s.q1 - half_width_, s.q1 + half_width_);
    return {position_ - s.q1};
  }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> {
    return {s.forward ? -half_width_ : half_width_};
  }

 private:
  Scalar half_width_;
  Scalar position_{};
  bool started_ = false;
};

}  // namespace capstan
