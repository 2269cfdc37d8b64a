// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/load_inertia.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

static_assert(SumTerm<LoadInertia<double>, double> && SumTerm<LoadInertia<Q24>, Q24>);

TEST(LoadInertia, IsTheAccelerationAsItIs) {
  LoadInertia<Q24> term(one_khz<Q24>(), {});
  const Sample<Q24> sample{.ddq1 = number<Q24>(-0.75)};
  EXPECT_EQ(term.update(sample)[0], number<Q24>(-0.75));
  EXPECT_EQ(term.steady_state(sample)[0], number<Q24>(-0.75));
}

template <typename Scalar>
class Inertia : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Inertia, Formats);

// I q2'' = K (beta q1 - q2) moved slowly: q2 = beta q1 / (1 - w^2 I/K) for a sine, and the law's first order is
// beta q1 + (I/K) beta w^2 q1. The filters' two lags are late by 10 ms in all.
TYPED_TEST(Inertia, IsTheSagOfASprungMassInASine) {
  constexpr double kBeta = 1.1;
  constexpr double kInertiaOverStiffness = 4.0e-5;  // s2: an eigenfrequency of 25 Hz
  constexpr double kOmega = 12.0;
  SampleConditioner<TypeParam> conditioner(one_khz<TypeParam>(), {});
  LoadInertia<TypeParam> term(one_khz<TypeParam>(), {});
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.001 * i;
    const double q1 = std::sin(kOmega * t);
    const double phi = value_of(term.update(conditioner.update(number<TypeParam>(q1), number<TypeParam>(0.0)))[0]);
    const double sag = kBeta * q1 / (1.0 - kOmega * kOmega * kInertiaOverStiffness) - kBeta * q1;
    const double law = -1000.0 * kInertiaOverStiffness * kBeta * phi;
    const double size = kBeta * kOmega * kOmega * kInertiaOverStiffness;
    if (i > 500) {
      ASSERT_NEAR(law, sag, size * (kOmega * 0.011 + kOmega * kOmega * kInertiaOverStiffness)) << t;
    }
  }
}

}  // namespace
}  // namespace capstan
