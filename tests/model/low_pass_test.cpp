// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/low_pass.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::kLsb;
using test::number;
using test::one_khz;
using test::value_of;

template <typename Scalar>
class Filter : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Filter, Formats);

/// After k steps towards u from x0 with gain dt / (T + dt) the rest of the way is (T / (T + dt))^k.
auto after(int k, double time_constant_s, double from, double to) -> double {
  return to + (from - to) * std::pow(time_constant_s / (time_constant_s + 0.001), k);
}

TYPED_TEST(Filter, FollowsTheGeometricSeriesForEveryTimeConstant) {
  for (const double time_s : {0.0005, 0.0137, 0.3, 7.1, 119.0}) {
    const double exact_time = value_of(number<TypeParam>(time_s));
    LowPass<TypeParam> filter(one_khz<TypeParam>(), number<TypeParam>(time_s));
    filter.start(number<TypeParam>(-3.0));
    for (int k = 1; k <= 200000; ++k) {
      const double x = value_of(filter.update(number<TypeParam>(5.0)));
      if (k % 997 == 0 || k < 10) {
        // 30 bits of the gain are 1e-9 of T; half a unit of rounding to read it, and half for the distance.
        ASSERT_NEAR(x, after(k, exact_time, -3.0, 5.0), 1.1 * kLsb) << "T " << time_s << " s, step " << k;
      }
    }
  }
}

TYPED_TEST(Filter, ReachesItsTargetEvenWithATimeConstantOfHours) {
  LowPass<TypeParam, 60> filter(one_khz<TypeParam>(), number<TypeParam>(2.0));
  filter.start(number<TypeParam>(0.0));
  for (int k = 0; k < 2'400'000; ++k) {  // 20 time constants
    filter.update(number<TypeParam>(1.0));
  }
  EXPECT_NEAR(value_of(filter.value()), 1.0, kLsb);
  LowPass<TypeParam, 60> slow(one_khz<TypeParam>(), number<TypeParam>(120.0));
  slow.start(number<TypeParam>(0.0));
  constexpr int kMinute = 60'000;
  for (int k = 0; k < kMinute; ++k) {
    slow.update(number<TypeParam>(1.0));
  }
  EXPECT_NEAR(value_of(slow.value()), 1.0 - after(kMinute, 7200.0, 1.0, 0.0), kLsb);
}

TYPED_TEST(Filter, WithoutATimeConstantLetsEveryBitThrough) {
  for (const double time_s : {0.0, -1.0}) {
    LowPass<TypeParam> filter(one_khz<TypeParam>(), number<TypeParam>(time_s));
    EXPECT_EQ(filter.update(number<TypeParam>(-127.5)), number<TypeParam>(-127.5));
    EXPECT_EQ(filter.update(number<TypeParam>(127.25)), number<TypeParam>(127.25));
  }
}

TEST(FixedFilter, NeverWrapsBetweenTheEndsOfTheRange) {
  LowPass<Q24> filter(one_khz<Q24>(), number<Q24>(0.002));
  filter.start(Q24::lowest());
  for (int i = 0; i < 4000; ++i) {
    const Q24 before = filter.value();
    const Q24 target = i / 100 % 2 == 0 ? Q24::max() : Q24::lowest();
    const Q24 x = filter.update(target);
    ASSERT_TRUE(target > before ? x >= before : x <= before) << i;
  }
}

// A state of 24 bits would stand still half a unit over the gain below its target; this one goes on.
TEST(FixedFilter, DoesNotStandStillShortOfItsTarget) {
  LowPass<Q24> filter(one_khz<Q24>(), number<Q24>(1.0));
  filter.start(number<Q24>(0.5));
  const Q24 target = number<Q24>(0.5) + Q24::from_raw(400);
  for (int i = 0; i < 20000; ++i) {
    filter.update(target);
  }
  EXPECT_NEAR(filter.value().to_double(), target.to_double(), 0.51 * kLsb);
}

}  // namespace
}  // namespace capstan
