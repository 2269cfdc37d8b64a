// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan {

/// A mass on the link lags behind: the torque that accelerates it stretches what drives it,
///   -(I / K) q2'', with q2'' = beta q1'' to first order, so  m q1''
///
/// Sign. m = -I beta / K < 0 where tau does not hold what accelerates the mass: it is not logged, or a set value. Where
/// tau is the motor's torque, it accelerates the motor's own inertia first, and the tendon carries tau - I_m q1'': the
/// elongation a tau of the base law then holds a I_m q1'' too much, which m = -a I_m > 0 gives back.
/// Acceleration counts in krad/s2, so that neither it nor its coefficient meets an end of the range: m = 1 rad s2/krad
/// is I beta / K = 1e-3 s2.
template <typename Scalar>
class LoadInertia {
 public:
  static constexpr TermInfo<1, 0> kInfo = {
      .name = "load_inertia",
      .equation = "m q1''",
      .source = "(1.21) with tau = I q2'' at the joint; thesis 6.4 keeps the rate only",
      .confusable_with = "transport_delay, transmission_viscous on one sine",
      .exciting_motion = "a chirp or multisine over a decade: this one grows with the square of the frequency",
      .coefficients = {{{"lag", "rads2/krad", Sign::kAny, "angle per motor acceleration; -1 is a lag of 1e-3 s2",
                         Sign::kNonPositive,
                         "the motor's own inertia is in its torque, and counts for more than the load's"}}},
      .shapes = {},
      .relations = {.doubles = {"transport_delay", "transmission_viscous"}, .shown_by = Motion::kFast},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kEitherWay;
  static constexpr bool kStaysInRange = true;

  constexpr LoadInertia(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> { return {s.ddq1}; }
};

}  // namespace capstan
