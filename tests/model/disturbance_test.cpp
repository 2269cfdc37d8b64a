// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/disturbance.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "capstan/tests/model/support.hpp"
#include "capstan/tests/model/torque_law_builder.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::TorqueLawBuilder;
using test::value_of;

template <typename Scalar>
auto view(double window_s) -> MotionView<Scalar> {
  return {number<Scalar>(window_s), number<Scalar>(0.02)};
}

template <typename Scalar>
class MotionWindowIn : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(MotionWindowIn, Formats);

TYPED_TEST(MotionWindowIn, GivesAngleRateAndAccelerationOfTheInstantInItsMiddle) {
  for (const double window_s : {0.016, 0.05, 0.12}) {
    MotionWindow<TypeParam> window(one_khz<TypeParam>(), view<TypeParam>(window_s));
    const auto at = [](double t) { return 0.3 - 1.2 * t + 0.5 * 40.0 * t * t; };
    bool full = false;
    for (int i = 0; i <= 100; ++i) {
      full = window.update({.q1 = number<TypeParam>(at(0.001 * i)), .tau = number<TypeParam>(0.01 * i)});
    }
    ASSERT_TRUE(full);
    const double middle = 0.1 - 0.001 * window.delay();
    const double spans = 1e-3 * window.delay();  // what rounds is an angle of 2^-24
    EXPECT_NEAR(value_of(window.sample().q1), at(middle), 1e-7);
    EXPECT_NEAR(value_of(window.sample().dq1), -1.2 + 40.0 * middle, 1e-6 + 2e-7 / spans);
    EXPECT_NEAR(1000.0 * value_of(window.sample().ddq1), 40.0, 1e-3 + 3e-7 / (spans * spans));
    EXPECT_NEAR(value_of(window.sample().tau), 10.0 * middle, 1e-6);
    EXPECT_EQ(value_of(window.sample().q2), value_of(window.sample().q1));
  }
}

TYPED_TEST(MotionWindowIn, IsFullOnceItHasSamplesOnBothSidesAndAnewAfterARestart) {
  MotionWindow<TypeParam> window(one_khz<TypeParam>(), view<TypeParam>(0.04));
  EXPECT_EQ(window.delay(), 10);
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 20; ++i) {
      EXPECT_FALSE(window.update({.q1 = number<TypeParam>(1.0)})) << i;
    }
    EXPECT_TRUE(window.update({.q1 = number<TypeParam>(1.0)}));
    window.restart();
  }
}

TYPED_TEST(MotionWindowIn, OfAnyLengthStaysWithinItsRing) {
  for (const auto& [window_s, delay] : {std::pair{-1.0, 4}, {0.0, 4}, {0.032, 8}, {0.104, 26}, {0.12, 30}, {5.0, 30}}) {
    EXPECT_EQ(MotionWindow<TypeParam>::delay_of(one_khz<TypeParam>(), number<TypeParam>(window_s)), delay) << window_s;
  }
}

TYPED_TEST(MotionWindowIn, KeepsItsDirectionAtAStandstill) {
  MotionWindow<TypeParam> window(one_khz<TypeParam>(), view<TypeParam>(0.032));
  double q = 0.0;
  const auto go = [&](double rate, int samples) {
    for (int i = 0; i < samples; ++i) {
      q += 0.001 * rate;
      window.update({.q1 = number<TypeParam>(q)});
    }
    return window.sample().forward;
  };
  EXPECT_FALSE(go(-0.5, 100));
  EXPECT_FALSE(go(0.0, 100));
  EXPECT_FALSE(go(0.01, 100));  // slower than the view's standstill
  EXPECT_TRUE(go(0.5, 100));
}

/// The share of dry friction after a motion and then so long a rest.
template <typename Scalar>
auto grip_after(double rest_s, double letting_go_s) -> double {
  MotionView<Scalar> seen = view<Scalar>(0.032);
  seen.letting_go_s = number<Scalar>(letting_go_s);
  MotionWindow<Scalar> window(one_khz<Scalar>(), seen);
  double q = 0.0;
  const auto go = [&](double rate, int samples) {
    for (int i = 0; i < samples; ++i) {
      q += 0.001 * rate;
      window.update({.q1 = number<Scalar>(q)});
    }
  };
  go(0.5, 100);
  EXPECT_EQ(value_of(window.sample().grip), 1.0);
  go(0.0, static_cast<int>(std::lround(1000.0 * rest_s)) + 12);  // 12: until the window sees nothing of the motion
  const double grip = value_of(window.sample().grip);
  go(0.5, 100);
  EXPECT_EQ(value_of(window.sample().grip), 1.0);
  return grip;
}

TYPED_TEST(MotionWindowIn, DryFrictionLetsGoAtAStandstillAndHoldsWhereItIsToldTo) {
  EXPECT_EQ(grip_after<TypeParam>(2.0, 0.0), 1.0);
  EXPECT_NEAR(grip_after<TypeParam>(0.12, 0.12), std::exp(-1.0), 0.01);
  EXPECT_NEAR(grip_after<TypeParam>(0.36, 0.12), std::exp(-3.0), 0.01);
  EXPECT_LT(grip_after<TypeParam>(2.0, 0.12), 1e-5);
}

/// A motor of 20 g m2 with drag and dry friction, and what pushes at it beside.
auto motor_law() -> TorqueLawBuilder {
  TorqueLawBuilder law;
  law.coefficient("inertia", "inertia", 0.02).coefficient("viscous_friction", "drag", 0.004);
  law.coefficient("coulomb_friction", "level", 0.03).coefficient("offset", "offset", 0.005);
  return law;
}

constexpr double kCountRad = 2.0 * std::numbers::pi / 40960.0;

/// Two sines in counts, the torque that they take, and a push.
struct Swing {
  double push_nm = 0.0;
  double push_from_s = 1e9;
  double noise_nm = 0.0;
  std::mt19937 engine{5};

  auto at(int i) -> Measured<double> {
    const double t = 0.001 * i;
    double q = 0.0;
    double v = 0.0;
    double a = 0.0;
    for (const auto& [size, hz] : {std::pair{0.9, 0.31}, {0.2, 0.83}}) {
      const double w = 2.0 * std::numbers::pi * hz;
      q += size * std::sin(w * t);
      v += size * w * std::cos(w * t);
      a -= size * w * w * std::sin(w * t);
    }
    const double law = 2e-5 * a + 0.004 * v + (v > 0.0 ? 0.03 : -0.03) + 0.005;
    const double push = t >= push_from_s ? push_nm : 0.0;
    const double noise = noise_nm * std::normal_distribution<double>()(engine);
    return {.q1 = kCountRad * std::round(q / kCountRad), .tau = law + push + noise};
  }
};

auto fixed_of(const Measured<double>& now) -> Measured<Q24> {
  return {.q1 = Q24::from_double(now.q1), .tau = Q24::from_double(now.tau)};
}

TEST(Disturbance, InFixedPointIsThatInDouble) {
  Disturbance<double> exact(one_khz<double>(), motor_law().parameters<double>(), view<double>(0.12));
  Disturbance<Q24> fixed(one_khz<Q24>(), motor_law().parameters<Q24>(), view<Q24>(0.12));
  Swing run{.push_nm = 0.05, .push_from_s = 4.0, .noise_nm = 0.002};
  for (int i = 0; i < 8000; ++i) {
    const Measured<double> now = run.at(i);
    const auto one = exact.update(now);
    const auto other = fixed.update(fixed_of(now));
    ASSERT_EQ(one.known, other.known);
    ASSERT_NEAR(one.law_nm, other.law_nm.to_double(), 2e-6) << i;
    ASSERT_NEAR(one.disturbance_nm, other.disturbance_nm.to_double(), 2e-6) << i;
  }
}

TEST(Disturbance, OfFreeMotionStaysSmallBesideTheTorqueThatTheMotionTakes) {
  Disturbance<Q24> disturbance(one_khz<Q24>(), motor_law().parameters<Q24>(), view<Q24>(0.12));
  Swing run{.noise_nm = 0.002};
  double squares = 0.0;
  constexpr int kSamples = 10000;
  for (int i = 0; i < kSamples; ++i) {
    squares += std::pow(disturbance.update(fixed_of(run.at(i))).disturbance_nm.to_double(), 2);
  }
  // Noise of 2 mN m through the low-pass: 2 sqrt(g / (2 - g)) with g = 1/31 is 0.26 mN m; where the direction turns,
  // the law is late or early by as long as the motion stands still. The torque of the motion has an rms of 33 mN m.
  EXPECT_LT(std::sqrt(squares / kSamples), 0.002);
}

TEST(Disturbance, ShowsAPushWithItsSignAfterItsDelayAndTwoThirdsOfItAfterTwice) {
  for (const double push : {0.05, -0.02}) {
    for (const double window_s : {0.032, 0.12}) {
      Disturbance<Q24> disturbance(one_khz<Q24>(), motor_law().parameters<Q24>(), view<Q24>(window_s));
      Swing run{.push_nm = push, .push_from_s = 3.2};  // in the middle of a stroke
      const int delay = disturbance.delay();
      for (int i = 0; i < 3200 + 6 * delay; ++i) {
        const double said = disturbance.update(fixed_of(run.at(i))).disturbance_nm.to_double() / push;
        if (i > 2900 && i < 3200 + delay) {
          ASSERT_LT(std::abs(said), 0.05) << i;
        } else if (i == 3200 + 2 * delay) {
          EXPECT_GT(said, 0.55);
          EXPECT_LT(said, 0.75);
        } else if (i == 3200 + 6 * delay - 1) {
          EXPECT_NEAR(said, 1.0, 0.05);
        }
      }
    }
  }
}

TEST(Disturbance, IsNotKnownBeforeTheWindowIsFullNorWhereANumberMeetsTheEndOfTheRange) {
  Disturbance<Q24> disturbance(one_khz<Q24>(), motor_law().parameters<Q24>(), view<Q24>(0.12));
  Swing run;
  for (int i = 0; i < 60; ++i) {
    const auto estimate = disturbance.update(fixed_of(run.at(i)));
    ASSERT_FALSE(estimate.known);
    ASSERT_EQ(estimate.disturbance_nm, Q24{});
  }
  ASSERT_TRUE(disturbance.update(fixed_of(run.at(60))).known);
  Measured<Q24> cut = fixed_of(run.at(61));
  cut.tau = Q24::max();
  int unknown = 0;
  for (int i = 61; i < 200; ++i) {
    unknown += disturbance.update(i == 61 ? cut : fixed_of(run.at(i))).known ? 0 : 1;
  }
  EXPECT_EQ(unknown, 1);
}

RC_GTEST_PROP(Disturbance, NeverWrapsWhateverIsMeasured, ()) {
  Disturbance<Q24> disturbance(one_khz<Q24>(), motor_law().parameters<Q24>(), view<Q24>(0.016));
  Disturbance<double> exact(one_khz<double>(), motor_law().parameters<double>(), view<double>(0.016));
  const auto raws = *rc::gen::container<std::vector<std::int32_t>>(40, rc::gen::arbitrary<std::int32_t>());
  bool in_range = true;
  for (std::size_t i = 0; i + 1 < raws.size(); i += 2) {
    const Measured<Q24> now{.q1 = Q24::from_raw(raws[i] >> (i % 12)), .tau = Q24::from_raw(raws[i + 1] >> 1)};
    const auto said = disturbance.update(now);
    const auto expected = exact.update({.q1 = now.q1.to_double(), .tau = now.tau.to_double()});
    in_range = in_range && (said.known || !expected.known);  // the filters differ once one of them began anew
    if (in_range && said.known) {
      const double end = std::min(std::max(expected.disturbance_nm, -128.0), 128.0);
      RC_ASSERT(std::abs(said.disturbance_nm.to_double() - end) < 1e-3 + 1e-5 * std::abs(end));
    }
  }
}

}  // namespace
}  // namespace capstan
