// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/low_pass.hpp"
#include "capstan/model/term.hpp"

namespace capstan {

/// The tendon is a standard linear solid: of its elongation a tau a part c tau comes only with time,
///   T x' + x = tau;  regressor x - tau
/// so a keeps its meaning, the compliance that a long hold shows, and nothing is added while the torque rests.
template <typename Scalar>
class ViscoelasticCreep {
 public:
  static constexpr TermInfo<1, 1> kInfo = {
      .name = "viscoelastic_creep",
      .equation = "c (x - tau), T x' + x = tau",
      .source = "standard linear solid; thesis 3 takes the tendon as elastic",
      .confusable_with =
          "thermal_drift where T exceeds the record, transmission_viscous at one frequency, slip_propagation",
      .exciting_motion = "holds of at least 3 T at several torques, then back to zero",
      .coefficients = {{{"creep", "rad/Nm", Sign::kNonPositive, "elongation per torque that comes with time"}}},
      .shapes = {{{"time", "s", 0.01, 120.0, 1.0, "T: within it 63 % of the creep has come", ShapeScale::kRatio,
                   ShapeOf::kTime}}},
      .relations = {.doubles = {"thermal_drift", "transmission_viscous", "slip_propagation"},
                    .shown_by = Motion::kLoops | Motion::kHolds},
  };

  constexpr ViscoelasticCreep(SamplePeriod<Scalar> dt, const std::array<Scalar, 1>& shape) : crept_(dt, shape[0]) {}
  constexpr void restart() { started_ = false; }
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> {
    if (!started_) {
      started_ = true;
      crept_.start(s.tau);  // the torque it starts with has been there for long
    }
    return {crept_.update(s.tau) - s.tau};
  }
  /// As far as the tendon has crept by now: T is longer than what a feedforward looks ahead.
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> {
    return {started_ ? crept_.value() - s.tau : Scalar{}};
  }

 private:
  LowPass<Scalar> crept_;
  bool started_ = false;
};

}  // namespace capstan
