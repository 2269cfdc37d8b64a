// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/presliding.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <vector>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::kLsb;
using test::number;
using test::one_khz;
using test::value_of;

static_assert(SumTerm<Presliding<double>, double> && SumTerm<Presliding<Q24>, Q24>);

constexpr double kWidth = 0.02;

template <typename Scalar>
auto make(double width = kWidth) -> Presliding<Scalar> {
  return Presliding<Scalar>(one_khz<Scalar>(), {number<Scalar>(width)});
}
template <typename Scalar>
auto lag(Presliding<Scalar>& term, double q1) -> double {
  return value_of(term.update({.q1 = number<Scalar>(q1)})[0]);
}

/// dz/dq = 1 - sgn(dq) z / z0 by Runge-Kutta along the path, in steps of at most z0 / 500.
auto integrate(double z, double from, double to, double width) -> double {
  const int steps = 1 + static_cast<int>(500.0 * std::fabs(to - from) / width);
  const double h = (to - from) / steps;
  const double sign = h < 0.0 ? -1.0 : 1.0;
  const auto slope = [&](double at) { return 1.0 - sign * at / width; };
  for (int i = 0; i < steps; ++i) {
    const double k1 = slope(z);
    const double k2 = slope(z + 0.5 * h * k1);
    const double k3 = slope(z + 0.5 * h * k2);
    const double k4 = slope(z + h * k3);
    z += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return z;
}

RC_GTEST_PROP(PreslidingProperties, IsTheSolutionOfDahlsEquationForAnyMotion, ()) {
  const double width = 1e-4 * *rc::gen::inRange(5, 10000);
  auto exact = make<double>(width);
  auto fixed = make<Q24>(width);
  double q1 = 0.3;
  double z = 0.0;
  lag(exact, q1);
  lag(fixed, q1);
  double error = 0.0;
  for (const std::int32_t step : *rc::gen::container<std::vector<std::int32_t>>(rc::gen::inRange(-900, 900))) {
    const double next = q1 + 1e-4 * step;
    z = integrate(z, q1, next, width);
    // Half a unit in q1 before and after; what came before fades as z itself does.
    error = error * std::exp(-std::fabs(next - q1) / width) + kLsb;
    q1 = next;
    RC_ASSERT(std::fabs(lag(exact, q1) + z) < 1e-9);
    RC_ASSERT(std::fabs(lag(fixed, q1) + z) < error + 2.0 * kLsb + 1e-8 * width);
  }
}

RC_GTEST_PROP(PreslidingProperties, NeverBendsBeyondItsWidth, ()) {
  const Q24 width = Q24::from_raw(*rc::gen::inRange(1, 20000000));
  Presliding<Q24> term(one_khz<Q24>(), {width});
  for (const std::int32_t raw : *rc::gen::arbitrary<std::vector<std::int32_t>>()) {
    const Q24 lag = term.update({.q1 = Q24::from_raw(raw)})[0];
    RC_ASSERT(lag <= width && lag >= -width);
  }
}

template <typename Scalar>
class PreslidingTerm : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(PreslidingTerm, Formats);

// The firmware samples at 1 kHz, a log at 200 Hz: the same path must leave the same lag.
TYPED_TEST(PreslidingTerm, DoesNotDependOnHowAPathIsSampled) {
  auto coarse = make<TypeParam>();
  auto fine = make<TypeParam>();
  lag(coarse, 0.0);
  lag(fine, 0.0);
  double q1 = 0.0;
  for (const double turn : {0.05, 0.031, 0.04, -0.02, 0.1}) {
    constexpr int kSteps = 2000;
    const double from = q1;
    for (int i = 1; i <= kSteps; ++i) {
      q1 = from + (turn - from) * i / kSteps;
      lag(fine, q1);
    }
    EXPECT_NEAR(lag(coarse, turn), lag(fine, turn), (std::is_same_v<TypeParam, double>) ? 1e-12 : 3.0 * kLsb);
  }
}

TYPED_TEST(PreslidingTerm, SettledIsWhereALongMotionEnds) {
  for (const double direction : {1.0, -1.0}) {
    auto term = make<TypeParam>();
    for (int i = 0; i < 1000; ++i) {
      lag(term, direction * 0.001 * i);
    }
    const double last = lag(term, direction);
    EXPECT_NEAR(value_of(term.steady_state({.forward = direction > 0.0})[0]), last, 1.01 * kLsb);
    EXPECT_EQ(last<0.0, direction> 0.0) << "the joint lags behind";
  }
}

// Unlike a play it gives from the first count on: a twentieth of z0 after a full reversal already moves it by a tenth.
TYPED_TEST(PreslidingTerm, GivesWayAtOnceAfterAReversal) {
  auto term = make<TypeParam>();
  lag(term, 0.0);
  const double before = lag(term, 1.0);
  EXPECT_NEAR((lag(term, 1.0 - 0.05 * kWidth) - before) / kWidth, 2.0 * (1.0 - std::exp(-0.05)), 1e-5);
}

TYPED_TEST(PreslidingTerm, StandsStillWithTheMotorAndStartsUnbent) {
  auto term = make<TypeParam>();
  EXPECT_EQ(lag(term, -17.0), 0.0);
  const double bent = lag(term, -17.01);
  for (int i = 0; i < 10000; ++i) {
    ASSERT_EQ(lag(term, -17.01), bent);
  }
}

// Steps of one unit, the slowest motion there is: a state of 24 bits would round every one of them.
TEST(PreslidingFixed, DoesNotDriftInTheSlowestMotion) {
  auto term = make<Q24>(0.5);
  constexpr int kSteps = 4'000'000;
  Q24 lag_now;
  for (int i = 0; i <= kSteps; ++i) {
    lag_now = term.update({.q1 = Q24::from_raw(i)})[0];
  }
  EXPECT_NEAR(lag_now.to_double(), -0.5 * -std::expm1(-kSteps * kLsb / 0.5), 2e-5);
}

}  // namespace
}  // namespace capstan
