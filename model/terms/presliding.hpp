// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/exponential.hpp"
#include "capstan/model/low_pass.hpp"
#include "capstan/model/term.hpp"

namespace capstan {

/// Friction gives before it slips: a bristle bends with the motor, at most by z0, and the joint lags by it.
///   dz = dq1 - |dq1| z / z0                                                                       (Dahl 1968)
/// Over a step of one sign this is solved exactly by z <- l + (z - l) e^-(|step|/z0), l = +-z0, so |z| <= z0 for any
/// step, and the path alone counts, not how it was sampled. Regressor -z.
template <typename Scalar>
class Presliding {
 public:
  static constexpr TermInfo<1, 1> kInfo = {
      .name = "presliding",
      .equation = "-k z, dz = dq1 - |dq1| z / z0",
      .source = "Dahl's friction; thesis 8.2 names pre-sliding as open, with shear theory as a way",
      .confusable_with = "play, slip_propagation",
      .exciting_motion =
          "reversals with amplitudes below and above z0, under several loads: this one stays where no "
          "tendon goes slack",
      .coefficients = {{{"gain", "1", Sign::kNonNegative, "joint angle per deflection of the bristle"}}},
      .shapes = {{{"width", "rad", 1e-6, 60.0, 0.02, "z0: deflection at which it slips, at the motor",
                   ShapeScale::kRatio, ShapeOf::kMotorRange}}},
      .relations = {.doubles = {"play", "slip_propagation"}, .shown_by = Motion::kLoops | Motion::kSmall},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kOfDirection;
  static constexpr bool kStaysInRange = true;

  constexpr Presliding(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 1>& shape)
      : width_(shape[0]), fading_(shape[0]) {}
  constexpr void restart() {
    deflection_ = {};
    started_ = false;
  }
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> {
    if (!started_) {
      started_ = true;
      q1_ = s.q1;
    }
    const Scalar step = s.q1 - q1_;
    q1_ = s.q1;
    if (step != Scalar{}) {
      deflection_.approach(step > Scalar{} ? width_ : -width_, fading_.share_gone(step));
    }
    return {-deflection_.value()};
  }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> {
    return {s.forward ? -width_ : width_};
  }

 private:
  Scalar width_;
  FadingScale<Scalar> fading_;
  Scalar q1_{};
  WideState<Scalar> deflection_{};
  bool started_ = false;
};

}  // namespace capstan
