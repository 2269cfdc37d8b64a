// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>

#include "capstan/model/scalar.hpp"

namespace capstan {

/// One over a number that stays, worked out once: x * reciprocal is x / number. A division of fixed point takes a
/// Cortex-M4 a hundred instructions and more, this a quarter of that.
template <typename Scalar>
class Reciprocal {
 public:
  constexpr Reciprocal() = default;
  constexpr explicit Reciprocal(Scalar number) : number_(number) {}
  friend constexpr auto operator*(Scalar x, const Reciprocal& r) -> Scalar { return x / r.number_; }

 private:
  Scalar number_{};
};

/// 31 significant bits, so the quotient is within one unit in its last place up to half of the range, and within one
/// and a half anywhere; it saturates as a quotient does. One over nothing takes all but a unit or two to an end of the
/// range.
template <>
class Reciprocal<Q24> {
 public:
  constexpr Reciprocal() = default;
  constexpr explicit Reciprocal(Q24 number) {
    const std::int64_t size = number.raw() < 0 ? -std::int64_t{number.raw()} : number.raw();
    const int bits = 64 - std::countl_zero(static_cast<std::uint64_t>(size));  // 2^(bits - 1) <= size < 2^bits
    multiplier_ = size > 0 ? narrow_saturating<std::int64_t, std::int32_t>(
                                 ((std::int64_t{1} << (kPrecision + bits)) + size / 2) / size)
                           : std::numeric_limits<std::int32_t>::max();
    multiplier_ = number.raw() < 0 ? -multiplier_ : multiplier_;
    const int shift = size > 0 ? kPrecision + bits - Q24::kFrac : kLeastShift;
    up_ = static_cast<std::uint8_t>(std::max(33 - shift, 0));
    down_ = static_cast<std::uint8_t>(std::max(shift - 33, 0));
  }
  friend constexpr auto operator*(Q24 x, const Reciprocal& r) -> Q24 {
    const std::int32_t moved = just_32_bits(static_cast<std::int32_t>(static_cast<std::uint32_t>(x.raw()) << r.up_));
    if (moved >> r.up_ == x.raw()) [[likely]] {  // or the quotient is beyond a quarter of the range
      return Q24::from_raw(((high_product(moved, r.multiplier_) >> r.down_) + 1) >> 1);
    }
    return Q24::from_wide(shift_right_rounded<1>(wide_product(x.raw(), r.multiplier_) >> (32 - r.up_)));
  }

 private:
  static constexpr int kPrecision = 30;
  static constexpr int kLeastShift = 2;
  // The quotient is multiplier x / 2^shift, rounded. Of the product only the upper word is needed where x is moved up
  // first, and all of it fits.
  std::int32_t multiplier_ = 0;
  std::uint8_t up_ = 0;    ///< 33 - shift
  std::uint8_t down_ = 0;  ///< shift - 33; one of the two is nothing
};

/// a / b within 2^-13 of itself, for a step that is checked afterwards: a fifth of a division's instructions on a
/// Cortex-M4. @pre b > 0
constexpr auto rough_quotient(double a, double b) -> double {
  return a / b;
}
constexpr auto rough_quotient(Q24 a, Q24 b) -> Q24 {
  constexpr int kBits = 16;
  const auto size = static_cast<std::uint32_t>(abs(a).raw());
  const int up = size > 0 ? std::countl_zero(size) - 1 : 0;
  const int down = std::max(0, 32 - kBits - std::countl_zero(static_cast<std::uint32_t>(b.raw())));
  const std::int32_t quotient = (a.raw() * (1 << up)) / (b.raw() >> down);
  const int shift = Q24::kFrac - up - down;
  return shift >= 0 ? Q24::from_wide(quotient * (std::int64_t{1} << shift)) : Q24::from_raw(quotient >> -shift);
}

}  // namespace capstan
