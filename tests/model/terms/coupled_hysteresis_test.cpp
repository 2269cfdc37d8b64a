// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/coupled_hysteresis.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

static_assert(SumTerm<CoupledHysteresis<double>, double> && SumTerm<CoupledHysteresis3<Q24>, Q24>);

template <typename Scalar>
class CoupledHysteresisIn : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(CoupledHysteresisIn, Formats);

/// The other motors at these angles, this one somewhere.
template <typename Scalar>
auto others_at(double first, double second, double third) -> Sample<Scalar> {
  Sample<Scalar> s{.q1 = number<Scalar>(7.0)};
  s.others[0].q1 = number<Scalar>(first);
  s.others[1].q1 = number<Scalar>(second);
  s.others[2].q1 = number<Scalar>(third);
  return s;
}

TYPED_TEST(CoupledHysteresisIn, IsTheOthersAngleAndWhatItsPlayTakesUp) {
  CoupledHysteresis<TypeParam> term(one_khz<TypeParam>(), {number<TypeParam>(0.1)});
  const auto lost_at = [&term](double q) { return value_of(term.update(others_at<TypeParam>(q, 50.0, -50.0))[1]); };
  EXPECT_NEAR(lost_at(0.0), 0.0, 1e-7);
  EXPECT_NEAR(lost_at(0.05), 0.05, 1e-7) << "all of it, in the gap";
  EXPECT_NEAR(lost_at(0.5), 0.1, 1e-7) << "the half width, once the tendon is taut";
  EXPECT_NEAR(lost_at(0.42), 0.02, 1e-7);
  EXPECT_NEAR(lost_at(-1.0), -0.1, 1e-7) << "and the other way";
  EXPECT_NEAR(value_of(term.update(others_at<TypeParam>(-1.0, 0.0, 0.0))[0]), -1.0, 1e-7);
}

TYPED_TEST(CoupledHysteresisIn, OfEachSlotLooksAtItsOwnMotor) {
  const auto angle = [](auto term) { return value_of(term.update(others_at<TypeParam>(1.0, 2.0, 3.0))[0]); };
  const std::array<TypeParam, 1> shape = {number<TypeParam>(0.1)};
  EXPECT_EQ(angle(CoupledHysteresis<TypeParam>(one_khz<TypeParam>(), shape)), 1.0);
  EXPECT_EQ(angle(CoupledHysteresis2<TypeParam>(one_khz<TypeParam>(), shape)), 2.0);
  EXPECT_EQ(angle(CoupledHysteresis3<TypeParam>(one_khz<TypeParam>(), shape)), 3.0);
}

// Feedforward for this motor must not suppose that the others go on.
TYPED_TEST(CoupledHysteresisIn, SettlesWhereTheOtherMotorStands) {
  CoupledHysteresis<TypeParam> term(one_khz<TypeParam>(), {number<TypeParam>(0.1)});
  term.update(others_at<TypeParam>(0.0, 0.0, 0.0));
  const Sample<TypeParam> now = others_at<TypeParam>(0.05, 0.0, 0.0);
  const auto shown = term.update(now);
  EXPECT_EQ(term.steady_state(now)[0], shown[0]);
  EXPECT_EQ(term.steady_state(now)[1], shown[1]);
  term.restart();
  EXPECT_EQ(value_of(term.update(now)[1]), 0.0) << "and forgets when told to";
}

TEST(CoupledHysteresis, OfThreeJointsAddsUpInALaw) {
  test::LawBuilder builder;
  builder.coefficient("motor_angle", "beta", 1.0)
      .coefficient("coupled_hysteresis", "angle", 0.5)
      .coefficient("coupled_hysteresis_2", "angle", -0.25);
  builder.coefficient("coupled_hysteresis_3", "lost", 0.125).shape("coupled_hysteresis_3", "half_width", 0.2);
  auto exact = builder.law<double>();
  auto fixed = builder.law<Q24>();
  for (const double q : {0.0, 0.1, 0.7, -0.3, 1.0}) {
    Measured<double> now{.q1 = 0.2};
    Measured<Q24> raw{.q1 = number<Q24>(0.2)};
    for (std::size_t slot = 0; slot < kMostOthers; ++slot) {
      now.others[slot].q1 = q * static_cast<double>(slot + 1);
      raw.others[slot].q1 = number<Q24>(now.others[slot].q1);
    }
    EXPECT_NEAR(fixed.update(raw).q2.to_double(), exact.update(now).q2, 4.0 * test::kLsb);
  }
  // Third motor at 3, its play pulled along from -0.9 to 2.8: 0.2 of it is lost.
  EXPECT_NEAR(exact.update({.q1 = 0.2, .others = {{{.q1 = 1.0}, {.q1 = 2.0}, {.q1 = 3.0}}}}).q2,
              0.2 + 0.5 * 1.0 - 0.25 * 2.0 + 0.125 * 0.2, 1e-12);
}

}  // namespace
}  // namespace capstan
