// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/term.hpp"

namespace capstan {

/// A mass on the link lags behind: the torque that accelerates it stretches what drives it,
///   -(I / K) q2'', with q2'' = beta q1'' to first order, so  m q1''
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
      .coefficients = {{{"lag", "rads2/krad", Sign::kNonPositive, "lag per motor acceleration; -1 is 1e-3 s2"}}},
      .shapes = {},
  };

  static constexpr bool kSettlesAlike = true;

  constexpr LoadInertia(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return settled(s); }
  [[nodiscard]] constexpr auto settled(const Sample<Scalar>& s) const -> std::array<Scalar, 1> { return {s.ddq1}; }
};

}  // namespace capstan
