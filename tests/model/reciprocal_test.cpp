// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/reciprocal.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::kLsb;

/// Of every size alike: a number of bits first, then the bits.
auto any_of_any_size() -> Q24 {
  const int bits = *rc::gen::inRange(0, 32);
  const auto raw = static_cast<std::int32_t>(*rc::gen::arbitrary<std::uint32_t>() >> bits);
  return Q24::from_raw(*rc::gen::arbitrary<bool>() ? raw : ~raw);
}

RC_GTEST_PROP(Reciprocal, TimesANumberIsTheQuotientToTheStatedError, ()) {
  const Q24 x = any_of_any_size();
  const Q24 number = any_of_any_size();
  RC_PRE(number != Q24{});
  const double exact = x.to_double() / number.to_double();
  const double within = std::clamp(exact, Q24::lowest().to_double(), Q24::max().to_double());
  const double error = std::fabs((x * Reciprocal<Q24>(number)).to_double() - within);
  RC_ASSERT(error <= (0.5 + std::fabs(within) / 128.0) * kLsb);
}

TEST(Reciprocal, OfAPowerOfTwoIsExact) {
  for (const double number : {0.25, 1.0, -1.0, -4.0}) {
    const Reciprocal<Q24> reciprocal(Q24::from_double(number));
    EXPECT_EQ(Q24::from_double(0.75) * reciprocal, Q24::from_double(0.75 / number)) << number;
    EXPECT_EQ(0.75 * Reciprocal<double>(number), 0.75 / number);
  }
}

TEST(Reciprocal, OfNothingTakesAnyNumberToAnEndOfTheRange) {
  EXPECT_EQ(Q24::from_double(1e-6) * Reciprocal<Q24>(Q24{}), Q24::max());
  EXPECT_EQ(Q24::from_double(-1e-6) * Reciprocal<Q24>(Q24{}), Q24::lowest());
  EXPECT_EQ(Q24{} * Reciprocal<Q24>(Q24{}), Q24{});
}

RC_GTEST_PROP(RoughQuotient, IsWithinTheStatedShareOfTheQuotient, ()) {
  const Q24 a = any_of_any_size();
  const Q24 b = Q24::from_raw(std::max(1, abs(any_of_any_size()).raw()));
  const double exact = a.to_double() / b.to_double();
  const double within = std::clamp(exact, Q24::lowest().to_double(), Q24::max().to_double());
  const double error = std::fabs(rough_quotient(a, b).to_double() - within);
  RC_ASSERT(error <= std::fabs(exact) * 0x1p-13 + kLsb);
}

}  // namespace
}  // namespace capstan
