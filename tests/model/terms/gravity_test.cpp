// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/gravity.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

static_assert(SumTerm<Gravity<double>, double> && SumTerm<Gravity<Q24>, Q24>);

template <typename Scalar>
class GravityTerm : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(GravityTerm, Formats);

TYPED_TEST(GravityTerm, IsSineAndCosineOfTheLinkAngleAndNotOfTheMotors) {
  Gravity<TypeParam> term(one_khz<TypeParam>(), {});
  const double bound = (std::is_same_v<TypeParam, double>) ? 1e-15 : 4.5e-8;
  for (double q2 = -127.9; q2 < 127.9; q2 += 0.0371) {
    const Sample<TypeParam> sample{.q1 = number<TypeParam>(1.0), .q2 = number<TypeParam>(q2)};
    const double angle = value_of(sample.q2);
    ASSERT_NEAR(value_of(term.update(sample)[0]), std::sin(angle), bound) << q2;
    ASSERT_NEAR(value_of(term.update(sample)[1]), std::cos(angle), bound) << q2;
    ASSERT_EQ(term.steady_state(sample), term.update(sample));
  }
}

/// A spring of stiffness K between motor and link, with a weight m g l on the link: K (beta q1 - q2) = m g l sin(q2 +
/// a), by bisection.
auto hanging_link(double driven, double weight_over_stiffness, double angle) -> double {
  double low = driven - 1.0;
  double high = driven + 1.0;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (driven - middle > weight_over_stiffness * std::sin(middle + angle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// The estimate of the last cycle in the term is a fixed-point iteration: it must end at the balance of the forces.
TYPED_TEST(GravityTerm, FedWithItsOwnEstimateFindsTheBalanceOfWeightAndSpring) {
  constexpr double kSag = 0.2;  // weight over stiffness
  constexpr double kTilt = 0.4;
  const TypeParam sine = number<TypeParam>(-kSag * std::cos(kTilt));
  const TypeParam cosine = number<TypeParam>(-kSag * std::sin(kTilt));
  SampleConditioner<TypeParam> conditioner(one_khz<TypeParam>(), {});
  Gravity<TypeParam> term(one_khz<TypeParam>(), {});
  for (const double driven : {-2.5, -0.4, 0.0, 1.1, 3.0}) {
    TypeParam q2 = number<TypeParam>(driven);
    for (int cycle = 0; cycle < 30; ++cycle) {
      const auto phi = term.update(conditioner.update({.q1 = number<TypeParam>(driven), .q2 = q2}));
      q2 = number<TypeParam>(driven) + sine * phi[0] + cosine * phi[1];
    }
    EXPECT_NEAR(value_of(q2), hanging_link(driven, kSag, kTilt), (std::is_same_v<TypeParam, double>) ? 1e-12 : 2e-7);
  }
}

}  // namespace
}  // namespace capstan
