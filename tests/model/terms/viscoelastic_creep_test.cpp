// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/viscoelastic_creep.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::kLsb;
using test::make_term;
using test::number;
using test::value_of;

static_assert(SumTerm<ViscoelasticCreep<double>, double> && SumTerm<ViscoelasticCreep<Q24>, Q24>);

/// A spring in series with a spring and a damper side by side; its stretch under a force, by small steps of the damper.
class SolidModel {
 public:
  SolidModel(double series, double parallel, double damping)
      : series_(series), parallel_(parallel), damping_(damping) {}
  auto stretch(double force, double dt) -> double {
    constexpr int kParts = 50;
    for (int i = 0; i < kParts; ++i) {
      const double h = dt / kParts;
      const double middle = damped_ + 0.5 * h * (force - parallel_ * damped_) / damping_;
      damped_ += h * (force - parallel_ * middle) / damping_;
    }
    return force / series_ + damped_;
  }

 private:
  double series_, parallel_, damping_;
  double damped_ = 0.0;
};

template <typename Scalar>
class Creep : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Creep, Formats);

// a tau + c (x - tau) is minus the stretch of the solid with 1/-c for the damped spring and 1/(c - a) for the other.
TYPED_TEST(Creep, WithTheElongationIsTheStandardLinearSolid) {
  constexpr double kWhole = -1.6;
  constexpr double kCreep = -0.4;
  constexpr double kTime = 0.7;
  SolidModel solid(1.0 / (kCreep - kWhole), -1.0 / kCreep, -kTime / kCreep);
  auto term = make_term<ViscoelasticCreep, TypeParam>(kTime);
  term.update({});
  for (int i = 0; i < 12000; ++i) {
    const double t = 0.001 * i;
    const double tau = t < 3.0 ? 0.1 : (t < 6.0 ? -0.05 : (t < 9.0 ? 0.08 * std::sin(3.0 * t) : 0.0));
    const double law = kWhole * tau + kCreep * value_of(term.update({.tau = number<TypeParam>(tau)})[0]);
    // A step of the filter is one of backward Euler: half a sample late, which is dt / (2 T) of the creep.
    ASSERT_NEAR(law, -solid.stretch(tau, 0.001), -kCreep * 0.15 * 0.001 / kTime) << "at " << t;
  }
}

TYPED_TEST(Creep, FadesAsAnExponentialInAHold) {
  constexpr double kTime = 2.0;
  auto term = make_term<ViscoelasticCreep, TypeParam>(kTime);
  term.update({});
  const auto hold = [&] { return value_of(term.update({.tau = number<TypeParam>(0.5)})[0]); };
  hold();
  const double start = hold();
  for (int i = 1; i <= 10000; ++i) {
    const double expected = start * std::exp(-0.001 * i / kTime);
    ASSERT_NEAR(hold(), expected, 0.5 * 0.5 * 0.001 / kTime + 2.0 * kLsb) << i;
  }
}

TYPED_TEST(Creep, StartsRelaxedUnderTheTorqueThatIsThere) {
  auto term = make_term<ViscoelasticCreep, TypeParam>(10.0);
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(value_of(term.update({.tau = number<TypeParam>(-3.25)})[0]), 0.0);
  }
}

TYPED_TEST(Creep, SettledIsTheCreepOfNowWithoutAStepOfIt) {
  auto term = make_term<ViscoelasticCreep, TypeParam>(5.0);
  EXPECT_EQ(value_of(term.steady_state({.tau = number<TypeParam>(0.5)})[0]), 0.0);
  term.update({});
  TypeParam last{};
  for (int i = 0; i < 2000; ++i) {
    last = term.update({.tau = number<TypeParam>(0.5)})[0];
  }
  EXPECT_EQ(term.steady_state({.tau = number<TypeParam>(0.5)})[0], last);
  EXPECT_EQ(term.steady_state({.tau = number<TypeParam>(0.5)})[0], last);
}

}  // namespace
}  // namespace capstan
