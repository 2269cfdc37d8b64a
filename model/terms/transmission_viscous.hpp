// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan {

/// Viscous drag along the tendons, in proportion to the mean speed of both pulleys,
///   J g_t v + (1 - J) g_b v,   v = (r1 q1' + r2 q2') / 2                                               (6.21)
/// During lost motion the joint stands and v is half of r1 q1'. What the joint does of it is the motion behind the
/// input terms, r2 q2' = r1 h' to first order, so the regressor is v / r1 = (q1' + h') / 2 and the coefficients are g
/// r1, in seconds. Not the law's own q2', which holds the drag itself: g v on both sides is an equation that runs away
/// for g > 0, at once.
///
/// Sign. By (6.19) drag takes tension from the tendon behind the input end: T(phi) falls by b L v phi mean_decay(eta
/// phi), so at a given motor torque the tendon is shorter, by (6.20) b L v (1 - mean_decay(eta)) / (eta Kn), and the
/// joint is ahead: g > 0. Where tau is the motor's torque ahead of the motor's own damping d q1', the tendon carries
/// tau - d q1', and the law's a tau, a < 0, holds a d q1' too much: -a d > 0 gives it back. Negative is what tau does
/// not hold: where it is not logged, or is a set value, drag at the joint stretches the tendon by a d; and a late joint
/// sensor leaves the same at one frequency.
template <typename Scalar>
class TransmissionViscous {
 public:
  static constexpr const char* kUnusual =
      "the logged torque is not what the tendon carries, so that drag shows as a lag, or the joint sensor is late";
  static constexpr TermInfo<2, 0> kInfo = {
      .name = "transmission_viscous",
      .equation = "J g_t v + (1 - J) g_b v, v = r1 (q1' + h') / 2",
      .source = "(6.17)-(6.21)",
      .confusable_with = "transport_delay, viscoelastic_creep at one frequency",
      .exciting_motion =
          "the same path at three speeds over a decade; fast reversals, where a delay also shifts the torque",
      .coefficients = {{{"top", "s", Sign::kAny,
                         "angle per mean speed of the pulleys while the top tendon is pulled, g_t r1",
                         Sign::kNonNegative, kUnusual},
                        {"bottom", "s", Sign::kAny, "the same while the bottom tendon is pulled, g_b r1",
                         Sign::kNonNegative, kUnusual}}},
      .shapes = {},
      .relations = {.doubles = {"transport_delay", "viscoelastic_creep"}, .shown_by = Motion::kSpeeds | Motion::kFast},
  };

  static constexpr bool kStaysInRange = true;
  static constexpr bool kReadsInput = true;

  constexpr TransmissionViscous(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> ByDirection<Scalar> {
    return {.value = ScalarTraits<Scalar>::between(s.dq1, s.dh, kHalf), .forward = s.forward};
  }
  /// Nothing is lost any more.
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> ByDirection<Scalar> {
    return {.value = s.dq1, .forward = s.forward};
  }

 private:
  static constexpr auto kHalf = ScalarTraits<Scalar>::fraction(0.5);
};

}  // namespace capstan
