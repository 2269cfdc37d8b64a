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

/// 2^30 part / whole, rounded down, by one short division and one step of what is left, where a long division of 64
/// bits takes a Cortex-M4 four times as long. @pre part < 2^31, 2^32 <= whole < 2^33, part < whole / 4
constexpr auto quotient_of_part(std::uint32_t part, std::uint64_t whole) -> std::uint32_t {
  const auto most = static_cast<std::uint32_t>(whole >> 17U) + 1;
  const std::uint32_t inverse = 0xFFFF'FFFFU / most;  // of the whole, 2^-49: too small by 2^-13.9 of itself at most
  const auto rough = static_cast<std::uint32_t>((std::uint64_t{part} * inverse) >> 19U);
  const auto low = static_cast<std::uint32_t>(whole);  // whole = 2^32 + low
  std::uint64_t rest = (std::uint64_t{part} << 30U) - (std::uint64_t{rough} << 32U) - std::uint64_t{rough} * low;
  // Below 2^47, and too small by less than two.
  const auto more =
      static_cast<std::uint32_t>((std::uint64_t{static_cast<std::uint32_t>(rest >> 15U)} * inverse) >> 34U);
  rest -= (std::uint64_t{more} << 32U) + std::uint64_t{more} * low;
  return rough + more + (rest >= whole ? 1 : 0) + (rest >= 2 * whole ? 1 : 0);
}

/// log2 of m, 2^31 <= m < 2^32 in 2^-31, in 2^-32: within 2^-27. With s = (m - c) / (m + c) it is log2 c + 2 / ln 2
/// times s + s^3/3 + s^5/5 + s^7/7, c the square root of 2: |s| stays below 0.172.
constexpr auto log2_of_mantissa(std::uint32_t m) -> std::int64_t {
  constexpr std::uint32_t kRoot = 3'037'000'500;     // sqrt 2, 2^-31
  constexpr std::int32_t kTwoPerLog2 = 774'541'002;  // 2 / ln 2, 2^-28
  constexpr std::int32_t kOne = std::int32_t{1} << 30;
  const std::uint32_t part = m < kRoot ? kRoot - m : m - kRoot;
  const auto size = static_cast<std::int32_t>(quotient_of_part(part, std::uint64_t{m} + kRoot));
  const std::int32_t s = m < kRoot ? -size : size;  // 2^-30
  const auto times = [](std::int32_t a, std::int32_t b) { return static_cast<std::int32_t>(lone_product(a, b) >> 30); };
  const std::int32_t square = times(s, s);
  std::int32_t sum = kOne / 7;
  sum = kOne / 5 + times(sum, square);
  sum = kOne / 3 + times(sum, square);
  sum = kOne + times(sum, square);
  return (std::int64_t{1} << 31) + (lone_product(times(s, sum), kTwoPerLog2) >> 26);  // log2 c is a half
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
