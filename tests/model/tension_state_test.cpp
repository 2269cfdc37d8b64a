// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/tension_state.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "capstan/model/tension_profile.hpp"
#include "capstan/tests/model/integrated_tension.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::value_of;

/// The micro-forceps of the thesis.
template <typename Scalar>
auto forceps() -> TensionStateParameters<Scalar> {
  constexpr double kR1 = 0.0026;
  return {number<Scalar>(1.1414),
          number<Scalar>(1.1404),
          number<Scalar>(27.6984 * kR1),
          number<Scalar>(1.0 / (kR1 * kR1 * 5.0664e4)),
          number<Scalar>(1.0 / (kR1 * kR1 * 5.0831e4)),
          number<Scalar>(2.6 / 2.4)};
}

template <typename Scalar>
class TensionStateIn : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(TensionStateIn, Formats);

TYPED_TEST(TensionStateIn, KeepsTorqueDifferenceAndSumOfElongationsWhateverTheTorqueDoes) {
  const auto p = forceps<TypeParam>();
  TensionState<TypeParam> state(p);
  const double sum = 2.0 * value_of(p.compliance_top) * value_of(state.top().input());
  std::mt19937 engine(51);
  std::uniform_real_distribution<double> jump(-0.25, 0.25);
  std::normal_distribution<double> walk(0.0, 0.002);
  double tau = 0.0;
  int slack = 0;
  for (int i = 0; i < 20000; ++i) {
    tau = i % 50 == 0 ? jump(engine) : tau + walk(engine);
    const auto estimate = state.update(TypeParam{}, number<TypeParam>(tau), true);
    const double top = value_of(state.top().input());
    const double bottom = value_of(state.bottom().input());
    ASSERT_NEAR(top - bottom, tau, 4.0 * test::kLsb);
    ASSERT_GE(std::fmin(top, bottom), 0.0);
    const double now = value_of(state.top().trial(state.top().input()).elongation) +
                       value_of(state.bottom().trial(state.bottom().input()).elongation);
    if (estimate.phase == ForcePhase::kOneSlack) {
      ++slack;
      ASSERT_GE(now, sum - 1e-5) << "one tendon is slack only if the other alone is longer than both at rest";
      ASSERT_EQ(std::fmin(top, bottom), 0.0);
    } else {
      ASSERT_NEAR(now, sum, 1e-5) << i;
    }
  }
  EXPECT_GT(slack, 1000);
}

// The exact profile, which has its fronts wherever they are, over the same input tensions.
TEST(FrictionChain, HasTheTensionOfTheExactProfileAtItsPlaces) {
  constexpr std::size_t kNodes = 8;
  FrictionChain<double, kNodes> chain(1.1414, 0.03, 1.0, 0.0);
  TensionProfile profile({1.1414, 1.0}, 0.03);
  std::mt19937 engine(52);
  std::normal_distribution<double> walk(0.0, 0.004);
  double tension = 0.03;
  double worst = 0.0;
  for (int i = 0; i < 5000; ++i) {
    tension = std::fmax(tension + walk(engine) + 0.02 * (0.05 - tension), 0.001);
    chain.pull_to(tension);
    profile.pull_to(tension);
    ASSERT_NEAR(chain.output(), profile.at(1.0), 1e-12);
    worst = std::fmax(worst, std::fabs(chain.trial(tension).elongation - profile.integral()) / profile.integral());
  }
  EXPECT_LT(worst, 0.02) << "a front inside one of seven cells";
  EXPECT_EQ(profile.dropped(), 0U);
}

/// The same tendon without a front: each place is looked at, and what it stretches is added up.
struct PlaceByPlace {
  static constexpr std::size_t kNodes = 8;
  PlaceByPlace(double eta_of, double tension) : eta(eta_of) { tensions.fill(tension); }
  [[nodiscard]] auto low(std::size_t i) const -> double {
    return std::exp(-eta * static_cast<double>(i) / (kNodes - 1));
  }
  void pull_to(double input) {
    for (std::size_t i = 0; i < kNodes; ++i) {
      tensions[i] = std::clamp(tensions[i], input * low(i), input / low(i));
    }
  }
  void slide(bool pulled, double share) {
    for (std::size_t i = 1; i < kNodes; ++i) {
      tensions[i] += share * (tensions[0] * (pulled ? low(i) : 1.0 / low(i)) - tensions[i]);
    }
  }
  /// Of unit compliance, per cell e^(-eta h) between its ends.
  [[nodiscard]] auto elongation() const -> double {
    const double step = eta / (kNodes - 1);
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < kNodes; ++i) {
      sum += 0.5 * (tensions[i] + tensions[i + 1]) / (kNodes - 1) * std::tanh(0.5 * step) / (0.5 * step);
    }
    return sum;
  }
  double eta;
  std::array<double, kNodes> tensions{};
};

// Beyond the front nothing is looked at: a place there that should have moved would show here.
TYPED_TEST(TensionStateIn, ChainMovesWhatMovesPlaceByPlaceWhetherItSlidesOrNot) {
  constexpr bool kIsFixed = std::is_same_v<TypeParam, Q24>;
  std::mt19937 engine(53);
  std::normal_distribution<double> walk(0.0, 0.2);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  for (const double eta : {0.05, 0.6, 1.5}) {
    FrictionChain<TypeParam, PlaceByPlace::kNodes> chain(number<TypeParam>(eta), number<TypeParam>(0.5),
                                                         number<TypeParam>(1.0), TypeParam{});
    PlaceByPlace plain(eta, 0.5);
    double log_tension = std::log(0.5);
    for (int i = 0; i < 5000; ++i) {
      log_tension = 0.98 * log_tension + walk(engine) * chance(engine);
      const double tension = value_of(number<TypeParam>(std::exp(log_tension)));
      const double trial = value_of(chain.trial(number<TypeParam>(tension)).elongation);
      chain.pull_to(number<TypeParam>(tension));
      plain.pull_to(tension);
      ASSERT_NEAR(trial, plain.elongation(), (kIsFixed ? 2e-5 : 1e-12)) << eta << ", step " << i;
      if (chance(engine) < 0.3) {
        const bool pulled = chance(engine) < 0.5;
        ASSERT_TRUE(chain.slide(pulled, ScalarTraits<TypeParam>::share_of(number<TypeParam>(0.125))));
        plain.slide(pulled, 0.125);
      }
      ASSERT_NEAR(value_of(chain.output()), plain.tensions.back(), (kIsFixed ? 1e-5 : 1e-12)) << eta << ", step " << i;
    }
  }
}

TEST(FrictionChain, StretchesATendonThatSlidesInItsWholeLengthByTheIntegral) {
  for (const double eta : {0.0, 0.3, 1.1414, 3.0}) {
    FrictionChain<double, 4> chain(eta, 1e-9, 2.0, 0.0);
    chain.pull_to(0.05);
    EXPECT_NEAR(chain.trial(0.05).elongation, 2.0 * test::integrate(eta, 1.0, 0.05).area, 1e-12);
    FrictionChain<double, 4> let_go(eta, 50.0, 2.0, 0.0);
    let_go.pull_to(0.05);
    EXPECT_NEAR(let_go.trial(0.05).elongation, 2.0 * test::integrate(eta, -1.0, 0.05).area, 1e-11);
    const double slope = (let_go.trial(0.04999).elongation - let_go.trial(0.04997).elongation) / 0.00002;
    EXPECT_NEAR(let_go.trial(0.04998).slope, slope, 1e-6 * slope);
  }
}

TYPED_TEST(TensionStateIn, IsKnownOnceBothTendonsHaveMovedInTheirWholeLength) {
  TensionState<TypeParam> state(forceps<TypeParam>());
  EXPECT_FALSE(state.update(TypeParam{}, number<TypeParam>(0.01), true).known);
  static_cast<void>(state.update(TypeParam{}, number<TypeParam>(0.2), true));
  EXPECT_TRUE(state.update(TypeParam{}, number<TypeParam>(-0.2), false).known);
}

TYPED_TEST(TensionStateIn, RefusesParametersOutOfRange) {
  using Parameters = TensionStateParameters<TypeParam>;
  const auto fault_of = [](void (*spoil)(Parameters&)) {
    auto p = forceps<TypeParam>();
    spoil(p);
    EXPECT_EQ(TensionState<TypeParam>(p).update(TypeParam{}, TypeParam{}, true).usable,
              check(p) == TensionStateFault::kNone);
    return check(p);
  };
  EXPECT_EQ(fault_of([](Parameters&) {}), TensionStateFault::kNone);
  EXPECT_EQ(fault_of([](Parameters& p) { p.eta_bottom = number<TypeParam>(3.1); }), TensionStateFault::kEta);
  EXPECT_EQ(fault_of([](Parameters& p) { p.pretension_nm = number<TypeParam>(-1.0); }), TensionStateFault::kPretension);
  EXPECT_EQ(fault_of([](Parameters& p) { p.compliance_top = TypeParam{}; }), TensionStateFault::kCompliance);
  EXPECT_EQ(fault_of([](Parameters& p) { p.beta = number<TypeParam>(0.1); }), TensionStateFault::kBeta);
  EXPECT_EQ(fault_of([](Parameters& p) { p.joint_offset = number<TypeParam>(4.0); }), TensionStateFault::kOffset);
  EXPECT_EQ(fault_of([](Parameters& p) { p.friction_nm = number<TypeParam>(1.1); }), TensionStateFault::kFriction);
  EXPECT_NE(std::string_view(describe(TensionStateFault::kBeta)).find("beta"), std::string_view::npos);
}

TEST(TensionStateInFixedPoint, SaturatesInsteadOfWrappingAndSaysSo) {
  TensionState<Q24> state(forceps<Q24>());
  const auto estimate = state.update(Q24{}, Q24::max(), true);
  EXPECT_TRUE(estimate.saturated);
  EXPECT_GE(estimate.joint_torque, Q24{});
  EXPECT_FALSE(state.update(Q24{}, Q24{}, true).saturated);
}

}  // namespace
}  // namespace capstan
