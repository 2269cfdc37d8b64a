// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "model/reciprocal.hpp"
#include "model/term.hpp"

namespace capstan {

/// After a reversal the slip front starts at the motor and works its way along the tendon, so the tendon stretches
/// little at first and by the whole of a tau only when the front has reached the joint. The base law stretches it at
/// once: its jump at a reversal is the open flaw that the thesis names.
///
/// With the front at phi_w a change s of the torque has reached the part phi_w ~ s of the tendon, and the elongation
/// grows as s^2 until s = 2 R; minor loops close and follow the same shape from where they start. A torque passed
/// through play operators of half widths spread evenly over [0, R] does just that (a Prandtl-Ishlinskii operator):
///   regressor  mean_k play(tau, r_k) - tau,   r_k = R (k + 1/2) / n
/// beside the a tau of the base law, so a coefficient equal to a turns a tau into a PI(tau).
///
/// Where what is rubbed against is not spread so evenly, the old stretch leaves in another way. To first order a share
/// of the torque has yet to arrive, and it fades with the change s of the torque since the reversal:
///   (J c_t + (1 - J) c_b) tau (1 - s / 4R)^4,  nothing beyond 4R
/// The fourth power lies between the parabola of an even front and the exponential of a front that never quite arrives.
template <typename Scalar>
class SlipPropagation {
 public:
  static constexpr std::size_t kOperators = 8;

  static constexpr TermInfo<3, 1> kInfo = {
      .name = "slip_propagation",
      .equation =
          "a (mean_k play(tau, r_k) - tau) + (J c_t + (1 - J) c_b) tau (1 - s/4R)^4, r_k = R (k + 1/2) / n, "
          "s = abs(tau - tau0)",
      .source = "(2.6), (2.7), (2.10) with a moving front; thesis 8.2 names the jump at reversals as open",
      .confusable_with = "pretension_offset, reversal_memory, play, presliding",
      .exciting_motion = "nested loops: reversals at several torques, some before the front has reached the joint",
      .coefficients = {{{"a", "rad/Nm", Sign::kNonPositive, "elongation per torque that arrives gradually"},
                        {"top", "rad/Nm", Sign::kAny, "old stretch per torque after a reversal to the top tendon, c_t"},
                        {"bottom", "rad/Nm", Sign::kAny,
                         "old stretch per torque after a reversal to the bottom tendon, c_b"}}},
      .shapes = {{{"torque", "Nm", 0.002, 20.0, 0.05,
                   "R: half the change of torque after which the whole tendon slips"}}},
  };

  constexpr SlipPropagation(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 1>& shape)
      : share_of_reach_(shape[0] * kReach) {
    constexpr auto kHalfShare = Traits::fraction(0.5 / kOperators);
    Scalar half_width = shape[0] * kHalfShare;
    for (std::size_t k = 0; k < kOperators; ++k) {
      width_[k] = half_width + half_width;
      lowest_ -= half_width;
      half_width += shape[0] * kShare;
    }
    restart();
  }
  constexpr void restart() {
    for (std::size_t k = 0; k < kOperators; ++k) {
      place_[k] = width_[k] * kHalf;
    }
    started_ = false;
  }

  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 3> {
    const Scalar step = started_ ? s.tau - tau_ : Scalar{};
    started_ = true;
    tau_ = s.tau;
    Scalar lag = lowest_;
#pragma GCC unroll 8
    for (std::size_t k = 0; k < kOperators; ++k) {
      place_[k] = clamp(place_[k] - step, Scalar{}, width_[k]);
      lag += place_[k];
    }
    const Scalar way_left = std::max(Scalar{}, kOne - abs(s.tau - s.tau_reversal) * share_of_reach_);
    const Scalar square = way_left * way_left;
    const Scalar fading = s.tau * (square * square);
    return {lag * kShare, s.forward ? fading : Scalar{}, s.forward ? Scalar{} : fading};
  }

  /// Fully slipping: every operator trails by its half width, R / 2 on average, and nothing of the old stretch is left.
  [[nodiscard]] constexpr auto settled(const Sample<Scalar>& s) const -> std::array<Scalar, 3> {
    return {(s.forward ? lowest_ : -lowest_) * kShare, Scalar{}, Scalar{}};
  }

 private:
  using Traits = ScalarTraits<Scalar>;
  static constexpr auto kShare = Traits::fraction(1.0 / kOperators);
  static constexpr auto kHalf = Traits::fraction(0.5);
  static constexpr Scalar kOne = Traits::from(1.0);
  static constexpr Scalar kReach = Traits::from(4.0);

  Reciprocal<Scalar> share_of_reach_;       ///< of the change of torque after which nothing of the old stretch is left
  std::array<Scalar, kOperators> width_{};  ///< 2 r_k
  std::array<Scalar, kOperators> place_{};  ///< play(tau, r_k) - tau + r_k, from 0 to 2 r_k
  Scalar lowest_{};                         ///< the sum of play(tau, r_k) - tau where all places are 0
  Scalar tau_{};
  bool started_ = false;
};

}  // namespace capstan
