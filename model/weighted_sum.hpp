// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "capstan/model/scalar.hpp"

namespace capstan {

/// sum theta_k phi_k. In fixed point the products are added up exactly and the sum is rounded once, so nothing is cut
/// on the way: a sum may leave the range and come back.
template <typename Scalar>
class WeightedSum {
 public:
  constexpr void add(Scalar coefficient, Scalar regressor) { total_ += coefficient * regressor; }
  constexpr void add_checked(Scalar coefficient, Scalar regressor) { add(coefficient, regressor); }
  [[nodiscard]] constexpr auto value() const -> Scalar { return total_; }
  /// A checked regressor that counts met an end of the range; whether the sum does, its value says.
  [[nodiscard]] constexpr auto cut() const -> bool { return false; }
  /// Whether, whatever the regressors, sums with these coefficients do not leave what they are added up in.
  class Reach {
   public:
    constexpr void add(std::span<const Scalar> /*coefficients*/) {}
    constexpr void add_largest(std::span<const Scalar> /*coefficients*/) {}
    [[nodiscard]] constexpr auto holds() const -> bool { return true; }
  };
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
    total_ = wide_product_plus(total_, coefficient.raw(), regressor.raw());
  }
  /// The same for a regressor that may have been cut at an end of the range.
  [[gnu::always_inline]] constexpr void add_checked(Q24 coefficient, Q24 regressor) {
    add(coefficient, regressor);
    if (regressor.is_saturated()) [[unlikely]] {
      cut_ |= coefficient != Q24{};  // a coefficient of zero lets nothing of it through
    }
  }
  [[nodiscard]] constexpr auto value() const -> Q24 { return Q24::from_wide(total_ >> Q24::kFrac); }
  [[nodiscard]] constexpr auto cut() const -> bool { return cut_; }
  /// Their magnitudes add up to less than 256, so a sum stays 2^31 below 2^63.
  class Reach {
   public:
    constexpr void add(std::span<const Q24> coefficients) {
      for (const Q24 coefficient : coefficients) {
        sum_ += size(coefficient);
      }
    }
    /// Of coefficients of which two shares of one regressor count at a time.
    constexpr void add_largest(std::span<const Q24> coefficients) {
      std::int64_t largest = 0;
      for (const Q24 coefficient : coefficients) {
        largest = std::max(largest, size(coefficient));
      }
      sum_ += largest;
    }
    [[nodiscard]] constexpr auto holds() const -> bool { return sum_ < std::int64_t{256} << Q24::kFrac; }

   private:
    static constexpr auto size(Q24 x) -> std::int64_t { return x.raw() < 0 ? -std::int64_t{x.raw()} : x.raw(); }
    std::int64_t sum_ = 0;
  };
  template <std::size_t Count>
  static constexpr auto holds(const std::array<Q24, Count>& coefficients) -> bool {
    Reach reach;
    reach.add(coefficients);
    return reach.holds();
  }

 private:
  std::int64_t total_ = std::int64_t{1} << (Q24::kFrac - 1);  // 2^-48; half a unit, so that the end rounds
  bool cut_ = false;
};

}  // namespace capstan
