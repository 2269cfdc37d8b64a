// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <vector>

#include "model/effort_catalogue.hpp"
#include "tests/model/support.hpp"

namespace capstan {
namespace {

using test::kLsb;
using test::number;
using test::one_khz;
using test::value_of;

template <typename Scalar>
class Effort : public testing::Test {
 protected:
  static auto sample(double rate, bool forward, double acceleration = 0.0) -> Sample<Scalar> {
    return {.dq1 = number<Scalar>(rate), .forward = forward, .ddq1 = number<Scalar>(acceleration)};
  }
  template <template <typename> typename Term>
  static auto make(std::array<Scalar, kShapesOf<Term<double>>> shape = {}) -> Term<Scalar> {
    return Term<Scalar>(one_khz<Scalar>(), shape);
  }
};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Effort, Formats);

TYPED_TEST(Effort, OfMassAndDragIsAccelerationAndRate) {
  auto inertia = this->template make<effort::Inertia>();
  auto viscous = this->template make<effort::ViscousFriction>();
  EXPECT_EQ(value_of(inertia.update(this->sample(3.0, true, -0.125))[0]), -0.125);
  EXPECT_EQ(value_of(viscous.update(this->sample(-3.5, false, 9.0))[0]), -3.5);
  EXPECT_EQ(value_of(this->template make<effort::Offset>().update(this->sample(-3.5, false))[0]), 1.0);
}

TYPED_TEST(Effort, OfDryFrictionTurnsWithTheDirectionAndNotWithTheNoisyRate) {
  auto coulomb = this->template make<effort::CoulombFriction>();
  EXPECT_EQ(value_of(coulomb.update(this->sample(-0.001, true))[0]), 1.0);
  EXPECT_EQ(value_of(coulomb.update(this->sample(0.0, false))[0]), -1.0);
}

TYPED_TEST(Effort, OfAsymmetryIsNothingOnTheWayBack) {
  auto term = this->template make<effort::FrictionAsymmetry>();
  const auto forward = term.update(this->sample(2.5, true));
  const auto backward = term.update(this->sample(-2.5, false));
  EXPECT_EQ(value_of(forward[0]), 1.0);
  EXPECT_EQ(value_of(forward[1]), 2.5);
  EXPECT_EQ(value_of(backward[0]), 0.0);
  EXPECT_EQ(value_of(backward[1]), 0.0);
}

// The four friction coefficients of an asymmetric motor, put in by hand, are what the terms add up to.
TYPED_TEST(Effort, OfCoulombViscousAndAsymmetryHasItsOwnLineForEachDirection) {
  constexpr double kUp[] = {1.25, 0.5};  // dry, drag
  constexpr double kDown[] = {0.75, 0.25};
  auto coulomb = this->template make<effort::CoulombFriction>();
  auto viscous = this->template make<effort::ViscousFriction>();
  auto asymmetry = this->template make<effort::FrictionAsymmetry>();
  for (double rate = -4.0; rate <= 4.0; rate += 0.5) {
    const bool forward = rate >= 0.0;
    const auto s = this->sample(rate, forward);
    const double law = kDown[0] * value_of(coulomb.update(s)[0]) + kDown[1] * value_of(viscous.update(s)[0]) +
                       (kUp[0] - kDown[0]) * value_of(asymmetry.update(s)[0]) +
                       (kUp[1] - kDown[1]) * value_of(asymmetry.update(s)[1]);
    EXPECT_NEAR(law, forward ? kUp[0] + kUp[1] * rate : -kDown[0] + kDown[1] * rate, 1e-12) << rate;
  }
}

TYPED_TEST(Effort, OfStribeckFadesAsABellOfTheSpeedAndIsOdd) {
  auto term = this->template make<effort::StribeckFriction>({number<TypeParam>(0.25)});
  for (double rate = 0.0; rate < 2.0; rate += 0.0137) {
    const double expected = std::exp(-rate * rate / 0.0625);
    ASSERT_NEAR(value_of(term.update(this->sample(rate, true))[0]), expected, 3e-7) << rate;
    ASSERT_NEAR(value_of(term.update(this->sample(-rate, false))[0]), -expected, 3e-7) << rate;
  }
  auto never = this->template make<effort::StribeckFriction>();
  EXPECT_EQ(value_of(never.update(this->sample(0.0, true))[0]), 0.0);
}

// A slider that slips at one unit of force, held by a spring that reaches it in w: the force is the spring's stretch.
auto slider_forces(const std::vector<double>& way, double w) -> std::vector<double> {
  std::vector<double> forces;
  double force = 0.0;
  double before = way.front();
  for (const double x : way) {
    force += (x - before) / w;
    force = force > 1.0 ? 1.0 : (force < -1.0 ? -1.0 : force);
    before = x;
    forces.push_back(force);
  }
  return forces;
}

RC_GTEST_PROP(PlayFriction, IsASpringBehindASliderForAnyMotion, ()) {
  const double w = 1e-4 * *rc::gen::inRange(5, 20000);
  std::vector<double> way = {-0.7};
  for (const std::int32_t step : *rc::gen::container<std::vector<std::int32_t>>(rc::gen::inRange(-4000, 4000))) {
    way.push_back(way.back() + 1e-4 * step);
  }
  effort::PlayFriction<double> exact(one_khz<double>(), {w});
  effort::PlayFriction<Q24> fixed(one_khz<Q24>(), {number<Q24>(w)});
  const auto expected = slider_forces(way, w);
  for (std::size_t i = 0; i < way.size(); ++i) {
    RC_ASSERT(std::fabs(exact.update({.q1 = way[i]})[0] - expected[i]) < 1e-9);
    RC_ASSERT(std::fabs(fixed.update({.q1 = number<Q24>(way[i])})[0].to_double() - expected[i]) <
              2.5 * kLsb / w + kLsb);
  }
}

TYPED_TEST(Effort, OfPlayFrictionEndsWhereSettledSaysAndNeverBeyond) {
  for (const double direction : {1.0, -1.0}) {
    auto term = this->template make<effort::PlayFriction>({number<TypeParam>(0.05)});
    double last = 0.0;
    for (int i = 0; i < 500; ++i) {
      last = value_of(term.update({.q1 = number<TypeParam>(direction * 0.001 * i)})[0]);
      ASSERT_LE(std::fabs(last), 1.0 + 1e-12);
    }
    EXPECT_EQ(value_of(term.settled(this->sample(direction, direction > 0.0))[0]), direction);
    EXPECT_NEAR(last, direction, 1e-12);
  }
}

TYPED_TEST(Effort, OfPlayFrictionWithoutAPlayIsCoulombs) {
  auto term = this->template make<effort::PlayFriction>();
  EXPECT_EQ(value_of(term.update(this->sample(0.0, true))[0]), 1.0);
  EXPECT_EQ(value_of(term.update(this->sample(0.0, false))[0]), -1.0);
}

}  // namespace
}  // namespace capstan
