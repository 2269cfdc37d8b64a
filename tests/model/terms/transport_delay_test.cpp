// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/transport_delay.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

template <typename Scalar>
class Delay : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Delay, Formats);

template <typename Scalar>
auto make(double delay_s) -> TransportDelay<Scalar> {
  return TransportDelay<Scalar>(one_khz<Scalar>(), {number<Scalar>(delay_s)});
}

// Between samples of a sine the chord is at most (w dt)^2 / 8 off; a delay in fixed point is known to half a unit,
// which moves a sine by w times that.
TYPED_TEST(Delay, GivesTheSignalOfThatLongAgo) {
  constexpr double kOmega = 20.0;
  const double bound =
      kOmega * kOmega * 1e-6 / 8.0 + (std::is_same_v<TypeParam, double> ? 1e-12 : (kOmega + 4.0) * 0.5 * test::kLsb);
  for (const double delay_s : {0.0, 0.0004, 0.001, 0.0123, 0.0375, 0.1195, 0.12}) {
    auto delay = make<TypeParam>(delay_s);
    for (int i = 0; i < 2000; ++i) {
      const double t = 0.001 * i;
      const double late = value_of(delay.update(number<TypeParam>(std::sin(kOmega * t))));
      if (t > delay_s) {
        ASSERT_NEAR(late, std::sin(kOmega * (t - delay_s)), bound) << "delay " << delay_s << " at " << t;
      }
    }
  }
}

TYPED_TEST(Delay, IsExactOnAStraightLine) {
  auto delay =
      make<TypeParam>(0.02125);  // 21.25 samples; the fraction has an exact binary form, the delay itself has not
  const double bound = std::is_same_v<TypeParam, double> ? 1e-12 : 3.0 * test::kLsb;
  for (int i = 0; i < 500; ++i) {
    const double late = value_of(delay.update(number<TypeParam>(0.25 + 0.001 * i)));
    if (i > 22) {
      ASSERT_NEAR(late, 0.25 + 0.001 * (i - 21.25), bound);
    }
  }
}

TYPED_TEST(Delay, OfZeroPassesEveryBitThrough) {
  auto delay = make<TypeParam>(0.0);
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> any(-50.0, 50.0);
  for (int i = 0; i < 1000; ++i) {
    const auto y = number<TypeParam>(any(engine));
    ASSERT_EQ(delay.update(y), y);
  }
}

TYPED_TEST(Delay, HoldsTheFirstValueUntilThereIsAnEarlierOne) {
  auto delay = make<TypeParam>(0.01);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(delay.update(number<TypeParam>(i == 0 ? 2.5 : -9.0)), number<TypeParam>(2.5)) << "sample " << i;
  }
  EXPECT_NEAR(value_of(delay.update(number<TypeParam>(-9.0))), 2.5, 1e-3);  // ten samples, give or take 2e-5
  EXPECT_NEAR(value_of(delay.update(number<TypeParam>(-9.0))), -9.0, 1e-3);
}

TYPED_TEST(Delay, OutsideTheBufferIsCutToIt) {
  auto longest = make<TypeParam>(120.0);
  auto negative = make<TypeParam>(-0.01);
  const std::int32_t held = TransportDelay<TypeParam>::kMaxSamples;
  for (std::int32_t i = 0; i < 3 * held; ++i) {
    const double y = 0.015625 * i;  // exact in both formats
    ASSERT_EQ(value_of(longest.update(number<TypeParam>(y))), i < held ? 0.0 : 0.015625 * (i - held)) << i;
    ASSERT_EQ(value_of(negative.update(number<TypeParam>(y))), y);
  }
}

TEST(DelayOnTheHost, HoldsTheLongestCatalogueDelayAtSeventeenKilohertz) {
  constexpr double kRate = 17000.0;
  const double delay_s = TransportDelay<double>::kInfo.shapes[0].maximum;
  TransportDelay<double> delay(SamplePeriod<double>(1.0 / kRate), {delay_s});
  double late = 0.0;
  for (int i = 0; i <= 3400; ++i) {
    late = delay.update(i / kRate);
  }
  EXPECT_NEAR(late, 0.2 - delay_s, 1e-9);
}

}  // namespace
}  // namespace capstan
