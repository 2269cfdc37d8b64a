// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/reciprocal.hpp"
#include "capstan/model/term.hpp"

namespace capstan::effort {

/// What pulls back to a rest: a cable, a tube, a return spring. The angle counts from the middle of the motion in
/// halves of its range, and no further than four of them; where the spring rests is told by the offset beside it.
template <typename Scalar>
class Spring {
 public:
  static constexpr TermInfo<2, 2> kInfo = {
      .name = "spring",
      .equation = "k u + k3 u^3, u = (q1 - centre) / span",
      .source = "Hooke; the cubic of Duffing",
      .confusable_with = "gravity where the angle changes little, angle_periodic of a low order",
      .exciting_motion = "slow motion over a half turn or more: weight bends back, a spring does not",
      .coefficients = {{{"linear", "Nm", Sign::kAny, "effort at one span from the centre"},
                        {"cubic", "Nm", Sign::kAny, "what is added to it there by hardening"}}},
      .shapes = {{{"centre", "rad", -120.0, 120.0, 0.0, "middle of the motion"},
                  {"span", "rad", 0.0001, 120.0, 1.0, "half of its range"}}},
  };
  static constexpr SteadyState kSteadyState = SteadyState::kEitherWay;
  static constexpr bool kStaysInRange = true;

  constexpr Spring(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 2>& shape)
      : centre_(shape[0]), span_(shape[1]), per_span_(shape[1]) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 2> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 2> {
    constexpr Scalar kMost = ScalarTraits<Scalar>::from(4.0);  // constant: the target converts no double at run time
    if (span_ <= Scalar{}) {
      return {Scalar{}, Scalar{}};
    }
    const Scalar u = clamp((s.q1 - centre_) * per_span_, -kMost, kMost);
    return {u, u * u * u};
  }

 private:
  Scalar centre_;
  Scalar span_;
  Reciprocal<Scalar> per_span_;
};

}  // namespace capstan::effort
