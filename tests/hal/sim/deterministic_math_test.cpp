// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/deterministic_math.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/hal/sim/random.hpp"

namespace capstan::sim {
namespace {

TEST(DeterministicMath, ExpAgreesWithTheLibraryToAFewRoundings) {
  for (double x = -90.0; x < 90.0; x += 0.0137)
    ASSERT_NEAR(det_exp(x) / std::exp(x), 1.0, 4.0e-16) << x;
  EXPECT_EQ(det_exp(0.0), 1.0);
}

TEST(DeterministicMath, SineAndCosineAgreeWithTheLibraryToAFewRoundings) {
  for (double x = -9000.0; x < 9000.0; x += 0.737)
    ASSERT_NEAR(det_sin(x), std::sin(x), 4.0e-16) << x;
  for (double x = -10.0; x < 10.0; x += 0.00137) {
    ASSERT_NEAR(det_sin(x), std::sin(x), 4.0e-16) << x;
    ASSERT_NEAR(det_cos(x), std::cos(x), 2.0e-15) << x;
  }
}

TEST(Random, NormalHasMeanZeroAndDeviationOneAndTails) {
  Random random(1);
  constexpr int kSamples = 200000;
  double sum = 0.0;
  double squares = 0.0;
  int beyond_two = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
    beyond_two += std::fabs(x) > 2.0 ? 1 : 0;
  }
  EXPECT_NEAR(sum / kSamples, 0.0, 0.01);
  EXPECT_NEAR(squares / kSamples, 1.0, 0.015);
  EXPECT_NEAR(static_cast<double>(beyond_two) / kSamples, 0.0455, 0.003);
}

}  // namespace
}  // namespace capstan::sim
