// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/axis_coupling.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/model/terms/tendon_elongation.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

static_assert(SumTerm<AxisCoupling<double>, double> && SumTerm<AxisCoupling<Q24>, Q24>);

template <typename Scalar>
class Coupling : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Coupling, Formats);

// Pitch and right jaw of the da Vinci wrist with the values of chapter 6, as a matrix product: Theta = B Q + A S tau,
// S = diag of (J_i, 1 - J_i) pairs.
TYPED_TEST(Coupling, IsTheRowOfTheWristOutsideTheDiagonal) {
  constexpr double kIntermediate = 0.674;  // K_r, Table 6.1
  constexpr double kB[2][2] = {{0.996, 0.0}, {kIntermediate, 1.109}};
  constexpr double kA[2][4] = {{-0.424, -2.828, 0.0, 0.0},
                               {kIntermediate * -0.424, kIntermediate * -2.828, -1.907, -1.054}};
  SampleConditioner<TypeParam> pitch(one_khz<TypeParam>(), {});
  SampleConditioner<TypeParam> jaw(one_khz<TypeParam>(), {});
  AxisCoupling<TypeParam> coupling(one_khz<TypeParam>(), {});
  TendonElongation<TypeParam> elongation(one_khz<TypeParam>(), {});
  int opposite = 0;
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.001 * i;
    const double q[2] = {0.6 * std::sin(5.0 * t), 0.9 * std::sin(3.3 * t + 1.0)};
    const double tau[2] = {0.04 * std::cos(4.0 * t), 0.05 * std::cos(2.2 * t)};
    const auto other = pitch.update(number<TypeParam>(q[0]), number<TypeParam>(tau[0]));
    const auto sample = jaw.update({.q1 = number<TypeParam>(q[1]),
                                    .tau = number<TypeParam>(tau[1]),
                                    .others = {{{other.q1, other.tau, other.forward}}}});
    opposite += other.forward != sample.forward ? 1 : 0;
    const double switches[4] = {other.forward ? 1.0 : 0.0, other.forward ? 0.0 : 1.0, sample.forward ? 1.0 : 0.0,
                                sample.forward ? 0.0 : 1.0};
    double expected = 0.0;
    for (int column = 0; column < 2; ++column) {
      expected += kB[1][column] * q[column];
      for (int side = 0; side < 2; ++side) {
        expected += kA[1][2 * column + side] * switches[2 * column + side] * tau[column];
      }
    }
    const auto own = elongation.update(sample);
    const auto phi = coupling.update(sample);
    const double law = kB[1][1] * value_of(sample.q1) + kA[1][2] * value_of(own[0]) + kA[1][3] * value_of(own[1]) +
                       kB[1][0] * value_of(phi[0]) + kA[1][0] * value_of(phi[1]) + kA[1][1] * value_of(phi[2]);
    ASSERT_NEAR(law, expected, (std::is_same_v<TypeParam, double>) ? 1e-14 : 3e-7) << i;
    ASSERT_EQ(coupling.steady_state(sample), phi);
  }
  EXPECT_GT(opposite, 1000) << "the axes must move against each other, or the own switch would do";
}

TYPED_TEST(Coupling, IsNothingWithoutAnotherAxis) {
  SampleConditioner<TypeParam> conditioner(one_khz<TypeParam>(), {});
  AxisCoupling<TypeParam> coupling(one_khz<TypeParam>(), {});
  for (int i = 0; i < 100; ++i) {
    const auto phi = coupling.update(conditioner.update(number<TypeParam>(0.01 * i), number<TypeParam>(0.5)));
    for (std::size_t k = 0; k < phi.size(); ++k) {
      ASSERT_EQ(value_of(phi[k]), 0.0);
    }
  }
}

}  // namespace
}  // namespace capstan
