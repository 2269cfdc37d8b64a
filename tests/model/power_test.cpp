// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/power.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace capstan {
namespace {

TEST(Power, IsWithinThreeMillionthsForAnyBaseAndExponent) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> bits(0.0, 25.0);
  std::uniform_real_distribution<double> exponent(0.02, 4.0);
  double worst = 0.0;
  for (int i = 0; i < 500000; ++i) {
    const Q24 x = Q24::from_raw(static_cast<std::int32_t>(std::exp2(bits(engine))));
    const Q24 p = Q24::from_double(exponent(engine));
    worst = std::fmax(worst, std::fabs(power(x, p).to_double() - std::pow(x.to_double(), p.to_double())));
  }
  EXPECT_LT(worst, 3e-6);
}

TEST(Power, OfNothingIsNothingAndOfOneIsOne) {
  for (const double p : {0.02, 0.5, 1.0, 4.0}) {
    EXPECT_EQ(power(Q24{}, Q24::from_double(p)).raw(), 0);
    EXPECT_EQ(power(Q24::from_double(-0.5), Q24::from_double(p)).raw(), 0);
    EXPECT_NEAR(power(Q24::from_int(1), Q24::from_double(p)).to_double(), 1.0, 3e-7);
    EXPECT_EQ(power(0.0, p), 0.0);
  }
}

TEST(Power, BeyondTwoCountsAsTwo) {
  EXPECT_EQ(power(Q24::from_int(100), Q24::from_int(4)).raw(), power(Q24::from_int(2), Q24::from_int(4)).raw());
  EXPECT_NEAR(power(Q24::from_int(2), Q24::from_int(4)).to_double(), 16.0, 1e-5);
}

}  // namespace
}  // namespace capstan
