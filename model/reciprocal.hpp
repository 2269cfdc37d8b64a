// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>

#include "capstan/model/scalar.hpp"

namespace capstan {

/// multiplier x / 2^shift of a factor that stays, rounded and saturated. x is moved up first, so that of the product
/// only the upper word is needed; all of it fits then, and where x can not be moved the quotient is taken from both
/// words.
class ScaledFactor {
 public:
  constexpr ScaledFactor() = default;
  /// @pre 2 <= shift < 65
  constexpr ScaledFactor(std::int32_t multiplier, int shift)
      : multiplier_(multiplier),
        up_(static_cast<std::uint8_t>(std::max(33 - shift, 0))),
        down_(static_cast<std::uint8_t>(std::max(shift - 33, 0))) {}
  [[nodiscard]] constexpr auto operator()(std::int32_t x) const -> std::int32_t {
    const std::int32_t moved = just_32_bits(static_cast<std::int32_t>(static_cast<std::uint32_t>(x) << up_));
    if (moved >> up_ == x) [[likely]] {
      return ((high_product(moved, multiplier_) >> down_) + 1) >> 1;
    }
    return narrow_saturating<std::int64_t, std::int32_t>(
        shift_right_rounded<1>(wide_product(x, multiplier_) >> (32 - up_)));
  }

 private:
  std::int32_t multiplier_ = 0;
  std::uint8_t up_ = 0;    ///< 33 - shift
  std::uint8_t down_ = 0;  ///< shift - 33; one of the two is nothing
};

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
/// and a half anywhere; it saturates as a quotient does. One over nothing takes all but a few units to an end of the
/// range.
template <>
class Reciprocal<Q24> {
 public:
  constexpr Reciprocal() = default;
  constexpr explicit Reciprocal(Q24 number) {
    const std::int64_t size = number.raw() < 0 ? -std::int64_t{number.raw()} : number.raw();
    const int bits = 64 - std::countl_zero(static_cast<std::uint64_t>(size));  // 2^(bits - 1) <= size < 2^bits
    const std::int32_t inverse = size > 0 ? narrow_saturating<std::int64_t, std::int32_t>(
                                                ((std::int64_t{1} << (kPrecision + bits)) + size / 2) / size)
                                          : std::numeric_limits<std::int32_t>::max();
    factor_ = {number.raw() < 0 ? -inverse : inverse, size > 0 ? kPrecision + bits - Q24::kFrac : kLeastShift};
  }
  friend constexpr auto operator*(Q24 x, const Reciprocal& r) -> Q24 { return Q24::from_raw(r.factor_(x.raw())); }

 private:
  static constexpr int kPrecision = 30;
  static constexpr int kLeastShift = 2;
  ScaledFactor factor_;
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
