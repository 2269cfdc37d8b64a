// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/firmware/parameters/parameter_rows.hpp"

namespace capstan {

/// The group of a term's parameters: "effort_coulomb_friction". Motion laws have terms of the same names.
template <typename Term>
inline constexpr std::array<char, 40> kEffortGroup = placed_name<Term>("effort_");

inline constexpr std::size_t kEffortRows = 5 + TorqueTerms::kCoefficients + TorqueTerms::kShapes;

/// The rows of the effort law, its terms from the catalogue.
constexpr auto make_effort_table() -> std::array<ParameterInfo, kEffortRows> {
  constexpr std::size_t kEffort = offsetof(AxisConfig, effort);
  constexpr std::size_t kView = kEffort + offsetof(EffortConfig, view);
  std::array<ParameterInfo, kEffortRows> table = {
      real("effort", "window", "s", "smoothing window of the effort law; the disturbance lags by a quarter of it",
           kView + offsetof(MotionView<Q24>, window_s), 0.016, 0.12),
      real("effort", "standstill", "rad/s", "speed below which the effort law keeps its direction",
           kView + offsetof(MotionView<Q24>, standstill_rad_s), 0.0, 10.0),
      real("effort", "letting_go", "s", "time constant with which dry friction decays at a standstill; 0: it stays",
           kView + offsetof(MotionView<Q24>, letting_go_s), 0.0, 10.0),
      integer("effort", "feedforward", "1",
              "1: position control adds the effort law's torque in place of control.torque_forward and torque_backward",
              kEffort + offsetof(EffortConfig, feedforward), 0, 1),
      integer("effort", "status", "1", "status of the effort law: 0 confirmed, 1 provisional, 2 base",
              kEffort + offsetof(EffortConfig, status), 0, 2),
  };
  constexpr std::size_t kLaw = kEffort + offsetof(EffortConfig, law);
  std::size_t next = 5;
  std::size_t coefficient = kLaw + offsetof(TorqueLawParameters<Q24>, coefficients);
  std::size_t at = kLaw + offsetof(TorqueLawParameters<Q24>, shapes);
  TorqueTerms::for_each<Q24>([&]<typename Term>() {
    for (const CoefficientInfo& declared : Term::kInfo.coefficients) {
      const CoefficientInfo c = of_torque(declared);
      table[next++] =
          real(kEffortGroup<Term>.data(), c.name, c.unit, c.doc, coefficient, -kCoefficientLimit, kCoefficientLimit);
      coefficient += sizeof(Q24);
    }
    for (const ShapeInfo& s : Term::kInfo.shapes) {
      table[next++] = shape(kEffortGroup<Term>.data(), s, at);
      at += sizeof(Q24);
    }
  });
  return table;
}
inline constexpr std::array<ParameterInfo, kEffortRows> kEffortTable = make_effort_table();

}  // namespace capstan
