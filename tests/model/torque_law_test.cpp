// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/torque_law.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <string>

#include "capstan/model/disturbance.hpp"
#include "capstan/tests/model/support.hpp"
#include "capstan/tests/model/torque_law_builder.hpp"

namespace capstan {
namespace {

using test::kLsb;
using test::number;
using test::one_khz;
using test::TorqueLawBuilder;
using test::value_of;

/// One of each kind, as a servo's laws have them.
auto servo_law() -> TorqueLawBuilder {
  TorqueLawBuilder law;
  law.coefficient("inertia", "inertia", 2.0).coefficient("viscous_friction", "drag", 0.05);
  law.coefficient("coulomb_friction", "level", 0.3).coefficient("offset", "offset", 0.1);
  law.coefficient("spring", "linear", 0.7).shape("spring", "centre", 0.2).shape("spring", "span", 2.0);
  law.coefficient("gravity", "sine", 0.4);
  law.coefficient("angle_periodic", "cosine", 0.08).shape("angle_periodic", "order", 8.0);
  return law;
}

template <typename Scalar>
auto motion_at(double q1, double dq1, double ddq1, bool forward) -> Sample<Scalar> {
  return {.q1 = number<Scalar>(q1),
          .dq1 = number<Scalar>(dq1),
          .forward = forward,
          .ddq1 = number<Scalar>(ddq1),
          .q2 = number<Scalar>(q1)};
}

template <typename Scalar>
class TorqueLawIn : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(TorqueLawIn, Formats);

TYPED_TEST(TorqueLawIn, WithoutCoefficientsIsOffAndNoTorque) {
  TorqueLaw<TypeParam> law(one_khz<TypeParam>(), {});
  EXPECT_FALSE(law.is_on());
  EXPECT_EQ(value_of(law.update(motion_at<TypeParam>(1.0, 2.0, 0.01, true)).torque_nm), 0.0);
}

TYPED_TEST(TorqueLawIn, IsTheSumOfItsTerms) {
  TorqueLaw<TypeParam> law(one_khz<TypeParam>(), servo_law().parameters<TypeParam>());
  const double q = 1.2;
  const double expected =
      2.0 * -0.02 + 0.05 * -3.0 - 0.3 + 0.1 + 0.7 * (q - 0.2) / 2.0 + 0.4 * std::sin(q) + 0.08 * std::cos(8.0 * q);
  const Torque<TypeParam> torque = law.update(motion_at<TypeParam>(q, -3.0, -0.02, false));
  EXPECT_NEAR(value_of(torque.torque_nm), expected, 1e-6);
  EXPECT_FALSE(torque.saturated);
}

TYPED_TEST(TorqueLawIn, TermInItsSecondPlaceHasShapesOfItsOwn) {
  TorqueLawBuilder two;
  two.coefficient("angle_periodic", "sine", 0.5).shape("angle_periodic", "order", 1.0);
  two.coefficient("angle_periodic_2", "sine", 0.25).shape("angle_periodic_2", "order", 6.0);
  TorqueLaw<TypeParam> law(one_khz<TypeParam>(), two.parameters<TypeParam>());
  EXPECT_NEAR(value_of(law.update(motion_at<TypeParam>(0.4, 0.0, 0.0, true)).torque_nm),
              0.5 * std::sin(0.4) + 0.25 * std::sin(2.4), 1e-6);
}

TYPED_TEST(TorqueLawIn, SettledPartsAddUpToTheTorqueOfTheMotionAndOnlyOneKnowsTheDirection) {
  TorqueLaw<TypeParam> law(one_khz<TypeParam>(), servo_law().parameters<TypeParam>());
  for (const bool forward : {false, true}) {
    const auto motion = motion_at<TypeParam>(0.7, 1.5, 0.03, forward);
    auto either = motion;
    const auto each_way = law.each_way(either);
    EXPECT_NEAR(value_of(law.either_way(motion) + (forward ? each_way.forward : each_way.backward)),
                value_of(law.update(motion).torque_nm), 2.0 * kLsb);
    EXPECT_EQ(value_of(each_way.forward), value_of(number<TypeParam>(0.3)));
    EXPECT_EQ(value_of(each_way.backward), -value_of(number<TypeParam>(0.3)));
  }
}

TYPED_TEST(TorqueLawIn, RestartsAsNewlyMade) {
  TorqueLawBuilder play;
  play.coefficient("play_friction", "slider", 0.5).coefficient("play_friction", "bristle", 0.5);
  play.shape("play_friction", "half_width", 0.1).coefficient("thermal_drift", "warm_up", 1.0);
  play.shape("thermal_drift", "time", 0.05);
  TorqueLaw<TypeParam> used(one_khz<TypeParam>(), play.parameters<TypeParam>());
  TorqueLaw<TypeParam> fresh = used;
  for (int i = 0; i < 100; ++i) {
    used.update(motion_at<TypeParam>(0.01 * i, 10.0, 0.0, true));
  }
  used.restart();
  for (int i = 0; i < 50; ++i) {
    const auto motion = motion_at<TypeParam>(1.0 - 0.003 * i, -3.0, 0.0, false);
    EXPECT_EQ(value_of(used.update(motion).torque_nm), value_of(fresh.update(motion).torque_nm)) << i;
  }
}

TEST(TorqueLaw, WhoseCoefficientsDoNotFitIsOff) {
  TorqueLawBuilder large;
  large.coefficient("offset", "offset", 100.0).coefficient("coulomb_friction", "level", 100.0);
  large.coefficient("viscous_friction", "drag", 60.0);
  const auto parameters = large.parameters<Q24>();
  EXPECT_FALSE(fits(parameters));
  EXPECT_FALSE(TorqueLaw<Q24>(one_khz<Q24>(), parameters).is_on());
}

TEST(TorqueLaw, SaysWhereItsTorqueMeetsTheEndOfTheRange) {
  TorqueLawBuilder large;
  large.coefficient("viscous_friction", "drag", 2.0);
  TorqueLaw<Q24> law(one_khz<Q24>(), large.parameters<Q24>());
  EXPECT_FALSE(law.update(motion_at<Q24>(0.0, 60.0, 0.0, true)).saturated);
  EXPECT_TRUE(law.update(motion_at<Q24>(0.0, 70.0, 0.0, true)).saturated);
}

TEST(TorqueLaw, TermsHaveNamesOfTheirOwn) {
  std::vector<std::string> names;
  TorqueTerms::for_each<double>([&]<typename Term>() { names.emplace_back(kTorqueTermName<Term>.data()); });
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  EXPECT_TRUE(std::binary_search(names.begin(), names.end(), "play_friction_2"));
}

/// Any number in a range, evenly.
auto any_in(double least, double most) -> double {
  constexpr int kSteps = 1'000'000;
  return least + (most - least) * *rc::gen::inRange(0, kSteps + 1) / kSteps;
}

// Of each term the coefficients are at most 2, so an error of a regressor of e shows as 2 e; all terms together.
RC_GTEST_PROP(TorqueLaw, InFixedPointIsThatInDoubleWithinATenThousandth, ()) {
  TorqueLawParameters<double> law;
  std::size_t shape = 0;
  for (double& coefficient : law.coefficients) {
    coefficient = *rc::gen::inRange(0, 3) == 0 ? Q24::from_double(any_in(-2.0, 2.0)).to_double() : 0.0;
  }
  TorqueTerms::for_each<double>([&]<typename Term>() {
    for (const ShapeInfo& info : Term::kInfo.shapes) {  // widths and speeds not so small that one count is all of them
      const double least = info.minimum >= 0.0 ? std::max(info.minimum, 0.05) : -3.0;
      law.shapes[shape++] = Q24::from_double(any_in(least, std::min(info.maximum, 10.0))).to_double();
    }
  });
  TorqueLaw<double> exact(one_khz<double>(), law);
  TorqueLaw<Q24> fixed(one_khz<Q24>(), test::fixed_of(law));
  const double amplitude = any_in(0.1, 3.0);
  const double rate = any_in(0.1, 6.0);
  for (int i = 0; i < 200; ++i) {
    const double phase = 0.05 * i;
    const auto motion = motion_at<Q24>(amplitude * std::sin(phase), amplitude * rate * std::cos(phase),
                                       -0.001 * amplitude * rate * rate * std::sin(phase), std::cos(phase) > 0.0);
    const auto same =
        motion_at<double>(motion.q1.to_double(), motion.dq1.to_double(), motion.ddq1.to_double(), motion.forward);
    const Torque<Q24> torque = fixed.update(motion);
    const double expected = exact.update(same).torque_nm;
    RC_ASSERT(torque.saturated || std::abs(torque.torque_nm.to_double() - expected) < 1e-4);
  }
}

}  // namespace
}  // namespace capstan
