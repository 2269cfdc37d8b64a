// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <vector>

#include "capstan/model/effort_catalogue.hpp"
#include "capstan/tests/model/support.hpp"

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

// A motor at rest may carry any torque up to its friction: what the last motion left of it fades, and with it goes what
// depends on the direction; half of an asymmetry is in the middle of both ways.
TYPED_TEST(Effort, OfDryFrictionFadesWithItsGripTowardsTheMiddleOfBothDirections) {
  for (const bool forward : {true, false}) {
    Sample<TypeParam> resting = this->sample(0.0, forward);
    resting.q1 = number<TypeParam>(0.5);
    const double sign = forward ? 1.0 : -1.0;
    for (const double grip : {1.0, 0.25, 0.0}) {
      resting.grip = number<TypeParam>(grip);
      EXPECT_EQ(value_of(this->template make<effort::CoulombFriction>().update(resting)[0]), sign * grip);
      EXPECT_EQ(value_of(this->template make<effort::FrictionAsymmetry>().update(resting)[0]), 0.5 + 0.5 * sign * grip);
      EXPECT_NEAR(value_of(this->template make<effort::StribeckFriction>({number<TypeParam>(0.1)}).update(resting)[0]),
                  sign * grip, 4.0 * kLsb);
      EXPECT_EQ(value_of(this->template make<effort::PlayFriction>().update(resting)[0]), sign);  // elastic: it stays
      const auto load =
          this->template make<effort::LoadFriction>({number<TypeParam>(0.0), number<TypeParam>(2.0)}).update(resting);
      EXPECT_NEAR(value_of(load[0]), sign * grip * std::sin(0.5), 1e-6);
      EXPECT_NEAR(value_of(load[1]), (0.5 + 0.5 * sign * grip) * std::sin(0.5), 1e-6);
      EXPECT_NEAR(value_of(load[2]), sign * grip * 0.25, 1e-6);
      EXPECT_NEAR(value_of(load[3]), (0.5 + 0.5 * sign * grip) * 0.25, 1e-6);
    }
  }
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

// The same behind a slack: the spring first has to be pulled tight, half of its way.
auto behind_slack(double force) -> double {
  if (std::fabs(force) <= 0.5) {
    return 0.0;
  }
  return std::copysign(2.0 * std::fabs(force) - 1.0, force);
}

// Dahl's equation by the midpoint rule in steps far below its scale.
auto bristle_forces(const std::vector<double>& way, double scale) -> std::vector<double> {
  std::vector<double> forces;
  double b = 0.0;
  double before = way.front();
  for (const double x : way) {
    const int parts = 1 + static_cast<int>(std::ceil(std::fabs(x - before) / (0.01 * scale)));
    const double step = (x - before) / parts;
    for (int i = 0; i < parts; ++i) {
      const double middle = b + 0.5 * (step - std::fabs(step) * b) / scale;
      b += (step - std::fabs(step) * middle) / scale;
    }
    before = x;
    forces.push_back(b);
  }
  return forces;
}

RC_GTEST_PROP(PlayFriction, IsASliderAGripAndABristleForAnyMotion, ()) {
  const double w = 1e-4 * *rc::gen::inRange(5, 20000);
  std::vector<double> way = {-0.7};
  for (const std::int32_t step : *rc::gen::container<std::vector<std::int32_t>>(rc::gen::inRange(-4000, 4000))) {
    way.push_back(way.back() + 1e-4 * step);
  }
  effort::PlayFriction<double> exact(one_khz<double>(), {w});
  effort::PlayFriction<Q24> fixed(one_khz<Q24>(), {number<Q24>(w)});
  const auto slider = slider_forces(way, w);
  const auto bristle = bristle_forces(way, 0.5 * w);
  for (std::size_t i = 0; i < way.size(); ++i) {
    const double expected[] = {slider[i], behind_slack(slider[i]), bristle[i]};
    const double tolerance[] = {1e-9, 1e-8, 2e-5};  // the last is that of the midpoint rule
    const auto in_double = exact.update({.q1 = way[i]});
    const auto in_fixed = fixed.update({.q1 = number<Q24>(way[i])});
    for (std::size_t k = 0; k < 3; ++k) {
      RC_ASSERT(std::fabs(in_double[k] - expected[k]) < tolerance[k]);
      RC_ASSERT(std::fabs(in_fixed[k].to_double() - expected[k]) < tolerance[k] + 5.0 * kLsb / w + 2.0 * kLsb);
    }
  }
}

TYPED_TEST(Effort, OfPlayFrictionEndsWhereSettledSaysAndNeverBeyond) {
  for (const double direction : {1.0, -1.0}) {
    auto term = this->template make<effort::PlayFriction>({number<TypeParam>(0.05)});
    std::array<TypeParam, 3> last{};
    for (int i = 0; i < 500; ++i) {
      last = term.update({.q1 = number<TypeParam>(direction * 0.001 * i)});
      for (const auto force : last) {
        ASSERT_LE(std::fabs(value_of(force)), 1.0 + 1e-12);
      }
    }
    const auto steady_state = term.steady_state(this->sample(direction, direction > 0.0));
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(value_of(steady_state[k]), direction);
      EXPECT_NEAR(value_of(last[k]), direction, 2e-7);
    }
  }
}

TYPED_TEST(Effort, OfPlayFrictionWithoutAPlayIsCoulombs) {
  auto term = this->template make<effort::PlayFriction>();
  for (const bool forward : {true, false}) {
    for (const auto force : term.update(this->sample(0.0, forward))) {
      EXPECT_EQ(value_of(force), forward ? 1.0 : -1.0);
    }
  }
}

}  // namespace
}  // namespace capstan
