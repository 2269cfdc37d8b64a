// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/slip_propagation.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <vector>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

constexpr double kR = 0.05;
constexpr double kN = static_cast<double>(SlipPropagation<double>::kOperators);

template <typename Scalar>
class Slip : public testing::Test {
 protected:
  static auto make() -> SlipPropagation<Scalar> {
    return SlipPropagation<Scalar>(one_khz<Scalar>(), {number<Scalar>(kR)});
  }
  /// The torque that has arrived, as the elongation shows it: regressor + tau.
  static auto arrived(SlipPropagation<Scalar>& slip, double tau) -> double {
    return value_of(slip.update({.tau = number<Scalar>(tau)})[0]) + tau;
  }
  // Sorted evenly, n operators follow the continuum's parabola to R / (4 n^2): the cell with the kink, by the midpoint
  // rule.
  static constexpr double kBound = kR / (4.0 * kN * kN) + (std::is_same_v<Scalar, double> ? 1e-12 : 12.0 * test::kLsb);
};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Slip, Formats);

// The front reaches the part s / (2 R) of the tendon and the mean change there is half of s: s^2 / (4 R), then s - R.
TYPED_TEST(Slip, ElongationGrowsWithTheSquareOfTheTorqueAfterAReversal) {
  for (const double direction : {1.0, -1.0}) {
    auto slip = this->make();
    this->arrived(slip, 0.0);
    const double start = this->arrived(slip, direction * 1.0);  // fully slipping
    for (double s = 0.0; s < 4.0 * kR; s += 0.0013) {
      const double expected = s < 2.0 * kR ? s * s / (4.0 * kR) : s - kR;
      ASSERT_NEAR(direction * (start - this->arrived(slip, direction * (1.0 - s))), expected, this->kBound) << s;
    }
  }
}

// From no torque, the state of a drive that is switched on, the front starts at once: half the change is the same
// parabola of twice the change, s^2 / (2 R).
TYPED_TEST(Slip, FirstLoadingFollowsTheSameShapeAtHalfTheScale) {
  auto slip = this->make();
  for (double s = 0.0; s < 1.9 * kR; s += 0.0007) {
    const double expected = s < kR ? s * s / (2.0 * kR) : s - kR / 2.0;
    ASSERT_NEAR(this->arrived(slip, s), expected, 2.0 * this->kBound) << s;
  }
}

// Most of the plays of a wide front never move: if they stood where the first sample said, its noise would stay in the
// joint's angle for good.
TYPED_TEST(Slip, NoiseOfTheFirstSampleDoesNotStay) {
  auto noisy = this->make();
  auto quiet = this->make();
  this->arrived(noisy, 0.2 * kR);
  this->arrived(quiet, 0.0);
  for (const double tau : {0.5 * kR, -0.5 * kR, 0.1 * kR}) {
    EXPECT_NEAR(this->arrived(noisy, tau), this->arrived(quiet, tau), 1e-12) << tau;
  }
}

TYPED_TEST(Slip, MinorLoopsClose) {
  auto slip = this->make();
  this->arrived(slip, -1.0);
  const double before = this->arrived(slip, 0.3);
  for (const double depth : {0.03, 0.01, 0.06}) {
    this->arrived(slip, 0.3 - depth);
    EXPECT_NEAR(this->arrived(slip, 0.3), before, 1e-6) << depth;
  }
}

TYPED_TEST(Slip, SettledIsWhereALongChangeOfTorqueEnds) {
  for (const bool forward : {true, false}) {
    auto slip = this->make();
    slip.update({.tau = number<TypeParam>(0.0)});
    const double lag = value_of(slip.update({.tau = number<TypeParam>(forward ? 2.0 : -2.0)})[0]);
    const Sample<TypeParam> motion{.forward = forward};
    const double bound = std::is_same_v<TypeParam, double> ? 1e-12 : 9.0 * test::kLsb;
    EXPECT_NEAR(value_of(slip.steady_state(motion)[0]), lag, bound);
    EXPECT_EQ(lag < 0.0, forward);
  }
}

// A share of the torque, gone by 63 % when the torque has changed by R since the motor turned; each direction has its
// own.
TYPED_TEST(Slip, OldStretchFadesWithTheTorqueSinceTheReversal) {
  for (const bool forward : {true, false}) {
    auto slip = this->make();
    for (const double since : {0.0, 0.02, -0.05, 0.3}) {
      constexpr double kTurnedAt = -0.4;
      const double tau = kTurnedAt + since;
      const auto regressors = slip.update(
          {.tau = number<TypeParam>(tau), .forward = forward, .tau_reversal = number<TypeParam>(kTurnedAt)});
      const double expected = tau * std::pow(std::fmax(0.0, 1.0 - std::fabs(since) / (4.0 * kR)), 4);
      EXPECT_NEAR(value_of(regressors[forward ? 1 : 2]), expected, 1e-6) << since;
      EXPECT_EQ(value_of(regressors[forward ? 2 : 1]), 0.0);
    }
  }
}

RC_GTEST_PROP(SlipProperties, FixedFollowsDoubleWithoutDrift, ()) {
  SlipPropagation<double> exact(one_khz<double>(), {kR});
  SlipPropagation<Q24> fixed(one_khz<Q24>(), {number<Q24>(kR)});
  for (const std::int32_t raw : *rc::gen::container<std::vector<std::int32_t>>(rc::gen::inRange(-4000000, 4000000))) {
    const Q24 tau = Q24::from_raw(raw);
    const double expected = exact.update({.tau = tau.to_double()})[0];
    RC_ASSERT(std::fabs(fixed.update({.tau = tau})[0].to_double() - expected) <= 12.0 * test::kLsb);
  }
}

}  // namespace
}  // namespace capstan
