// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan::gear {

/// What of the motor's torque arrives behind a gear: a share of it that the size of the torque and the direction of the
/// motion bend.
template <typename Scalar>
class GearTorque {
 public:
  static constexpr TermInfo<1, 0> kInfo = {
      .name = "gear_torque",
      .equation = "g tau",
      .source = "gear ratio times efficiency times the error of the torque constant",
      .confusable_with = "load_friction where the motion never turns",
      .exciting_motion = "loads of several sizes, both ways",
      .coefficients = {{{"gain", "1", Sign::kNonNegative, "torque behind the gear per torque of the motor"}}},
      .shapes = {},
  };
  constexpr GearTorque(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> { return {s.tau}; }
};

}  // namespace capstan::gear
