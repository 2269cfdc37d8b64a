// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/fixed.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "capstan/model/scalar.hpp"

namespace capstan {
namespace {

__extension__ using Wide = __int128;
using Limits = std::numeric_limits<std::int32_t>;

// The arithmetic rules, checked by the compiler.
static_assert(narrow_saturating<std::int64_t, std::int16_t>(32767 + 13) == 32767);
static_assert(narrow_saturating<std::int64_t, std::int16_t>(-32768 - 13) == -32768);
static_assert(shift_right_rounded<0>(5) == 5);
static_assert(shift_right_rounded<1>(3) == 2, "one and a half goes up");
static_assert(shift_right_rounded<1>(-3) == -1, "minus one and a half goes up too");
static_assert(Q24::max() + Q24::from_raw(1) == Q24::max(), "sums saturate");
static_assert(Q24::lowest() - Q24::from_raw(1) == Q24::lowest());
static_assert(-Q24::lowest() == Q24::max(), "the lowest number has no opposite, so it saturates");
static_assert(abs(Q24::lowest()) == Q24::max());
static_assert(Q24::lowest() * Q24::lowest() == Q24::max());
static_assert(Q24::lowest() / Q24::from_int(-1) == Q24::max());
static_assert(Q24::from_int(128) == Q24::max() && Q24::from_int(-128) == Q24::lowest());
static_assert(Q24::from_int(3) * Q30::from_double(0.5) == Q24::from_double(1.5), "the product has the left format");
static_assert(Q30::ratio(Q24::from_int(1), Q24::from_int(4)) == Q30::from_double(0.25));
static_assert(Q24::from_int(1) / Q24{} == Q24::max() && Q24::from_int(-1) / Q24{} == Q24::lowest());
static_assert(Q24{} / Q24{} == Q24{});
static_assert(Fixed<std::int32_t, 0>::from_double(2.5).raw() == 3 &&
              Fixed<std::int32_t, 0>::from_double(-2.5).raw() == -2);
static_assert(Fixed<std::int32_t, 0>::from_double(0.49999999999999994).raw() == 0, "just below a half goes down");
static_assert(Fixed<std::int32_t, 0>::from_double(-0.5).raw() == 0 &&
              Fixed<std::int32_t, 0>::from_double(-0.51).raw() == -1);
static_assert(Q24::max().is_saturated() && Q24::lowest().is_saturated() && !Q24::from_int(127).is_saturated());
static_assert(!std::is_convertible_v<double, Q24> && !std::is_convertible_v<Q24, double>);
static_assert(!std::is_convertible_v<Q30, Q24> && !std::is_constructible_v<Q24, double>);

TEST(Fixed, TakesWhatIsNotANumberAsZeroAndSaturatesInfinities) {
  EXPECT_EQ(Q24::from_double(std::numeric_limits<double>::quiet_NaN()), Q24{});
  EXPECT_EQ(Q24::from_double(std::numeric_limits<double>::infinity()), Q24::max());
  EXPECT_EQ(Q24::from_double(-std::numeric_limits<double>::infinity()), Q24::lowest());
}

/// Any raw number, with the ends of the range, zero and its neighbours far more often than chance would have them.
auto any_raw() -> rc::Gen<std::int32_t> {
  return rc::gen::oneOf(rc::gen::element(Limits::min(), Limits::min() + 1, Limits::max(), Limits::max() - 1, 0, 1, -1,
                                         1 << 24, -(1 << 24), 1 << 30),
                        rc::gen::arbitrary<std::int32_t>(), rc::gen::inRange(Limits::min(), Limits::max()));
}

auto saturate(Wide exact) -> std::int32_t {
  return exact > Limits::max() ? Limits::max()
                               : (exact < Limits::min() ? Limits::min() : static_cast<std::int32_t>(exact));
}

/// True if `result` is numerator / denominator to the nearest whole number, halves upwards, cut at the ends of 32 bits:
/// result - 1/2 <= n/d < result + 1/2, without dividing.
auto is_nearest(std::int32_t result, Wide numerator, Wide denominator) -> bool {
  if (denominator < 0) {
    numerator = -numerator;
    denominator = -denominator;
  }
  const bool low_enough = result == Limits::min() || (2 * static_cast<Wide>(result) - 1) * denominator <= 2 * numerator;
  const bool high_enough = result == Limits::max() || 2 * numerator < (2 * static_cast<Wide>(result) + 1) * denominator;
  return low_enough && high_enough;
}

RC_GTEST_PROP(Fixed, SumsAndDifferencesAreExactOrSaturated, ()) {
  const std::int32_t a = *any_raw();
  const std::int32_t b = *any_raw();
  RC_ASSERT((Q24::from_raw(a) + Q24::from_raw(b)).raw() == saturate(static_cast<Wide>(a) + b));
  RC_ASSERT((Q24::from_raw(a) - Q24::from_raw(b)).raw() == saturate(static_cast<Wide>(a) - b));
  RC_ASSERT((-Q24::from_raw(a)).raw() == saturate(-static_cast<Wide>(a)));
  RC_ASSERT(abs(Q24::from_raw(a)).raw() == saturate(a < 0 ? -static_cast<Wide>(a) : a));
  Q24 sum = Q24::from_raw(a);
  sum += Q24::from_raw(b);
  RC_ASSERT(sum == Q24::from_raw(a) + Q24::from_raw(b));
}

RC_GTEST_PROP(Fixed, ProductsAreTheNearestNumberHalvesUpwards, ()) {
  const std::int32_t a = *any_raw();
  const std::int32_t b = *any_raw();
  const Wide exact = static_cast<Wide>(a) * b;
  RC_ASSERT(is_nearest((Q24::from_raw(a) * Q24::from_raw(b)).raw(), exact, Wide{1} << 24));
  RC_ASSERT(is_nearest((Q24::from_raw(a) * Q30::from_raw(b)).raw(), exact, Wide{1} << 30));
  RC_ASSERT(is_nearest((Q30::from_raw(a) * Q24::from_raw(b)).raw(), exact, Wide{1} << 24));
}

// What a Cortex-M4 does in one instruction; the replayed run shows that it does the same.
RC_GTEST_PROP(Fixed, StepOfAPolynomialIsTheUpperHalfOfTheExactSumModulo32Bits, ()) {
  const std::int32_t sum = *any_raw();
  const std::int32_t a = *any_raw();
  const std::int32_t b = *any_raw();
  const Wide exact = (static_cast<Wide>(sum) << 32) + static_cast<Wide>(a) * b;
  RC_ASSERT(high_product_plus(sum, a, b) == static_cast<std::int32_t>(static_cast<std::uint32_t>(exact >> 32)));
}

RC_GTEST_PROP(Fixed, PartsAndPlacesBetweenAreTheNearestNumber, ()) {
  const std::int32_t a = *any_raw();
  const std::int32_t b = *any_raw();
  const std::int32_t share = *rc::gen::oneOf(rc::gen::inRange(0, (1 << 30) + 1), rc::gen::element(0, 1, 1 << 30));
  using Traits = ScalarTraits<Q24>;
  const Q30 gain = Q30::from_raw(share);
  RC_ASSERT(is_nearest(Traits::part(Q24::from_raw(a), gain).raw(), static_cast<Wide>(a) * share, Wide{1} << 30));
  const Wide between = static_cast<Wide>(a) * ((1 << 30) - share) + static_cast<Wide>(b) * share;
  RC_ASSERT(is_nearest(Traits::between(Q24::from_raw(a), Q24::from_raw(b), gain).raw(), between, Wide{1} << 30));
}

RC_GTEST_PROP(Fixed, QuotientsAreTheNearestNumberHalvesUpwards, ()) {
  const std::int32_t a = *any_raw();
  const std::int32_t b = *any_raw();
  RC_PRE(b != 0);
  RC_ASSERT(is_nearest((Q24::from_raw(a) / Q24::from_raw(b)).raw(), static_cast<Wide>(a) << 24, b));
  RC_ASSERT(is_nearest(Q30::ratio(Q24::from_raw(a), Q24::from_raw(b)).raw(), static_cast<Wide>(a) << 30, b));
  using Q31 = Fixed<std::int32_t, 31>;
  RC_ASSERT(is_nearest((Q31::from_raw(a) / Q31::from_raw(b)).raw(), static_cast<Wide>(a) << 31, b));
}

RC_GTEST_PROP(Fixed, AgreesWithDoubleToHalfAUnitWhereItDoesNotSaturate, ()) {
  const Q24 a = Q24::from_raw(*any_raw());
  const Q24 b = Q24::from_raw(*any_raw());
  constexpr double kHalf = 0.5 / (1 << 24);
  auto agrees = [](Q24 fixed, double exact) {
    const double cut = std::fmin(std::fmax(exact, Q24::lowest().to_double()), Q24::max().to_double());
    return std::fabs(fixed.to_double() - cut) <= kHalf * (1.0 + 1e-6);
  };
  RC_ASSERT(agrees(a + b, a.to_double() + b.to_double()));
  RC_ASSERT(agrees(a - b, a.to_double() - b.to_double()));
  RC_ASSERT(agrees(a * b, a.to_double() * b.to_double()));
  RC_ASSERT(b == Q24{} || agrees(a / b, a.to_double() / b.to_double()));
}

RC_GTEST_PROP(Fixed, EveryNumberSurvivesTheWayThroughDouble, ()) {
  const std::int32_t raw = *any_raw();
  RC_ASSERT(Q24::from_double(Q24::from_raw(raw).to_double()).raw() == raw);
  RC_ASSERT(Q30::from_double(Q30::from_raw(raw).to_double()).raw() == raw);
}

RC_GTEST_PROP(Fixed, ConversionFromDoubleIsTheNearestNumberHalvesUpwards, ()) {
  // Quarters of a unit are exact in double, so that the expected value can be had in whole numbers.
  const std::int64_t quarters = 4 * static_cast<std::int64_t>(*any_raw()) + *rc::gen::inRange(-3, 4);
  const double value = static_cast<double>(quarters) / (4.0 * (1 << 24));
  RC_ASSERT(is_nearest(Q24::from_double(value).raw(), quarters, 4));
  RC_ASSERT(Q24::from_double(value * 1e6 + 129.0 * 1e6).raw() == Limits::max());
}

RC_GTEST_PROP(Fixed, OrderIsTheOrderOfTheValues, ()) {
  const std::int32_t a = *any_raw();
  const std::int32_t b = *any_raw();
  RC_ASSERT((Q24::from_raw(a) < Q24::from_raw(b)) == (a < b));
  RC_ASSERT((Q24::from_raw(a) == Q24::from_raw(b)) == (a == b));
}

RC_GTEST_PROP(Fixed, RoundingAddsNoBiasBeyondTheTies, ()) {
  // The two neighbours of a number under a shift are never further than half a step away.
  const std::int64_t value = static_cast<std::int64_t>(*any_raw()) * *any_raw();
  const std::int64_t rounded = shift_right_rounded<24>(value);
  const Wide error = (static_cast<Wide>(rounded) << 24) - value;
  RC_ASSERT(error <= (1 << 23) && error > -(1 << 23));
}

}  // namespace
}  // namespace capstan
