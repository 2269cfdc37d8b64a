// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan::gear {

/// What the gear keeps in proportion to the torque that it carries, in both directions or only while the motor drives.
template <typename Scalar>
class LoadFriction {
 public:
  static constexpr TermInfo<2, 0> kInfo = {
      .name = "load_friction",
      .equation = "-(2J - 1) (L |tau| + L1 |tau| while tau drives)",
      .source = "Coulomb with the normal force of the teeth",
      .confusable_with = "gear_torque where the motion never turns",
      .exciting_motion = "the same loads lifted and lowered",
      .coefficients = {{{"both_ways", "1", Sign::kAny, "share of the torque that is lost in either direction"},
                        {"driving", "1", Sign::kAny, "what is lost beside it while the motor drives the load"}}},
      .shapes = {},
  };
  constexpr LoadFriction(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 2> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 2> {
    const Scalar size = abs(s.tau);
    const bool drives = s.forward == (s.tau > Scalar{});
    return {s.forward ? -size : size, drives ? -s.tau : Scalar{}};
  }
};

}  // namespace capstan::gear
