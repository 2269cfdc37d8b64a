// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/power.hpp"
#include "capstan/model/reciprocal.hpp"
#include "capstan/model/term.hpp"

namespace capstan::effort {

/// Drag that grows with a power of the speed: less than linearly in grease that thins as it is sheared (0.2 to 0.7),
/// more than linearly in air or churned oil (2). Beyond twice the reference speed it stays at what it is there.
template <typename Scalar>
class PowerLawFriction {
 public:
  static constexpr TermInfo<1, 2> kInfo = {
      .name = "power_law_friction",
      .equation = "F sign(q1') |q1'/v|^p",
      .source = "Ostwald and de Waele's power law of shear-thinning lubricant; quadratic drag",
      .confusable_with = "coulomb_friction with viscous_friction, stribeck_friction",
      .exciting_motion = "six constant speeds or more over two decades, both ways",
      .coefficients = {{{"level", "Nm", Sign::kAny, "drag at the reference speed"}}},
      .shapes = {{{"exponent", "1", 0.02, 4.0, 0.5, "p: below 1 it grows less than linearly"},
                  {"speed", "rad/s", 0.0001, 120.0, 1.0, "v: the reference speed"}}},
  };
  static constexpr SteadyState kSteadyState = SteadyState::kEitherWay;
  static constexpr bool kStaysInRange = true;

  constexpr PowerLawFriction(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 2>& shape)
      : exponent_(shape[0]), speed_(shape[1]), per_speed_(shape[1]) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 1> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 1> {
    constexpr Scalar kMost = ScalarTraits<Scalar>::from(2.0);  // constant: the target converts no double at run time
    if (speed_ <= Scalar{} || s.dq1 == Scalar{}) {
      return {Scalar{}};
    }
    const Scalar share = abs(s.dq1) * per_speed_;
    const Scalar drag = power(share < kMost ? share : kMost, exponent_);
    return {s.dq1 > Scalar{} ? drag : -drag};
  }

 private:
  Scalar exponent_;
  Scalar speed_;
  Reciprocal<Scalar> per_speed_;
};

}  // namespace capstan::effort
