// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/stiffness_hardening.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

static_assert(SumTerm<StiffnessHardening<double>, double> && SumTerm<StiffnessHardening<Q24>, Q24>);

template <typename Scalar>
class Hardening : public testing::Test {
 protected:
  static constexpr double kCubeBelow = 0.002;
  StiffnessHardening<Scalar> term_{one_khz<Scalar>(), {number<Scalar>(kCubeBelow)}};
};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Hardening, Formats);

// A spring of tension k x (1 + h x): its deflection under tau, solved exactly, is tau/k - h tau |tau| / k^2 and then a
// term of third order, at most 2 h^2 |tau|^3 / k^3.
TYPED_TEST(Hardening, IsTheSecondOrderOfASpringThatGetsStiffer) {
  constexpr double kStiffness = 0.6;
  constexpr double kHarder = 0.5;
  for (double tau = -0.1; tau <= 0.1; tau += 0.003) {
    const double size = std::fabs(tau);
    const double deflection = (std::sqrt(1.0 + 4.0 * kHarder * size / kStiffness) - 1.0) / (2.0 * kHarder);
    const auto phi = this->term_.update({.tau = number<TypeParam>(tau)});
    const double law = -tau / kStiffness + kHarder / std::pow(kStiffness, 2) * value_of(phi[0]);
    const double left = 2.0 * kHarder * kHarder * std::pow(size, 3) / std::pow(kStiffness, 3);
    const double cubed = kHarder / std::pow(kStiffness, 2) * TestFixture::kCubeBelow * TestFixture::kCubeBelow;
    ASSERT_NEAR(law, std::copysign(deflection, -tau), left + cubed + 3e-7) << tau;
  }
}

// A spring of tension k (x + h x^3), solved by Newton's method: its deflection is tau/k - h (tau/k)^3 and then a term
// of fifth order, at most 3 h^2 (|tau|/k)^5. With T above every torque the coefficient h T / k^3 makes it.
TYPED_TEST(Hardening, IsTheThirdOrderOfASymmetricSpringBelowItsTorque) {
  constexpr double kStiffness = 0.6;
  constexpr double kHarder = 4.0;
  constexpr double kAbove = 0.25;
  StiffnessHardening<TypeParam> term(one_khz<TypeParam>(), {number<TypeParam>(kAbove)});
  for (double tau = -0.1; tau <= 0.1; tau += 0.003) {
    double x = tau / kStiffness;
    for (int i = 0; i < 20; ++i) {
      x -= (x + kHarder * x * x * x - tau / kStiffness) / (1.0 + 3.0 * kHarder * x * x);
    }
    const auto phi = term.update({.tau = number<TypeParam>(tau)});
    const double law = tau / kStiffness - kHarder * kAbove / std::pow(kStiffness, 3) * value_of(phi[0]);
    const double left = 3.0 * kHarder * kHarder * std::pow(std::fabs(tau) / kStiffness, 5);
    ASSERT_NEAR(law, x, left + 1.2e-6) << tau;
  }
}

TYPED_TEST(Hardening, GoesToThePulledTendonAndIsOdd) {
  for (const bool forward : {true, false}) {
    for (const double sign : {1.0, -1.0}) {
      const Sample<TypeParam> sample{.tau = number<TypeParam>(sign * 1.5), .forward = forward};
      const auto phi = this->term_.update(sample);
      EXPECT_EQ(value_of(phi[forward ? 0 : 1]), sign * 2.25);
      EXPECT_EQ(value_of(phi[forward ? 1 : 0]), 0.0);
      EXPECT_EQ(this->term_.steady_state(sample), phi);
    }
  }
}

TEST(HardeningFixed, SaturatesBeyondElevenNewtonMetresAndNeverWraps) {
  StiffnessHardening<Q24> term(one_khz<Q24>(), {number<Q24>(0.002)});
  EXPECT_FALSE(term.update({.tau = number<Q24>(11.3)})[0].is_saturated());
  EXPECT_EQ(term.update({.tau = number<Q24>(11.4)})[0], Q24::max());
  EXPECT_EQ(term.update({.tau = Q24::lowest()})[0], Q24::lowest());
}

}  // namespace
}  // namespace capstan
