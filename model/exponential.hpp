// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>

#include "capstan/model/scalar.hpp"

namespace capstan {

/// 1 - e^-|a/b|, the share of the way that something goes which fades with a over the scale b. b <= 0 counts as
/// nothing: all the way. In fixed point within 5e-9, and within 1e-6 of itself plus 2e-9 where it is small.
inline auto share_gone(double a, double b) -> double {
  return b > 0.0 ? -std::expm1(-abs(a) / b) : 1.0;
}
/// (1 - e^-x) / x, the mean of e^-t over [0, x]: right to the last digits at small x as well; 1 at 0. In fixed point,
/// x >= 0 only, within 5e-8.
inline auto mean_decay(double x) -> double {
  return x == 0.0 ? 1.0 : -std::expm1(-x) / x;
}
/// e^-(r^2). In fixed point within 6e-8.
inline auto bell(double r) -> double {
  return std::exp(-r * r);
}

namespace detail {

/// 1 - 2^-y for y >= 0 in units of 2^-58, below 32: 2^-32 is a quarter of the last place of Q30.
constexpr auto share_gone_of(std::uint64_t y) -> Q30 {
  // 2^-y = 2^-n 2^-f, and 2^-f - 1 = f q(f) with the q of degree 5 that is off by 1.5e-9 at most: nothing at f = 0.
  // Each step takes one bit more of the sum before, so the smaller coefficients are kept finer. All in 2^-31.
  constexpr std::int32_t kOne = Q30::from_int(1).raw();
  constexpr std::int32_t kQ0 = Q30::from_double(-0.693147089400 * 2).raw();
  constexpr std::int32_t kQ1 = Q30::from_double(0.240224711051 * 4).raw();
  constexpr std::int32_t kQ2 = Q30::from_double(-0.055492297321 * 8).raw();
  constexpr std::int32_t kQ3 = Q30::from_double(0.009582214112 * 16).raw();
  constexpr std::int32_t kQ4 = Q30::from_double(-0.001277473013 * 32).raw();
  constexpr std::int32_t kQ5 = Q30::from_double(0.000109936021 * 64).raw();
  const auto n = static_cast<int>(y >> 58U);
  const std::int32_t f = just_32_bits(static_cast<std::int32_t>((y >> 27U) & 0x7FFF'FFFFU));
  std::int32_t q = kQ5;
  q = high_product_plus(kQ4, q, f);
  q = high_product_plus(kQ3, q, f);
  q = high_product_plus(kQ2, q, f);
  q = high_product_plus(kQ1, q, f);
  q = high_product_plus(kQ0, q, f);
  return Q30::from_raw(kOne - (high_product_plus(kOne, q, f) >> n));
}

/// 1 - e^-x for x >= 0 in units of 2^-32, below kFarAway.
constexpr auto share_gone_of_e(std::int64_t x) -> Q30 {
  constexpr std::int64_t kLog2E26 = 96'817'625;  // log2 e, 2^-26: with x below 2^36.5 the product stays below 2^63
  return share_gone_of(static_cast<std::uint64_t>(x * kLog2E26));
}

inline constexpr std::int64_t kFarAway = 22;  ///< e^-22 counts as nothing

}  // namespace detail

constexpr auto share_gone(Q24 a, Q24 b) -> Q30 {
  const std::int64_t distance = abs(a).raw();
  const std::int64_t scale = b.raw();
  if (scale <= 0 || distance >= detail::kFarAway * scale) {
    return Q30::from_int(1);
  }
  return detail::share_gone_of_e((distance << 32) / scale);
}

/// share_gone(a, b) for a scale that stays, without the division. In fixed point within 1e-8, a scale below 2^-22
/// counting as nothing.
template <typename Scalar>
class FadingScale {
 public:
  constexpr explicit FadingScale(Scalar scale) : scale_(scale) {}
  [[nodiscard]] auto share_gone(Scalar a) const { return capstan::share_gone(a, scale_); }

 private:
  Scalar scale_;
};

template <>
class FadingScale<Q24> {
 public:
  constexpr explicit FadingScale(Q24 scale) {
    if (scale.raw() >= 4) {
      constexpr std::int64_t kLog2E58 = 415'828'534'307'635'078;  // log2 e, 2^-58
      halvings_per_unit_ = static_cast<std::uint64_t>((kLog2E58 + scale.raw() / 2) / scale.raw());
      reach_ = narrow_saturating<std::int64_t, std::int32_t>(detail::kFarAway * scale.raw() - 1);
    }
  }
  [[nodiscard]] constexpr auto share_gone(Q24 a) const -> Q30 {
    const std::int32_t distance = just_32_bits(abs(a).raw());
    if (distance > reach_) {
      return Q30::from_int(1);
    }
    return detail::share_gone_of(static_cast<std::uint32_t>(distance) * halvings_per_unit_);
  }

 private:
  std::uint64_t halvings_per_unit_ = 0;  ///< log2 e over the scale, 2^-58 for a unit of the distance
  std::int32_t reach_ = -1;              ///< the last distance of which something is left
};

constexpr auto mean_decay(Q24 x) -> Q30 {
  // Below an eighth the series, which leaves x^5 / 720; above it the quotient, off by 5e-9 / x.
  constexpr Q24 kSmall = Q24::from_double(0.125);
  constexpr Q30 kOne = Q30::from_int(1);
  if (x.raw() <= 0) {
    return kOne;
  }
  if (x < kSmall) {
    constexpr Q30 kOver120 = Q30::from_double(1.0 / 120.0);
    constexpr Q30 kOver24 = Q30::from_double(1.0 / 24.0);
    constexpr Q30 kOver6 = Q30::from_double(1.0 / 6.0);
    constexpr Q30 kOver2 = Q30::from_double(0.5);
    return kOne - (kOver2 - (kOver6 - (kOver24 - kOver120 * x) * x) * x) * x;
  }
  const std::int64_t gone = share_gone(x, Q24::from_int(1)).raw();
  return Q30::from_wide(((gone << Q24::kFrac) + x.raw() / 2) / x.raw());
}

constexpr auto bell(Q24 r) -> Q24 {
  constexpr Q24 kOne = Q24::from_int(1);
  const std::int64_t square = std::int64_t{r.raw()} * r.raw();  // 2^-48
  if (square >= (detail::kFarAway << 48)) {
    return Q24{};
  }
  return kOne - kOne.fitting_product(detail::share_gone_of_e(square >> 16));
}

}  // namespace capstan
