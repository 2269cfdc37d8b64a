// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/scalar.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace capstan {
namespace {

constexpr double kQ30Lsb = 1.0 / (1 << 30);

static_assert(clamp(3.0, -1.0, 2.0) == 2.0 && clamp(-3.0, -1.0, 2.0) == -1.0 && clamp(0.5, -1.0, 2.0) == 0.5);
static_assert(clamp(Q24::from_int(3), Q24::from_int(-1), Q24::from_int(2)) == Q24::from_int(2));
static_assert(abs(-2.5) == 2.5 && abs(0.0) == 0.0);
static_assert(ScalarTraits<double>::is_missing(ScalarTraits<double>::missing()) &&
              !ScalarTraits<double>::is_missing(-1e300));
static_assert(ScalarTraits<double>::is_missing(std::numeric_limits<double>::infinity()));
static_assert(ScalarTraits<Q24>::is_missing(ScalarTraits<Q24>::missing()) && !ScalarTraits<Q24>::is_missing(Q24{}));
static_assert(ScalarTraits<Q24>::gain(Q24::from_int(1), Q24::from_int(8)) == Q30::from_double(0.125));

TEST(SamplePeriod, RateOfARampIsItsSlopeInBothFormats) {
  EXPECT_DOUBLE_EQ(SamplePeriod<double>(0.001).rate_of(0.002), 2.0);
  // 2^-9 rad per millisecond has an exact fixed-point form, so the rate is exact as well.
  EXPECT_EQ(SamplePeriod<Q24>(1000).rate_of(Q24::from_double(1.0 / 512.0)), Q24::from_double(1000.0 / 512.0));
}

TEST(SamplePeriod, RateBeyondTheRangeSaturatesInsteadOfWrapping) {
  EXPECT_EQ(SamplePeriod<Q24>(1000).rate_of(Q24::from_double(0.2)), Q24::max());
  EXPECT_EQ(SamplePeriod<Q24>(10000).rate_of(Q24::lowest()), Q24::lowest());
}

RC_GTEST_PROP(SamplePeriod, FixedFilterGainIsTheExactOneToALastPlace, ()) {
  const std::int32_t rate_hz = *rc::gen::inRange(1, 10001);
  const Q24 time_constant = Q24::from_raw(*rc::gen::inRange(0, 1 << 27));
  const double exact = 1.0 / (time_constant.to_double() * rate_hz + 1.0);
  RC_ASSERT(std::fabs(SamplePeriod<Q24>(rate_hz).filter_gain(time_constant).to_double() - exact) <= 0.51 * kQ30Lsb);
  RC_ASSERT(std::fabs(SamplePeriod<double>(1.0 / rate_hz).filter_gain(time_constant.to_double()) - exact) <= 1e-14);
}

TEST(SamplePeriod, NoTimeConstantMeansNoFilter) {
  EXPECT_EQ(SamplePeriod<double>(0.001).filter_gain(0.0), 1.0);
  EXPECT_EQ(SamplePeriod<Q24>(1000).filter_gain(Q24{}), Q30::from_int(1));
}

TEST(SamplePeriod, TimeConstantBelowZeroCountsAsNone) {
  EXPECT_EQ(SamplePeriod<double>(0.001).filter_gain(-0.001), 1.0);
  for (std::int32_t raw = -20000; raw < 0; raw += 7) {  // crosses T = -dt, where the plain formula divides by zero
    ASSERT_EQ(SamplePeriod<Q24>(1000).filter_gain(Q24::from_raw(raw)), Q30::from_int(1)) << raw;
  }
  EXPECT_EQ(SamplePeriod<Q24>(10000).filter_gain(Q24::lowest()), Q30::from_int(1));
}

RC_GTEST_PROP(SamplePeriod, WholeAndFractionOfADurationAddUpToIt, ()) {
  const std::int32_t rate_hz = *rc::gen::inRange(1, 10001);
  const Q24 duration = Q24::from_raw(*rc::gen::inRange(0, std::numeric_limits<std::int32_t>::max()));
  std::int32_t whole = -1;
  Q30 fraction;
  SamplePeriod<Q24>(rate_hz).split(duration, whole, fraction);
  RC_ASSERT(whole >= 0 && fraction.raw() >= 0 && fraction < Q30::from_int(1));
  RC_ASSERT(whole + fraction.to_double() == duration.to_double() * rate_hz);  // exact: 47 bits at most

  double double_fraction = -1.0;
  SamplePeriod<double>(1.0 / rate_hz).split(duration.to_double(), whole, double_fraction);
  RC_ASSERT(double_fraction >= 0.0 && double_fraction < 1.0);
  RC_ASSERT(std::fabs(whole + double_fraction - duration.to_double() * rate_hz) <= 1e-8);
}

TEST(SamplePeriod, DurationsOutsideAllReasonAreCutInsteadOfUndefined) {
  std::int32_t whole = -1;
  double fraction = -1.0;
  Q30 fixed_fraction = Q30::max();
  const SamplePeriod<double> period(0.001);
  for (const double duration : {-1.0, -1e300, std::numeric_limits<double>::quiet_NaN()}) {
    period.split(duration, whole, fraction);
    EXPECT_EQ(whole, 0) << duration;
    EXPECT_EQ(fraction, 0.0) << duration;
  }
  period.split(std::numeric_limits<double>::infinity(), whole, fraction);
  EXPECT_EQ(whole, 1000000000);
  SamplePeriod<Q24>(10000).split(Q24::lowest(), whole, fixed_fraction);
  EXPECT_EQ(whole, 0);
  EXPECT_EQ(fixed_fraction, Q30{});
}

// Where constants are worked out a sum that wraps does not compile.
TEST(Scalar, ANumberShiftedDownRoundsAndDoesNotWrapAtTheEndsOfItsRange) {
  using Traits = ScalarTraits<Q24>;
  static_assert(Traits::shifted_down<1>(Q24::max()).raw() == 1 << 30);
  static_assert(Traits::shifted_down<5>(Q24::max()).raw() == 1 << 26);
  static_assert(Traits::shifted_down<1>(Q24::lowest()).raw() == -(1 << 30));
  for (const auto& [raw, half] :
       {std::pair(3, 2), std::pair(2, 1), std::pair(1, 1), std::pair(-1, 0), std::pair(-3, -1)}) {
    EXPECT_EQ(Traits::shifted_down<1>(Q24::from_raw(raw)).raw(), half) << raw;
  }
}

}  // namespace
}  // namespace capstan
