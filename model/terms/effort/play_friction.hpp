// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/term.hpp"

namespace capstan::effort {

/// Friction that engages through a play: after a reversal it builds up over a way of 2 w instead of jumping,
///   F (q1 - p) / w,  p = play(q1, w)
/// in [-1, 1]: Coulomb's friction behind a spring. A band on a drum and a bristle on a rail do so.
template <typename Scalar>
class PlayFriction {
 public:
  static constexpr TermInfo<1, 1> kInfo = {
      .name = "play_friction",
      .equation = "F (q1 - p) / w, p = play(q1, w)",
      .source = "play operator; Prandtl's elastic-plastic element",
      .confusable_with = "coulomb_friction, stribeck_friction",
      .exciting_motion = "reversals with amplitudes below and above w, at several speeds",
      .coefficients = {{{"level", "Nm", Sign::kNonNegative, "friction once engaged"}}},
      .shapes = {{{"half_width", "rad", 0.0005, 2.0, 0.02, "half the way over which it engages"}}},
  };

  constexpr PlayFriction(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 1>& shape) : half_width_(shape[0]) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> {
    if (!started_) {
      started_ = true;
      position_ = s.q1;
    }
    position_ = clamp(position_, s.q1 - half_width_, s.q1 + half_width_);
    return half_width_ > Scalar{} ? std::array<Scalar, 1>{(s.q1 - position_) / half_width_} : settled(s);
  }
  [[nodiscard]] constexpr auto settled(const Sample<Scalar>& s) const -> std::array<Scalar, 1> {
    constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);  // constant: the target converts no double at run time
    return {s.forward ? kOne : -kOne};
  }

 private:
  Scalar half_width_;
  Scalar position_{};
  bool started_ = false;
};

}  // namespace capstan::effort
