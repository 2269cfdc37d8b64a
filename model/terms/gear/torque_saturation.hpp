// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/reciprocal.hpp"
#include "capstan/model/term.hpp"

namespace capstan::gear {

/// Torque over current bends: iron saturates, so the last ampere brings less than the first.
template <typename Scalar>
class TorqueSaturation {
 public:
  static constexpr TermInfo<1, 1> kInfo = {
      .name = "torque_saturation",
      .equation = "c tau |tau| / T",
      .source = "first order of a torque constant that falls with the current",
      .confusable_with = "gear_torque where the torque hardly changes, load_friction",
      .exciting_motion = "loads from small to the largest, both ways",
      .coefficients = {{{"bend", "1", Sign::kAny,
                         "change of the gain at the torque T; negative where iron saturates"}}},
      .shapes = {{{"torque", "Nm", 0.0001, 120.0, 1.0, "T: a large torque of the log"}}},
  };
  constexpr TorqueSaturation(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 1>& shape)
      : scale_(shape[0]), per_scale_(shape[0]) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> {
    return {scale_ > Scalar{} ? s.tau * (abs(s.tau) * per_scale_) : Scalar{}};
  }

 private:
  Scalar scale_;
  Reciprocal<Scalar> per_scale_;
};

}  // namespace capstan::gear
