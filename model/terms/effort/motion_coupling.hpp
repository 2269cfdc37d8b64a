// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"

namespace capstan::effort {

/// What another joint's motion asks of this motor: its angle (a cable that it stretches, weight that it turns), its
/// speed and its direction (a cable that it drags along), its acceleration (mass that both move). The sample is the
/// other joint's own; a law has one such term for each joint that acts on it.
template <typename Scalar>
class MotionCoupling {
 public:
  static constexpr TermInfo<4, 0> kInfo = {
      .name = "axis_coupling",
      .equation = "k q_o + b q_o' + F (2 J_o - 1) + m q_o'', o the other joint",
      .source = "rows of mass, damping and stiffness matrix outside the diagonal; friction of cables that pass a joint",
      .confusable_with = "the joint's own terms where both move in step",
      .exciting_motion = "the other joint alone, then both at frequencies without a common multiple",
      .coefficients = {{{"stiffness", "Nm/rad", Sign::kAny, "effort per angle of the other joint"},
                        {"drag", "Nms/rad", Sign::kAny, "effort per its speed"},
                        {"dry", "Nm", Sign::kAny, "effort with its direction"},
                        {"inertia", "Nms2/krad", Sign::kAny, "effort per its acceleration; 1 is 1e-3 kg m2"}}},
      .shapes = {},
  };

  constexpr MotionCoupling(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& other) -> std::array<Scalar, 4> { return steady_state(other); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& other) const -> std::array<Scalar, 4> {
    constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);  // constant: the target converts no double at run time
    return {other.q1, other.dq1, other.forward ? kOne : -kOne, other.ddq1};
  }
};

}  // namespace capstan::effort
