// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/exponential.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

namespace capstan {
namespace {

auto gone(Q24 a, Q24 b) -> double {
  return static_cast<double>(
      -std::expm1(-std::fabs(static_cast<long double>(a.to_double())) / static_cast<long double>(b.to_double())));
}

TEST(ShareGone, IsWithinFiveBillionthsForAnyDistanceAndScale) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> bits(0.0, 31.0);
  double worst = 0.0;
  double worst_small = 0.0;
  double worst_fading = 0.0;
  for (int i = 0; i < 2000000; ++i) {
    const auto magnitude = static_cast<std::int32_t>(std::fmin(std::exp2(bits(engine)), 2147483647.0));
    const Q24 a = Q24::from_raw(i % 2 == 0 ? magnitude : -magnitude);
    const Q24 b = Q24::from_raw(static_cast<std::int32_t>(std::fmin(std::exp2(bits(engine)), 2147483647.0)));
    const double expected = gone(a, b);
    const double error = std::fabs(share_gone(a, b).to_double() - expected);
    worst = std::fmax(worst, error);
    worst_small = std::fmax(worst_small, expected < 0.01 ? error - 1e-6 * expected : 0.0);
    if (b.raw() >= 4) {
      worst_fading = std::fmax(worst_fading, std::fabs(FadingScale<Q24>(b).share_gone(a).to_double() - expected));
    }
  }
  std::printf("1 - e^-x: worst error %.2e, beyond 1e-6 of itself where small %.2e\n", worst, worst_small);
  EXPECT_LT(worst, 5e-9);
  EXPECT_LT(worst_small, 2e-9);
  EXPECT_LT(worst_fading, 1e-8);
  EXPECT_GT(worst_fading, 0.0);
  EXPECT_EQ(FadingScale<Q24>(Q24::from_raw(3)).share_gone(Q24::from_raw(1)), Q30::from_int(1));
}

TEST(ShareGone, IsNothingForNoWayAndAllForAnyWayWithoutAScale) {
  EXPECT_EQ(share_gone(Q24{}, Q24::from_raw(1)), Q30{});
  EXPECT_EQ(share_gone(Q24::from_raw(1), Q24{}), Q30::from_int(1));
  EXPECT_EQ(share_gone(Q24::from_int(1), Q24::from_int(-1)), Q30::from_int(1));
  EXPECT_EQ(share_gone(Q24::lowest(), Q24::max()), share_gone(Q24::max(), Q24::max()));
  EXPECT_EQ(share_gone(Q24::lowest(), Q24::from_raw(1)), Q30::from_int(1));
  EXPECT_EQ(share_gone(0.0, 1.0), 0.0);
  EXPECT_EQ(share_gone(-1.0, 0.0), 1.0);
}

// Close to each other and over the seams at multiples of ln 2, where the exponent changes.
TEST(ShareGone, NeverFallsAsTheWayGrows) {
  const Q24 scale = Q24::from_double(0.7);
  Q30 before{};
  for (std::int32_t raw = 0; raw < 160'000'000; raw += 997) {
    const Q30 now = share_gone(Q24::from_raw(raw), scale);
    ASSERT_GE(now.raw(), before.raw() - 4) << raw;  // 4e-9
    ASSERT_LE(now, Q30::from_int(1));
    before = now;
  }
}

TEST(Bell, IsWithinTheStatedErrorOverTheWholeRange) {
  double worst = 0.0;
  for (std::int64_t raw = Q24::lowest().raw(); raw <= Q24::max().raw();
       raw += raw > -90'000'000 && raw < 90'000'000 ? 101 : 100003) {
    const Q24 r = Q24::from_raw(static_cast<std::int32_t>(raw));
    const double x = r.to_double();
    worst = std::fmax(worst, std::fabs(bell(r).to_double() - std::exp(-x * x)));
  }
  std::printf("e^-(r^2): worst error %.2e\n", worst);
  EXPECT_LT(worst, 6e-8);
  EXPECT_EQ(bell(Q24{}), Q24::from_int(1));
  EXPECT_EQ(bell(Q24::lowest()), Q24{});
}

}  // namespace
}  // namespace capstan
