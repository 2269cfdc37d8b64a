// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/angle_periodic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

static_assert(SumTerm<AnglePeriodic<double>, double> && SumTerm<AnglePeriodic<Q24>, Q24>);

template <typename Scalar>
class Periodic : public testing::Test {
 protected:
  static auto make(double order) -> AnglePeriodic<Scalar> {
    return AnglePeriodic<Scalar>(one_khz<Scalar>(), {number<Scalar>(order)});
  }
  static auto at(double q1) -> Sample<Scalar> { return {.q1 = number<Scalar>(q1)}; }
};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Periodic, Formats);

TYPED_TEST(Periodic, IsSineAndCosineOfTheOrderTimesTheMotorAngle) {
  std::mt19937 engine(9);
  std::uniform_real_distribution<double> any(-128.0, 128.0);
  for (const double order : {0.5, 1.0, 5.0, 12.25, 35.0, 120.0}) {
    auto term = this->make(order);
    for (int i = 0; i < 20000; ++i) {
      const auto sample = this->at(any(engine));
      const double angle = order * value_of(sample.q1);
      const auto phi = term.update(sample);
      ASSERT_NEAR(value_of(phi[0]), std::sin(angle), (std::is_same_v<TypeParam, double>) ? 1e-15 : 4.5e-8) << angle;
      ASSERT_NEAR(value_of(phi[1]), std::cos(angle), (std::is_same_v<TypeParam, double>) ? 1e-15 : 4.5e-8) << angle;
      ASSERT_EQ(term.steady_state(sample), phi);
    }
  }
}

// A period on, a turn on, from one end of the range to the other: nothing may change but the rounding of the angle.
TYPED_TEST(Periodic, ComesBackAfterEveryPeriod) {
  constexpr double kOrder = 35.0;
  auto term = this->make(kOrder);
  const auto start = term.update(this->at(-127.0));
  for (int period = 1; period <= 1410; ++period) {
    const auto phi = term.update(this->at(-127.0 + 2.0 * std::numbers::pi * period / kOrder));
    const double bound = (std::is_same_v<TypeParam, double>) ? 1e-11 : kOrder * test::kLsb + 9e-8;
    ASSERT_NEAR(value_of(phi[0]), value_of(start[0]), bound) << period;
    ASSERT_NEAR(value_of(phi[1]), value_of(start[1]), bound) << period;
  }
}

// A disc whose centre is off its axis by the share e of its radius is read at atan2(sin + e sin(alpha), cos + e
// cos(alpha)) instead of at theta: to first order an error e sin(alpha - theta), with e^2 / 2 left over.
TYPED_TEST(Periodic, DescribesAnEccentricEncoderDisc) {
  constexpr double kOff = 0.01;
  constexpr double kAlpha = 0.8;
  constexpr double kGear = 5.0;
  auto term = this->make(kGear);
  for (double q1 = -3.0; q1 < 3.0; q1 += 0.0173) {
    const double theta = kGear * q1;
    const double seen =
        std::atan2(std::sin(theta) + kOff * std::sin(kAlpha), std::cos(theta) + kOff * std::cos(kAlpha));
    const double error = std::remainder(seen - theta, 2.0 * std::numbers::pi);
    const auto phi = term.update(this->at(q1));
    const double law = kOff * (std::sin(kAlpha) * value_of(phi[1]) - std::cos(kAlpha) * value_of(phi[0]));
    ASSERT_NEAR(law, error, 0.6 * kOff * kOff) << q1;
  }
}

}  // namespace
}  // namespace capstan
