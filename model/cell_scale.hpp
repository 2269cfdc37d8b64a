// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>

#include "capstan/model/scalar.hpp"

namespace capstan {

/// Where in a cell a number lies, 0 to 1, with one over the cell's width worked out before.
template <typename Scalar>
class CellScale;

template <>
class CellScale<double> {
 public:
  constexpr CellScale() = default;
  constexpr CellScale(double low, double high) : inverse_(1.0 / (high - low)) {}
  /// @pre low <= x <= high
  [[nodiscard]] constexpr auto fraction(double x, double low) const -> double {
    const double fraction = (x - low) * inverse_;
    return fraction < 1.0 ? fraction : 1.0;
  }

 private:
  double inverse_ = 0.0;
};

/// Distance and width are moved up until the width has 32 bits; then the fraction is the upper half of one product, and
/// right to one unit in its last place whatever the width.
template <>
class CellScale<Q24> {
 public:
  constexpr CellScale() = default;
  constexpr CellScale(Q24 low, Q24 high) {
    const std::uint32_t width = distance(high, low);
    shift_ = std::countl_zero(width);
    multiplier_ = static_cast<std::uint32_t>((std::uint64_t{1} << 62) / (std::uint64_t{width} << shift_));
  }
  /// @pre low <= x <= high
  [[nodiscard]] constexpr auto fraction(Q24 x, Q24 low) const -> Q30 {
    const std::uint64_t product = std::uint64_t{distance(x, low) << shift_} * multiplier_;
    return Q30::from_raw(static_cast<std::int32_t>(product >> 32));
  }

 private:
  static constexpr auto distance(Q24 high, Q24 low) -> std::uint32_t {
    return static_cast<std::uint32_t>(high.raw()) - static_cast<std::uint32_t>(low.raw());
  }
  std::uint32_t multiplier_ = 0;
  int shift_ = 0;
};

}  // namespace capstan
