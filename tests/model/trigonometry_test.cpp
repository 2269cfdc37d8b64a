// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/trigonometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

constexpr long double kTwoPi = 6.283185307179586476925286766559L;

TEST(Phase, SineAndCosineAreWithinTheStatedErrorOverTheWholeTurn) {
  double worst = 0.0;
  // A prime step: every quarter is cut at other places.
  for (std::uint64_t turns = 0; turns < (std::uint64_t{1} << 32); turns += 1009) {
    const Phase<Q24> phase(static_cast<std::uint32_t>(turns));
    const long double angle = static_cast<long double>(turns) * (kTwoPi / 4294967296.0L);
    const auto [sine, cosine] = phase.sine_and_cosine();
    worst = std::fmax(worst, std::fabs(sine.to_double() - static_cast<double>(std::sin(angle))));
    worst = std::fmax(worst, std::fabs(cosine.to_double() - static_cast<double>(std::cos(angle))));
  }
  std::printf("sine and cosine of a phase: worst error %.2e\n", worst);
  EXPECT_LT(worst, Phase<Q24>::kSineError);
}

TEST(Phase, QuartersOfATurnAreExactToTheLastPlaceOrTwo) {
  const double sines[] = {0.0, 1.0, 0.0, -1.0};
  for (std::uint32_t quarter = 0; quarter < 4; ++quarter) {
    for (const std::uint32_t off : {0xFFFF'FFFFU, 0U, 1U}) {
      const auto [sine, cosine] = Phase<Q24>(quarter * 0x4000'0000U + off).sine_and_cosine();
      EXPECT_NEAR(sine.to_double(), sines[quarter], 1.01 * test::kLsb);
      EXPECT_NEAR(cosine.to_double(), sines[(quarter + 1) % 4], 1.01 * test::kLsb);
    }
  }
}

// Up to 128 rad times an order of 128 is 2600 turns; nothing may wrap, and the phase may not lose its precision there.
TEST(PhaseScale, KeepsItsPrecisionToTheEndsOfBothNumbers) {
  std::mt19937 engine(7);
  std::uniform_int_distribution<std::int32_t> any(std::numeric_limits<std::int32_t>::min(),
                                                  std::numeric_limits<std::int32_t>::max());
  constexpr double kBound = Phase<Q24>::kSineError + PhaseScale<Q24>::kPhaseError;
  const auto verify = [](Q24 factor, Q24 x) {
    const long double angle = static_cast<long double>(factor.to_double()) * static_cast<long double>(x.to_double());
    const auto [sine, cosine] = PhaseScale<Q24>(factor)(x).sine_and_cosine();
    ASSERT_NEAR(sine.to_double(), static_cast<double>(std::sin(angle)), kBound)
        << factor.to_double() << " times " << x.to_double();
    ASSERT_NEAR(cosine.to_double(), static_cast<double>(std::cos(angle)), kBound)
        << factor.to_double() << " times " << x.to_double();
  };
  for (int i = 0; i < 500000; ++i) {
    verify(Q24::from_raw(any(engine)), Q24::from_raw(any(engine)));
    verify(Q24::from_int(1), Q24::from_raw(any(engine)));
  }
  for (const Q24 factor : {Q24::max(), Q24::lowest(), Q24::from_int(1), Q24::from_raw(1), Q24{}}) {
    for (const Q24 x : {Q24::max(), Q24::lowest(), Q24::from_raw(1), Q24::from_raw(-1), Q24{}}) {
      verify(factor, x);
    }
  }
}

TEST(PhaseScale, OfTheDoubleFormIsTheProduct) {
  const auto [sine, cosine] = PhaseScale<double>(35.0)(-4.2).sine_and_cosine();
  EXPECT_DOUBLE_EQ(sine, std::sin(-147.0));
  EXPECT_DOUBLE_EQ(cosine, std::cos(-147.0));
}

}  // namespace
}  // namespace capstan
