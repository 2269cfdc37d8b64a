// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>

#include "capstan/model/weighted_sum.hpp"

namespace capstan {

/// Every number of (6.8) for n axes, Theta = B Q + A S tau. Row: the joint; column: the motor. Zero off the diagonal of
/// both: independent axes. A pair in one triangle only: one-way coupling, as between a wrist's pitch and its jaws.
template <typename Scalar, std::size_t Axes>
struct CouplingMatrices {
  using Row = std::array<Scalar, Axes>;
  std::array<Row, Axes> rigid{};              ///< B, 1
  std::array<Row, Axes> elongation_top{};     ///< the columns of A for motors that go forward, rad/(N m)
  std::array<Row, Axes> elongation_bottom{};  ///< and backward
  Row offset{};                               ///< joint angles at no motor angle and no torque, rad
};

/// Joint angles of all axes from all motors, and back for feedforward.
template <typename Scalar, std::size_t Axes>
class CoupledAxes {
 public:
  using Matrices = CouplingMatrices<Scalar, Axes>;
  using Vector = std::array<Scalar, Axes>;
  using Directions = std::array<bool, Axes>;

  /// B must be invertible with some margin, or `is_usable` is false and `motors` answers zeros. An entry that is not a
  /// number, or a row whose magnitudes add up to 256, makes it unusable too, and `joints` answers zeros as well.
  constexpr explicit CoupledAxes(const Matrices& matrices) : m_(matrices) {
    if (!do_sums_fit()) {
      m_ = {};
    }
    usable_ = invert_rigid();
    inverse_ = usable_ ? inverse_ : decltype(inverse_){};
  }
  [[nodiscard]] constexpr auto is_usable() const -> bool { return usable_; }

  /// @param q  motor angles, rad   @param tau  motor torques, N m   @param forward  J of each motor
  [[nodiscard]] constexpr auto joints(const Vector& q, const Vector& tau, const Directions& forward) const -> Vector {
    const auto elongation = columns(forward);
    Vector theta{};
#pragma GCC unroll 4
    for (std::size_t i = 0; i < Axes; ++i) {
      WeightedSum<Scalar> sum = stretch(i, tau, elongation);
#pragma GCC unroll 4
      for (std::size_t j = 0; j < Axes; ++j) {
        sum.add(m_.rigid[i][j], q[j]);
      }
      theta[i] = sum.value();
    }
    return theta;
  }

  /// Motor angles at which the joints stand at theta under these torques: Q = B^-1 (Theta - A S tau - offset).
  [[nodiscard]] constexpr auto motors(const Vector& theta, const Vector& tau, const Directions& forward) const
      -> Vector {
    const auto elongation = columns(forward);
    Vector rigid{};
#pragma GCC unroll 4
    for (std::size_t j = 0; j < Axes; ++j) {
      rigid[j] = theta[j] - stretch(j, tau, elongation).value();
    }
    Vector q{};
#pragma GCC unroll 4
    for (std::size_t i = 0; i < Axes; ++i) {
      WeightedSum<Scalar> sum;
#pragma GCC unroll 4
      for (std::size_t j = 0; j < Axes; ++j) {
        sum.add(inverse_[i][j], rigid[j]);
      }
      q[i] = sum.value();
    }
    return q;
  }

 private:
  /// A pivot below this would make the inverse larger than the numbers hold.
  static constexpr Scalar kLeastPivot = ScalarTraits<Scalar>::from(0.01);

  static constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);

  using Row = typename Matrices::Row;
  /// A S: of each motor, the matrix whose column its direction takes.
  [[nodiscard]] constexpr auto columns(const Directions& forward) const
      -> std::array<const std::array<Row, Axes>*, Axes> {
    std::array<const std::array<Row, Axes>*, Axes> result{};
    for (std::size_t j = 0; j < Axes; ++j) {
      result[j] = forward[j] ? &m_.elongation_top : &m_.elongation_bottom;
    }
    return result;
  }
  /// A row of A S tau + offset.
  [[nodiscard, gnu::always_inline]] constexpr auto stretch(
      std::size_t i, const Vector& tau, const std::array<const std::array<Row, Axes>*, Axes>& elongation) const
      -> WeightedSum<Scalar> {
    WeightedSum<Scalar> sum;
    sum.add(m_.offset[i], kOne);
#pragma GCC unroll 4
    for (std::size_t j = 0; j < Axes; ++j) {
      sum.add((*elongation[j])[i][j], tau[j]);
    }
    return sum;
  }

  /// With the larger of each pair, so for every direction.
  [[nodiscard]] constexpr auto do_sums_fit() const -> bool {
    for (std::size_t i = 0; i < Axes; ++i) {
      std::array<Scalar, 2 * Axes + 1> row{};
      row[2 * Axes] = m_.offset[i];
      for (std::size_t j = 0; j < Axes; ++j) {
        row[j] = m_.rigid[i][j];
        row[Axes + j] = std::max(abs(m_.elongation_top[i][j]), abs(m_.elongation_bottom[i][j]));
      }
      if (!WeightedSum<Scalar>::holds(row)) {
        return false;
      }
    }
    return true;
  }

  /// Gauss and Jordan with row pivots.
  constexpr auto invert_rigid() -> bool {
    auto left = m_.rigid;
    for (std::size_t i = 0; i < Axes; ++i) {
      for (std::size_t j = 0; j < Axes; ++j) {
        if (ScalarTraits<Scalar>::is_missing(left[i][j]) || ScalarTraits<Scalar>::is_missing(m_.elongation_top[i][j]) ||
            ScalarTraits<Scalar>::is_missing(m_.elongation_bottom[i][j])) {
          return false;
        }
      }
      inverse_[i][i] = kOne;
    }
    for (std::size_t k = 0; k < Axes; ++k) {
      std::size_t pivot = k;
      for (std::size_t i = k + 1; i < Axes; ++i) {
        pivot = abs(left[pivot][k]) < abs(left[i][k]) ? i : pivot;
      }
      if (!(kLeastPivot < abs(left[pivot][k]))) {
        return false;
      }
      std::swap(left[k], left[pivot]);
      std::swap(inverse_[k], inverse_[pivot]);
      const Scalar divisor = left[k][k];
      for (std::size_t j = 0; j < Axes; ++j) {
        left[k][j] = left[k][j] / divisor;
        inverse_[k][j] = inverse_[k][j] / divisor;
      }
      for (std::size_t i = 0; i < Axes; ++i) {
        const Scalar share = i == k ? Scalar{} : left[i][k];
        for (std::size_t j = 0; j < Axes; ++j) {
          left[i][j] -= left[k][j] * share;
          inverse_[i][j] -= inverse_[k][j] * share;
        }
      }
    }
    return std::all_of(inverse_.begin(), inverse_.end(), WeightedSum<Scalar>::template holds<Axes>);
  }

  Matrices m_;
  std::array<Vector, Axes> inverse_{};
  bool usable_ = false;
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
