// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/exponential.hpp"
#include "capstan/model/low_pass.hpp"
#include "capstan/model/reciprocal.hpp"
#include "capstan/model/term.hpp"

namespace capstan::effort {

/// Friction that engages through a play: after a reversal it builds up over a way of 2 w instead of jumping. Three
/// elements side by side share the play, each in [-1, 1]:
///   slider   s = (q1 - p) / w, p = play(q1, w)         Coulomb's friction behind a spring
///   grip     s beyond +-1/2, stretched to +-1          the same behind a slack: nothing rubs in the middle of the play
///   bristle  w/2 db = dq1 - |dq1| b                    gives way more and more, Dahl
/// A rail is mostly bristle; a band wrapped on a drum, which first goes slack and then grips, mostly grip.
/// It stays at rest, as what is stretched does; Coulomb's lets go (Sample::grip), so a law can hold a part of its
/// friction. With both letting go a measured joint that holds a part (ur10e_joint5) erred by twice as much.
template <typename Scalar>
class PlayFriction {
 public:
  static constexpr TermInfo<3, 1> kInfo = {
      .name = "play_friction",
      .equation = "F_s s + F_g grip(s) + F_b b, s = (q1 - play(q1, w)) / w, w/2 db = dq1 - |dq1| b",
      .source = "play operator; Prandtl's elastic-plastic element; Dahl 1968",
      .confusable_with = "coulomb_friction, stribeck_friction",
      .exciting_motion = "reversals with amplitudes below and above w, at several speeds",
      .coefficients = {{{"slider", "Nm", Sign::kNonNegative, "friction that builds up evenly over the play"},
                        {"grip", "Nm", Sign::kNonNegative, "friction that comes once half of the play is left"},
                        {"bristle", "Nm", Sign::kNonNegative, "friction that builds up fast, then slowly"}}},
      .shapes = {{{"half_width", "rad", 1e-6, 60.0, 0.02, "w: half the way over which it engages", ShapeScale::kRatio,
                   ShapeOf::kMotorRange}}},
      .relations = {.doubles = {"coulomb_friction", "stribeck_friction"},
                    .special_cases_of_effort = {"coulomb_friction"},
                    .shown_by = Motion::kSmall | Motion::kLoops},
  };
  static constexpr SteadyState kSteadyState = SteadyState::kOfDirection;
  static constexpr bool kStaysInRange = true;

  constexpr PlayFriction(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 1>& shape)
      : half_width_(shape[0]), per_half_width_(shape[0]), bristle_(shape[0] * kHalf) {}
  constexpr void restart() {
    started_ = false;
    bristle_state_ = {};
  }
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 3> {
    if (!started_) {
      started_ = true;
      position_ = q1_ = s.q1;
    }
    if (half_width_ <= Scalar{}) {
      return steady_state(s);
    }
    const Scalar step = s.q1 - q1_;
    q1_ = s.q1;
    if (step != Scalar{}) {
      bristle_state_.approach(step > Scalar{} ? kOne : -kOne, bristle_.share_gone(step));
    }
    position_ = clamp(position_, s.q1 - half_width_, s.q1 + half_width_);
    const Scalar slider = (s.q1 - position_) * per_half_width_;
    const Scalar beyond = slider - clamp(slider, -kHalf, kHalf);
    return {slider, beyond + beyond, bristle_state_.value()};
  }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 3> {
    const Scalar all = s.forward ? kOne : -kOne;
    return {all, all, all};
  }

 private:
  // Constants: the target converts no double at run time.
  static constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);
  static constexpr Scalar kHalf = ScalarTraits<Scalar>::from(0.5);

  Scalar half_width_;
  Reciprocal<Scalar> per_half_width_;
  FadingScale<Scalar> bristle_;
  Scalar position_{};
  Scalar q1_{};
  WideState<Scalar> bristle_state_{};
  bool started_ = false;
};

}  // namespace capstan::effort
