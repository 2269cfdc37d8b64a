// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/term.hpp"
#include "capstan/model/trigonometry.hpp"

namespace capstan {

/// The link's weight pulls at the joint with a torque m sin(q2 + angle), which stretches what holds the joint:
///   s sin q2 + c cos q2
/// in rad, torque over stiffness. The angle is the link's, so the law's own estimate of the last cycle is used; that
/// is sound as long as sqrt(s^2 + c^2) < 1, which a joint that can hold its link meets.
template <typename Scalar>
class Gravity {
 public:
  static constexpr TermInfo<2, 0> kInfo = {
      .name = "gravity",
      .equation = "s sin q2 + c cos q2",
      .source = "weight of a link about its joint; thesis 7.3.2 takes it out before the law is applied",
      .confusable_with = "angle_periodic of order beta, joint_offset, stiffness_hardening on one sine",
      .exciting_motion = "the same motion with the base tilted or another payload, over a large part of a turn",
      .coefficients = {{{"sine", "rad", Sign::kAny, "angle per sin q2"},
                        {"cosine", "rad", Sign::kAny, "angle per cos q2"}}},
      .shapes = {},
      .relations = {.doubles = {"angle_periodic", "joint_offset", "stiffness_hardening"},
                    .special_cases_of_effort = {"offset"},
                    .shown_by = Motion::kSpeeds},
  };

  static constexpr SteadyState kSteadyState = SteadyState::kEitherWay;
  static constexpr bool kStaysInRange = true;

  constexpr Gravity(SamplePeriod<Scalar> /*dt*/, const std::array<Scalar, 0>& /*shape*/) {}
  constexpr auto update(const Sample<Scalar>& s) -> std::array<Scalar, 2> { return steady_state(s); }
  [[nodiscard]] constexpr auto steady_state(const Sample<Scalar>& s) const -> std::array<Scalar, 2> {
    constexpr PhaseScale<Scalar> kOnce(ScalarTraits<Scalar>::from(1.0));
    return kOnce(s.q2).sine_and_cosine();
  }
};

}  // namespace capstan
