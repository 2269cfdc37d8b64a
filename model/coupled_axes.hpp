// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/model/scalar.hpp"

namespace capstan {

/// Every number of (6.8) for n axes, Theta = B Q + A S tau. Row: the joint; column: the motor. Zero off the diagonal of
/// both: independent axes. A pair in one triangle only: one-way coupling, as between a wrist's pitch and its jaws. The
/// firmware runs a row as a joint's law: `motor_angle` and `tendon_elongation` its own column, `axis_coupling`, `_2`
/// and
/// `_3` the others'.
template <typename Scalar, std::size_t Axes>
struct CouplingMatrices {
  using Row = std::array<Scalar, Axes>;
  std::array<Row, Axes> rigid{};              ///< B, 1
  std::array<Row, Axes> elongation_top{};     ///< the columns of A for motors that go forward, rad/(N m)
  std::array<Row, Axes> elongation_bottom{};  ///< and backward
  Row offset{};                               ///< joint angles at no motor angle and no torque, rad
};

/// The elongation pair of one motor, rad/(N m), both negative.
template <typename Scalar>
struct ElongationPair {
  Scalar top{};
  Scalar bottom{};
};

/// The da Vinci wrist, axes pitch, right and left grasp: (6.14), (6.15) with (6.16). The jaws' tendons pass the pitch
/// joint over intermediate pulleys, so a jaw follows the pitch by K = r_int / r_jaw, stretch included, and the pitch
/// does not follow the jaws.
template <typename Scalar>
struct WristTransmission {
  Scalar beta_pitch{}, beta_right{}, beta_left{};
  Scalar follow_right{}, follow_left{};  ///< K_r, K_l: 0.674, 0.664 in Table 6.1
  ElongationPair<Scalar> pitch{}, right{}, left{};
};
template <typename Scalar>
constexpr auto coupling_of(const WristTransmission<Scalar>& w) -> CouplingMatrices<Scalar, 3> {
  CouplingMatrices<Scalar, 3> m;
  const Scalar one = ScalarTraits<Scalar>::from(1.0);
  const std::array<Scalar, 3> follow = {one, w.follow_right, w.follow_left};
  const std::array<Scalar, 3> beta = {w.beta_pitch, w.beta_right, w.beta_left};
  const std::array<ElongationPair<Scalar>, 3> pairs = {w.pitch, w.right, w.left};
  for (std::size_t i = 0; i < 3; ++i) {
    m.rigid[i][i] = beta[i];
    m.elongation_top[i][i] = pairs[i].top;
    m.elongation_bottom[i][i] = pairs[i].bottom;
    m.rigid[i][0] = follow[i] * w.beta_pitch;
    m.elongation_top[i][0] = follow[i] * w.pitch.top;
    m.elongation_bottom[i][0] = follow[i] * w.pitch.bottom;
  }
  return m;
}

}  // namespace capstan
