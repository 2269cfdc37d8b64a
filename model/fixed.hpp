// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <limits>
#include <type_traits>

#ifdef __ARM_FEATURE_DSP
#include <arm_acle.h>
#endif

namespace capstan {

/// The number itself. Says to the compiler no more than that it has 32 bits: without that GCC carries what it knows of
/// the sign from branch to branch, and then multiplies 64 bits by 64 where 32 by 32 would do.
constexpr auto just_32_bits(std::int32_t value) -> std::int32_t {
  if (!std::is_constant_evaluated()) {
    asm("" : "+r"(value));
  }
  return value;
}

/// The nearest number that the narrow type has. The test is on the way there and back: it costs one comparison on every
/// target, where clamping in the wide type costs four.
template <typename Wide, typename Narrow>
constexpr auto narrow_saturating(Wide value) -> Narrow {
  static_assert(std::is_signed_v<Wide> == std::is_signed_v<Narrow> && sizeof(Wide) > sizeof(Narrow));
  const auto narrow = static_cast<Narrow>(value);
  if (narrow == value) [[likely]] {
    return narrow;
  }
  if constexpr (std::is_signed_v<Wide>) {
    return value < 0 ? std::numeric_limits<Narrow>::min() : std::numeric_limits<Narrow>::max();
  } else {
    return std::numeric_limits<Narrow>::max();
  }
}

/// Divides by 2^Bits, rounding to nearest and ties towards plus infinity: the one rounding rule of the project. Chosen
/// because it is one add and one shift on every target, so all targets agree bit for bit.
/// @pre |value| <= 2^62, which every product of two 32-bit numbers meets
template <int Bits>
constexpr auto shift_right_rounded(std::int64_t value) -> std::int64_t {
  static_assert(Bits >= 0 && Bits < 63);
  if constexpr (Bits == 0) {
    return value;
  } else {
    return (value + (std::int64_t{1} << (Bits - 1))) >> Bits;
  }
}

/// a b in 64 bits: one instruction on every target.
constexpr auto wide_product(std::int32_t a, std::int32_t b) -> std::int64_t {
  return std::int64_t{a} * b;
}

// What a Cortex-M4 has one instruction for and GCC does not find by itself. Each is the expression beside it, bit for
// bit.

/// a b / 2^32, rounded down. For polynomials whose numbers are known to fit.
constexpr auto high_product(std::int32_t a, std::int32_t b) -> std::int32_t {
#ifdef __ARM_FEATURE_DSP
  if (!std::is_constant_evaluated()) {
    std::int32_t result = 0;
    asm("smmul %0, %1, %2" : "=r"(result) : "r"(a), "r"(b));
    return result;
  }
#endif
  return static_cast<std::int32_t>(wide_product(a, b) >> 32);
}

/// sum + a b / 2^32, rounded down, modulo 2^32: a step of a polynomial, or of an angle that wraps.
constexpr auto high_product_plus(std::int32_t sum, std::int32_t a, std::int32_t b) -> std::int32_t {
#ifdef __ARM_FEATURE_DSP
  if (!std::is_constant_evaluated()) {
    std::int32_t result = 0;
    asm("smmla %0, %1, %2, %3" : "=r"(result) : "r"(a), "r"(b), "r"(sum));
    return result;
  }
#endif
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(sum) + static_cast<std::uint32_t>(high_product(a, b)));
}

constexpr auto saturating_sum(std::int32_t a, std::int32_t b) -> std::int32_t {
#ifdef __ARM_FEATURE_DSP
  if (!std::is_constant_evaluated()) {
    return __qadd(a, b);
  }
#endif
  std::int32_t sum = 0;
  if (__builtin_add_overflow(a, b, &sum)) [[unlikely]] {
    return b < 0 ? std::numeric_limits<std::int32_t>::min() : std::numeric_limits<std::int32_t>::max();
  }
  return sum;
}

constexpr auto saturating_difference(std::int32_t a, std::int32_t b) -> std::int32_t {
#ifdef __ARM_FEATURE_DSP
  if (!std::is_constant_evaluated()) {
    return __qsub(a, b);
  }
#endif
  std::int32_t difference = 0;
  if (__builtin_sub_overflow(a, b, &difference)) [[unlikely]] {
    return b < 0 ? std::numeric_limits<std::int32_t>::max() : std::numeric_limits<std::int32_t>::min();
  }
  return difference;
}

/// sum + a b. As GCC sees it, it may multiply 64 bits by 64: where it has taken a factor's sign before.
constexpr auto wide_product_plus(std::int64_t sum, std::int32_t a, std::int32_t b) -> std::int64_t {
#ifdef __ARM_FEATURE_DSP
  if (!std::is_constant_evaluated()) {
    asm("smlal %Q0, %R0, %1, %2" : "+r"(sum) : "r"(a), "r"(b));
    return sum;
  }
#endif
  return sum + wide_product(a, b);
}

/// a b in 64 bits, for the same reason; of sums GCC makes more if it is left to itself.
constexpr auto lone_product(std::int32_t a, std::int32_t b) -> std::int64_t {
#ifdef __ARM_FEATURE_DSP
  if (!std::is_constant_evaluated()) {
    std::uint32_t lower = 0;
    std::int32_t upper = 0;
    asm("smull %0, %1, %2, %3" : "=r"(lower), "=r"(upper) : "r"(a), "r"(b));
    return std::int64_t{upper} << 32 | lower;
  }
#endif
  return wide_product(a, b);
}

/// The lower 32 bits of shift_right_rounded: the last bit that is shifted out is the carry that rounds.
template <int Bits>
constexpr auto low_word_rounded(std::int64_t value) -> std::int32_t {
  static_assert(Bits > 0 && Bits < 32);
#ifdef __ARM_FEATURE_DSP
  if (!std::is_constant_evaluated()) {
    auto word = static_cast<std::int32_t>(value);
    const auto upper = static_cast<std::int32_t>(value >> 32);
    asm("lsrs %0, %0, %2\n\tadc %0, %0, %1, lsl %3" : "+&r"(word) : "r"(upper), "n"(Bits), "n"(32 - Bits) : "cc");
    return word;
  }
#endif
  return static_cast<std::int32_t>(shift_right_rounded<Bits>(value));
}

/// Nearest to shift_right_rounded of what 32 bits have. The upper word alone tells of half of that range that it fits.
template <int Bits>
constexpr auto narrow_rounded(std::int64_t value) -> std::int32_t {
  const auto upper = static_cast<std::uint32_t>(value >> 32);
  if (upper + (1U << (Bits - 2)) < 1U << (Bits - 1)) [[likely]] {
    return low_word_rounded<Bits>(value);
  }
  return narrow_saturating<std::int64_t, std::int32_t>(shift_right_rounded<Bits>(value));
}

/// Signed fixed-point number raw * 2^-Frac. Every operation is exact, then rounded by shift_right_rounded and saturated
/// at the ends of Rep; nothing wraps. Conversions are explicit. Range [-2^(31-Frac), 2^(31-Frac)) for Rep
/// = int32_t, resolution 2^-Frac.
template <typename Rep, int Frac>
class Fixed {
  static_assert(std::is_same_v<Rep, std::int32_t>, "products are widened to 64 bits, so Rep has 32");
  static_assert(Frac >= 0 && Frac < 32);

 public:
  using rep = Rep;
  static constexpr int kFrac = Frac;

  constexpr Fixed() = default;
  static constexpr auto from_raw(Rep raw) -> Fixed {
    Fixed result;
    result.raw_ = raw;
    return result;
  }
  /// Saturates a 64-bit raw value (already scaled by 2^Frac).
  static constexpr auto from_wide(std::int64_t raw) -> Fixed {
    return from_raw(just_32_bits(narrow_saturating<std::int64_t, Rep>(raw)));
  }
  /// Nearest value, saturated. NaN becomes 0: callers that can meet NaN check first (the cycle never converts from
  /// double). Always inlined, so that a constant stays one on the target, where no double may be left.
  [[gnu::always_inline]] static constexpr auto from_double(double value) -> Fixed {
    const double scaled = value * static_cast<double>(std::int64_t{1} << Frac);
    if (!(scaled > static_cast<double>(std::numeric_limits<Rep>::min()))) {
      return scaled == scaled ? lowest() : Fixed{};
    }
    if (scaled >= static_cast<double>(std::numeric_limits<Rep>::max())) {
      return max();
    }
    const auto truncated = static_cast<std::int64_t>(scaled);
    const std::int64_t below = static_cast<double>(truncated) > scaled ? truncated - 1 : truncated;
    // Not floor(scaled + 0.5): that sum is itself rounded, and takes the number below one half up to one.
    return from_raw(
        narrow_saturating<std::int64_t, Rep>(scaled - static_cast<double>(below) >= 0.5 ? below + 1 : below));
  }
  static constexpr auto from_int(std::int32_t value) -> Fixed {
    return from_wide(static_cast<std::int64_t>(value) * (std::int64_t{1} << Frac));
  }
  static constexpr auto max() -> Fixed { return from_raw(std::numeric_limits<Rep>::max()); }
  static constexpr auto lowest() -> Fixed { return from_raw(std::numeric_limits<Rep>::min()); }

  [[nodiscard]] constexpr auto raw() const -> Rep { return raw_; }
  [[nodiscard]] constexpr auto to_double() const -> double {
    return static_cast<double>(raw_) / static_cast<double>(std::int64_t{1} << Frac);
  }
  /// True at either end of the range: the value may have been cut, so whoever computed it must say so.
  [[nodiscard]] constexpr auto is_saturated() const -> bool {
    // Both ends have every bit of their magnitude set: the law asks this of every number it makes.
    Rep above = 0;
    return __builtin_add_overflow(raw_ ^ (raw_ >> 31), 1, &above);
  }

  friend constexpr auto operator==(Fixed a, Fixed b) -> bool { return a.raw_ == b.raw_; }
  friend constexpr auto operator<=>(Fixed a, Fixed b) -> std::strong_ordering { return a.raw_ <=> b.raw_; }

  constexpr auto operator-() const -> Fixed { return Fixed{} - *this; }
  friend constexpr auto operator+(Fixed a, Fixed b) -> Fixed { return from_raw(saturating_sum(a.raw_, b.raw_)); }
  friend constexpr auto operator-(Fixed a, Fixed b) -> Fixed { return from_raw(saturating_difference(a.raw_, b.raw_)); }
  /// The right factor may have another format; the product has the format of the left one.
  template <int OtherFrac>
  friend constexpr auto operator*(Fixed a, Fixed<Rep, OtherFrac> b) -> Fixed {
    return from_raw(narrow_rounded<OtherFrac>(lone_product(a.raw_, b.raw())));
  }
  /// The same where the product is known to fit, so that nothing is left to test. @pre |a b| fits
  template <int OtherFrac>
  [[nodiscard]] constexpr auto fitting_product(Fixed<Rep, OtherFrac> b) const -> Fixed {
    return from_raw(low_word_rounded<OtherFrac>(lone_product(raw_, b.raw())));
  }
  /// Rounded by the one rule. Division by zero saturates with the sign of the dividend; 0/0 is 0.
  friend constexpr auto operator/(Fixed a, Fixed b) -> Fixed { return divide<Frac>(a.raw_, b.raw_); }
  constexpr auto operator+=(Fixed b) -> Fixed& { return *this = *this + b; }
  constexpr auto operator-=(Fixed b) -> Fixed& { return *this = *this - b; }

  /// numerator / denominator of one format, the quotient in this one (for gains below 2 from quantities, say).
  template <int OtherFrac>
  static constexpr auto ratio(Fixed<Rep, OtherFrac> numerator, Fixed<Rep, OtherFrac> denominator) -> Fixed {
    return divide<Frac>(numerator.raw(), denominator.raw());
  }

 private:
  template <int Shift>
  static constexpr auto divide(std::int64_t a, std::int64_t b) -> Fixed {
    if (b == 0) {
      return a == 0 ? Fixed{} : (a > 0 ? max() : lowest());
    }
    const std::int64_t divisor = b < 0 ? -b : b;
    // |a| <= 2^31 and Shift <= 31, so the sum below fits in 63 bits.
    const std::int64_t dividend = (b < 0 ? -a : a) * (std::int64_t{1} << Shift) + divisor / 2;
    const std::int64_t quotient = dividend / divisor;
    return from_wide(quotient * divisor > dividend ? quotient - 1 : quotient);  // floor, as a shift would
  }

  Rep raw_ = 0;
};

/// Quantities (rad, N m, rad/s, coefficients): +-128 with a resolution of 6.0e-8.
using Q24 = Fixed<std::int32_t, 24>;
/// Gains of filters and other factors below 2: +-2 with a resolution of 9.3e-10.
using Q30 = Fixed<std::int32_t, 30>;

template <typename Rep, int Frac>
constexpr auto abs(Fixed<Rep, Frac> x) -> Fixed<Rep, Frac> {
  const Rep sign = x.raw() >> 31;
  return Fixed<Rep, Frac>::from_raw(saturating_difference(x.raw() ^ sign, sign));
}

}  // namespace capstan
