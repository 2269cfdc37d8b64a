// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "model/scalar.hpp"

namespace capstan {

/// sum theta_k phi_k. In fixed point the products are added up exactly and the sum is rounded once, so nothing is cut
/// on the way: a sum may leave the range and come back.
template <typename Scalar>
class WeightedSum {
 public:
  constexpr void add(Scalar coefficient, Scalar regressor) { total_ += coefficient * regressor; }
  [[nodiscard]] constexpr auto value() const -> Scalar { return total_; }
  /// A regressor that counts, or the sum itself, met the end of the range.
  [[nodiscard]] constexpr auto saturated() const -> bool { return false; }
  /// Whatever the regressors, sums with these coefficients do not leave what they are added up in.
  template <std::size_t Count>
  static constexpr auto holds(const std::array<Scalar, Count>& /*coefficients*/) -> bool {
    return true;
  }

 private:
  Scalar total_{};
};

template <>
class WeightedSum<Q24> {
 public:
  /// @pre `holds` the coefficients of the sum
  [[gnu::always_inline]] constexpr void add(Q24 coefficient, Q24 regressor) {
    total_ += wide_product(coefficient.raw(), regressor.raw());
    if (regressor.is_saturated()) [[unlikely]] {
      saturated_ = saturated_ || coefficient != Q24{};  // a coefficient of zero lets nothing of it through
    }
  }
  [[nodiscard]] constexpr auto value() const -> Q24 {
    return Q24::from_wide(shift_right_rounded<1>(total_ >> (Q24::kFrac - 1)));  // in two steps, so nothing wraps
  }
  [[nodiscard]] constexpr auto saturated() const -> bool { return saturated_ || value().is_saturated(); }
  /// Their magnitudes add up to less than 256, so no sum reaches 2^63.
  template <std::size_t Count>
  static constexpr auto holds(const std::array<Q24, Count>& coefficients) -> bool {
    std::int64_t sum = 0;
    for (const Q24 coefficient : coefficients) {
      sum += coefficient.raw() < 0 ? -std::int64_t{coefficient.raw()} : coefficient.raw();
    }
    return sum < std::int64_t{256} << Q24::kFrac;
  }

 private:
  std::int64_t total_ = 0;  // 2^-48
  bool saturated_ = false;
};

}  // namespace capstan
