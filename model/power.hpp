// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>

#include "capstan/model/exponential.hpp"

namespace capstan {

/// x^p for 0 <= x <= 2 and 0 < p <= 4; x <= 0 counts as nothing. In fixed point within 2e-6 and three times as much as
/// the last place of x asks.
inline auto power(double x, double p) -> double {
  return x > 0.0 ? std::pow(x, p) : 0.0;
}

namespace detail {

/// log2 of m, 2^31 <= m < 2^32 in 2^-31, in 2^-32: within 2^-27. With s = (m - c) / (m + c) it is log2 c + 2 / ln 2
/// times s + s^3/3 + s^5/5 + s^7/7, c the square root of 2: |s| stays below 0.172.
constexpr auto log2_of_mantissa(std::uint32_t m) -> std::int64_t {
  constexpr std::int64_t kRoot = 3'037'000'500;         // sqrt 2, 2^-31
  constexpr std::int64_t kTwoPerLog2 = 12'392'656'037;  // 2 / ln 2, 2^-32
  const std::int64_t s = ((std::int64_t{m} - kRoot) * (std::int64_t{1} << 30)) / (std::int64_t{m} + kRoot);  // 2^-30
  const std::int64_t square = (s * s) >> 30;
  std::int64_t sum = (std::int64_t{1} << 30) / 7;
  sum = (std::int64_t{1} << 30) / 5 + ((sum * square) >> 30);
  sum = (std::int64_t{1} << 30) / 3 + ((sum * square) >> 30);
  sum = (std::int64_t{1} << 30) + ((sum * square) >> 30);
  return (std::int64_t{1} << 31) + ((((s * sum) >> 30) * (kTwoPerLog2 >> 4)) >> 26);  // log2 c is a half
}

}  // namespace detail

constexpr auto power(Q24 x, Q24 p) -> Q24 {
  constexpr Q24 kMost = Q24::from_int(2);
  if (x.raw() <= 0 || p.raw() <= 0) {
    return x.raw() <= 0 ? Q24{} : Q24::from_int(1);
  }
  const auto raw = static_cast<std::uint32_t>((x < kMost ? x : kMost).raw());
  const int zeros = std::countl_zero(raw);
  const std::int64_t log2_x =
      (std::int64_t{7 - zeros} << 32) + detail::log2_of_mantissa(raw << static_cast<unsigned>(zeros));
  const std::int64_t y = -((log2_x >> 4) * p.raw() >> 20);  // -p log2 x, 2^-32
  // 2^-y, from -4 on: one more than the whole part is taken out, so that what is left is not negative.
  constexpr std::int64_t kFour = std::int64_t{4} << 32;
  const std::int64_t rest = y > -kFour ? y + kFour : 0;
  if (rest >= (std::int64_t{32} << 32)) {
    return Q24{};
  }
  const std::int64_t left = (std::int64_t{1} << Q30::kFrac) -
                            detail::share_gone_of(static_cast<std::uint64_t>(rest) << 26U).raw();  // 2^-rest, 2^-30
  return Q24::from_wide((left + 2) >> 2);                                                          // times 16, 2^-24
}

}  // namespace capstan
