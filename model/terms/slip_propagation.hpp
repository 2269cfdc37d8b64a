// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "capstan/model/cell_scale.hpp"
#include "capstan/model/term.hpp"

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
/// It starts from no torque, as a drive that is switched on: from the first sample's, its noise would stay in every
/// play that the torque never crosses.
/// Its sign is that of the base law's a, negative, as long as the tendon stretches less at first. It is the other one
/// where the joint loses more at first: after a reversal from a load under which a tendon went slack its slack is taken
/// up before anything stretches, and where the torque is logged with the other sign both turn round.
///
/// Where what is rubbed against is not spread so evenly, the old stretch leaves in another way. To first order a share
/// of the torque has yet to arrive, and it fades with the change s of the torque since the reversal:
///   (J c_t + (1 - J) c_b) tau (1 - s / 4R)^4,  nothing beyond 4R
/// The fourth power lies between the parabola of an even front and the exponential of a front that never quite arrives.
template <typename Scalar>
class SlipPropagation {
 public:
  static constexpr int kLog2Operators = 3;
  static constexpr std::size_t kOperators = 1U << kLog2Operators;

  static constexpr TermInfo<3, 1> kInfo = {
      .name = "slip_propagation",
      .equation =
          "a (mean_k play(tau, r_k) - tau) + (J c_t + (1 - J) c_b) tau (1 - s/4R)^4, r_k = R (k + 1/2) / n, "
          "s = abs(tau - tau0)",
      .source = "(2.6), (2.7), (2.10) with a moving front; thesis 8.2 names the jump at reversals as open",
      .confusable_with = "pretension_offset, reversal_memory, play, presliding",
      .exciting_motion = "nested loops: reversals at several torques, some before the front has reached the joint",
      .coefficients = {{{"a", "rad/Nm", Sign::kAny, "elongation per torque that arrives gradually", Sign::kNonPositive,
                         "after a reversal the slack of a tendon is taken up first, or the torque has the other sign"},
                        {"top", "rad/Nm", Sign::kAny, "old stretch per torque after a reversal to the top tendon, c_t"},
                        {"bottom", "rad/Nm", Sign::kAny,
                         "old stretch per torque after a reversal to the bottom tendon, c_b"}}},
      .shapes = {{{"torque", "Nm", 1e-5, 20.0, 0.05, "R: half the change of torque after which the whole tendon slips",
                   ShapeScale::kRatio, ShapeOf::kTorqueRange}}},
      .relations = {.doubles = {"pretension_offset", "reversal_memory", "play", "presliding"},
                    .builds_on = {"tendon_elongation"},
                    // A front that has arrived at once is a step at each reversal.
                    .special_cases = {"pretension_offset"},
                    .shown_by = Motion::kLoops | Motion::kSmall},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kOfDirection;
  static constexpr bool kStaysInRange = true;

  constexpr SlipPropagation(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 1>& shape)
      : reach_(clamp(shape[0], kLeast, kMost) * kReach), share_of_reach_(Scalar{}, reach_) {
    constexpr auto kHalfShare = Traits::fraction(0.5 / kOperators);
    const Scalar torque = clamp(shape[0], kLeast, kMost);
    Scalar half_width = torque * kHalfShare;
    for (std::size_t k = 0; k < kOperators; ++k) {
      width_[k] = half_width + half_width;
      lowest_ -= half_width;
      half_width += torque * kShare;
    }
    restart();
  }
  constexpr void restart() {
    for (std::size_t k = 0; k < kOperators; ++k) {
      place_[k] = width_[k] * kHalf;
    }
    tau_ = Scalar{};
  }

  constexpr auto update(const Sample<Scalar>& s) -> ByDirection<Scalar, 1> {
    const Scalar step = s.tau - tau_;
    tau_ = s.tau;
    Scalar lag = lowest_;
#pragma GCC unroll 8
    for (std::size_t k = 0; k < kOperators; ++k) {
      place_[k] = clamp(place_[k] - step, Scalar{}, width_[k]);
      lag += place_[k];
    }
    return {
        .common = {Traits::template shifted_down<kLog2Operators>(lag)}, .value = old_stretch(s), .forward = s.forward};
  }

  /// Fully slipping: every operator trails by its half width, R / 2 on average, and nothing of the old stretch is left.
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> ByDirection<Scalar, 1> {
    return {.common = {Traits::template shifted_down<kLog2Operators>(s.forward ? lowest_ : -lowest_)},
            .forward = s.forward};
  }

 private:
  using Traits = ScalarTraits<Scalar>;
  static constexpr auto kShare = Traits::fraction(1.0 / kOperators);
  static constexpr auto kHalf = Traits::fraction(0.5);
  static constexpr Scalar kReach = Traits::from(4.0);
  /// Of R, N m: within them no sum of places leaves the range, and the reach is not nothing.
  static constexpr Scalar kLeast = Traits::from(1e-5);
  static constexpr Scalar kMost = Traits::from(30.0);

  [[nodiscard]] constexpr auto old_stretch(const Sample<Scalar>& s) const -> Scalar {
    const Scalar change = abs(s.tau - s.tau_reversal);
    if (reach_ <= change) {
      return Scalar{};
    }
    constexpr auto kWhole = Traits::fraction(1.0);
    return Traits::part(s.tau, square(square(kWhole - share_of_reach_.fraction(change, Scalar{}))));
  }

  Scalar reach_;  ///< change of torque after which nothing of the old stretch is left
  CellScale<Scalar> share_of_reach_;
  std::array<Scalar, kOperators> width_{};  ///< 2 r_k
  std::array<Scalar, kOperators> place_{};  ///< play(tau, r_k) - tau + r_k, from 0 to 2 r_k
  Scalar lowest_{};                         ///< the sum of play(tau, r_k) - tau where all places are 0
  Scalar tau_{};
};

}  // namespace capstan
