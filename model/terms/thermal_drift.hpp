// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/low_pass.hpp"
#include "capstan/model/term.hpp"

namespace capstan {

/// The instrument warms up and its tendons and frame grow by different amounts:
///   w (1 - e^-(t/T)) + k (temperature - 25 C)
/// The first part needs no thermometer, and no clock either: it is what a first-order lag makes of a constant, so it
/// stays in [0, 1] for ever. It starts when the law does; a joint switched on again while warm needs the thermometer.
template <typename Scalar>
class ThermalDrift {
 public:
  static constexpr TermInfo<2, 1> kInfo = {
      .name = "thermal_drift",
      .equation = "w (1 - exp(-t/T)) + k (temperature - 25 C)",
      .source = "first-order warming from one side",
      .confusable_with = "viscoelastic_creep with a long T, joint_offset",
      .exciting_motion =
          "the same cycle at the start, in the middle and at the end of a record of 2 T, with temperature",
      .coefficients = {{{"warm_up", "rad", Sign::kAny, "change of the joint angle from switching on to warm"},
                        {"temperature", "rad/K", Sign::kAny, "change per temperature"}}},
      .shapes = {{{"time", "min", 0.05, 120.0, 5.0, "T: within it 63 % of the warming has come", ShapeScale::kRatio,
                   ShapeOf::kTime}}},
      .relations = {.doubles = {"viscoelastic_creep", "joint_offset"},
                    .special_cases_of_effort = {"offset"},
                    .shown_by = Motion::kWarmth,
                    // Warming that has not slowed down yet is a straight line, and with a thermometer there may be no
                    // other at all.
                    .open_shapes = true},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kAsItIs;

  constexpr ThermalDrift(SamplePeriod<Scalar> dt, const std::array<Scalar, 1>& shape) : warmed_(dt, shape[0]) {}
  constexpr void restart() { warmed_.start(Scalar{}); }
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 2> {
    constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);  // constant: the target converts no double at run time
    return {warmed_.update(kOne), s.warmth};
  }
  /// As warm as it is now.
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 2> {
    return {warmed_.value(), s.warmth};
  }

 private:
  LowPass<Scalar, 60> warmed_;
};

}  // namespace capstan
