// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"
#include "capstan/model/trigonometry.hpp"

namespace capstan {

/// What comes back with every N-th part of a turn of the motor: an encoder disc or a pulley off its centre, poles,
/// teeth,
///   s sin(N q1) + c cos(N q1)
/// N need not be whole: behind a gear the disc turns N times while the input pulley turns once.
template <typename Scalar>
class AnglePeriodic {
 public:
  static constexpr TermInfo<2, 1> kInfo = {
      .name = "angle_periodic",
      .equation = "s sin(N q1) + c cos(N q1)",
      .source = "eccentricity, cogging: periodic in an angle",
      .confusable_with = "gravity where N is near beta, quantisation",
      .exciting_motion = "two turns or more at two speeds and two loads, slowly: at least 2 N samples a turn",
      .coefficients = {{{"sine", "rad", Sign::kAny, "angle per sin(N q1)"},
                        {"cosine", "rad", Sign::kAny, "angle per cos(N q1)"}}},
      .shapes = {{{"order", "1", 0.5, 120.0, 5.0, "N: periods per turn of the input pulley", ShapeScale::kPeriods}}},
      .relations = {.doubles = {"gravity"},
                    .special_cases_of_effort = {"offset", "gravity"},
                    .shown_by = Motion::kSpeeds | Motion::kTurns},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kEitherWay;
  static constexpr bool kStaysInRange = true;

  constexpr AnglePeriodic(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 1>& shape) : phase_(shape[0]) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 2> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 2> {
    return phase_(s.q1).sine_and_cosine();
  }

 private:
  PhaseScale<Scalar> phase_;
};

}  // namespace capstan
