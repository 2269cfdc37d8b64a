// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/disturbance.hpp"
#include "capstan/tests/boards/stm32f405/costs.hpp"

namespace capstan::costs {

/// A servo's effort law (rigid dynamics, power-law and play friction, spring, weight), and one with every effect on:
/// what the disturbance costs in a cycle, window and filter included, and the law's feedforward for both directions.
template <typename Scalar>
consteval auto torque_parameters(bool every_effect) -> TorqueLawParameters<Scalar> {
  TorqueLawParameters<Scalar> parameters;
  std::size_t coefficient = 0;
  std::size_t shape = 0;
  TorqueTerms::for_each<Scalar>([&]<typename Term>() {
    const std::string_view name = Term::kInfo.name;
    const bool servo = place_of<Term>() == 1 && (name == "inertia" || name == "viscous_friction" || name == "offset" ||
                                                 name == "coulomb_friction" || name == "power_law_friction" ||
                                                 name == "play_friction" || name == "spring" || name == "gravity");
    for (std::size_t i = 0; i < kCoefficientsOf<Term>; ++i) {
      parameters.coefficients[coefficient++] = ScalarTraits<Scalar>::from(servo || every_effect ? 0.05 : 0.0);
    }
    for (const ShapeInfo& info : Term::kInfo.shapes) {
      parameters.shapes[shape++] = ScalarTraits<Scalar>::from(info.initial);
    }
  });
  return parameters;
}

template <typename Scalar, bool EveryEffect>
void measure_torque_law(Print& out, std::string_view name, std::string_view feedforward) {
  static constexpr auto kTorqueLaw = torque_parameters<Scalar>(EveryEffect);
  static Disturbance<Scalar> disturbance(period<Scalar>(), kTorqueLaw, {});
  Walk<Scalar> walk;
  DisturbanceEstimate<Scalar> estimate;
  const auto step = [&](int i) { walk.step(i); };
  measure(out, name, step, [&] {
    estimate = disturbance.update({.q1 = walk.q1, .tau = walk.tau});
    touch(estimate);
  });
  Scalar torque;
  measure(out, feedforward, step, [&] {
    Sample<Scalar> motion = disturbance.motion();
    const auto one_way = disturbance.law().each_way(motion);
    torque = disturbance.law().either_way(motion) + one_way.backward + one_way.forward;
    touch(torque);
  });
}

}  // namespace capstan::costs
