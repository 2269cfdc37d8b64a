// SPDX-License-Identifier: Apache-2.0
// What the conditioner remembers and passes on for the terms that need more than angle, rate and torque.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::RandomMultisine;
using test::value_of;

template <typename Scalar>
class Memory : public testing::Test {
 protected:
  auto feed(double q1, double tau = 0.0) -> Sample<Scalar> {
    return conditioner_.update(number<Scalar>(q1), number<Scalar>(tau));
  }
  SampleConditioner<Scalar> conditioner_{one_khz<Scalar>(), {number<Scalar>(0.0078125), number<Scalar>(0.002)}};
};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Memory, Formats);

TYPED_TEST(Memory, IsOfTheTurningPointAndNotOfTheLateSwitch) {
  EXPECT_EQ(value_of(this->feed(0.0, 1.0).tau_reversal), 1.0) << "before any reversal: where it began";
  this->feed(0.5, 2.0);
  this->feed(1.0, 3.0);                                            // the turning point
  EXPECT_EQ(value_of(this->feed(0.995, -4.0).tau_reversal), 1.0);  // not yet beyond the threshold
  const auto switched = this->feed(0.75, -5.0);
  EXPECT_FALSE(switched.forward);
  EXPECT_EQ(value_of(switched.tau_reversal), 3.0);
  EXPECT_EQ(value_of(switched.q1_reversal), 1.0);
  this->feed(0.25, -6.0);
  EXPECT_EQ(value_of(this->feed(0.5, 7.0).tau_reversal), -6.0);
  EXPECT_EQ(value_of(this->feed(0.75, 8.0).q1_reversal), 0.25);
}

TYPED_TEST(Memory, KeepsTheTorqueOfTheStopWhileTheMotorRests) {
  this->feed(0.0, 0.0);
  this->feed(1.0, 2.0);
  for (int i = 0; i < 1000; ++i) {
    this->feed(1.0, 2.0 - 0.002 * i);  // the torque fades at rest
  }
  EXPECT_EQ(value_of(this->feed(0.5, -1.0).tau_reversal), 2.0);
}

/// Where the last monotone stretch began, from the whole history at once.
RC_GTEST_PROP(MemoryProperties, IsTheExtremeOfEveryStroke, ()) {
  SampleConditioner<Q24> conditioner(one_khz<Q24>(), {});
  const Q24 threshold = ConditionerShape<Q24>{}.direction_threshold_rad;
  Q24 q1;
  Q24 tau;
  auto sample = conditioner.update(q1, tau);
  bool forward = true;
  for (const std::int32_t torque :
       *rc::gen::container<std::vector<std::int32_t>>(rc::gen::inRange(-9999999, 9999999))) {
    const Q24 turning_angle = q1;
    const Q24 turning_torque = tau;
    tau = Q24::from_raw(torque);
    q1 = forward ? q1 + threshold + threshold : q1 - threshold - threshold;
    sample = conditioner.update(q1, tau);
    RC_ASSERT(sample.q1_reversal == turning_angle);
    RC_ASSERT(sample.tau_reversal == turning_torque);
    forward = !forward;
  }
}

// q1 = a t^2 / 2 has the acceleration a, whatever filters it passed.
TYPED_TEST(Memory, AccelerationOfAParabolaIsItsSecondDerivative) {
  constexpr double kAcceleration = 75.0;
  for (int i = 0; i < 500; ++i) {
    const double t = 0.001 * i;
    const double ddq1 = value_of(this->feed(0.5 * kAcceleration * t * t).ddq1);
    if (i > 200) {
      // A rounded angle's second difference is off by two units in 1e-6 s2, of which a 27th passes both filters.
      ASSERT_NEAR(ddq1, 0.001 * kAcceleration,
                  5e-9 + (std::is_same_v<TypeParam, double> ? 0.0 : 2000.0 * test::kLsb / 10.0));
    }
  }
}

// 2 ms and 8 ms in a row: A w^2 / sqrt((1 + (2 w)^2)(1 + (8 w)^2)), and as much phase.
TEST(Acceleration, OfASineIsThatOfTwoLagsInARow) {
  constexpr double kOmega = 30.0;
  constexpr double kDt = 1e-5;
  SampleConditioner<double> conditioner(SamplePeriod<double>(kDt), {0.001, 0.002});
  for (int i = 0; i * kDt < 0.6; ++i) {
    const double t = i * kDt;
    const double ddq1 = conditioner.update(std::sin(kOmega * t), 0.0).ddq1;
    const double gain = 1.0 / std::sqrt((1.0 + 0.0036) * (1.0 + 0.0576));
    const double expected = -0.001 * kOmega * kOmega * gain * std::sin(kOmega * t - std::atan(0.06) - std::atan(0.24));
    if (t > 0.2) {
      ASSERT_NEAR(ddq1, expected, 0.001 * 2.0 * kDt * kOmega * kOmega * kOmega) << t;
    }
  }
}

TYPED_TEST(Memory, PassesOnWhatIsKnownAndStandsInForWhatIsNot) {
  Measured<TypeParam> now{.q1 = number<TypeParam>(0.5)};
  auto sample = this->conditioner_.update(now);
  EXPECT_EQ(value_of(sample.q2), 0.5);
  EXPECT_EQ(value_of(sample.warmth), 0.0);
  EXPECT_EQ(value_of(sample.others[0].q1), 0.0);
  now.q2 = number<TypeParam>(-0.25);
  now.temperature = number<TypeParam>(21.5);
  now.others[0].q1 = number<TypeParam>(3.0);
  now.others[0].tau = number<TypeParam>(-0.125);
  now.others[0].forward = false;
  sample = this->conditioner_.update(now);
  EXPECT_EQ(value_of(sample.q2), -0.25);
  EXPECT_EQ(value_of(sample.warmth), -3.5);
  EXPECT_EQ(value_of(sample.others[0].q1), 3.0);
  EXPECT_EQ(value_of(sample.others[0].tau), -0.125);
  EXPECT_FALSE(sample.others[0].forward);
}

// The law runs free: what a caller says of q2 must not reach it, and extras must not change a law without their terms.
TEST(LawInputs, ExtrasDoNotChangeALawThatHasNoTermForThem) {
  test::LawBuilder joint;
  joint.coefficient("motor_angle", "beta", 1.142)
      .coefficient("joint_offset", "offset", -0.31)
      .coefficient("tendon_elongation", "top", -1.626);
  auto plain = joint.law<Q24>();
  auto full = joint.law<Q24>();
  const RandomMultisine angle(51, 6.0, 0.1, 3.0);
  for (int i = 0; i < 3000; ++i) {
    const Q24 q1 = number<Q24>(angle(0.001 * i));
    const Q24 tau = number<Q24>(0.1 * angle(0.001 * i + 0.3));
    const auto a = plain.update(q1, tau);
    const auto b = full.update({.q1 = q1,
                                .tau = tau,
                                .q2 = Q24::from_int(99),
                                .others = {{{q1, tau, false}}},
                                .temperature = Q24::from_int(60)});
    ASSERT_EQ(a.q2, b.q2);
    ASSERT_EQ(a.saturated, b.saturated);
    ASSERT_NE(full.sample().q2, Q24::from_int(99));
  }
}

TEST(LawInputs, JointAngleOfTheLastCycleIsTheLastEstimateAndAtFirstTheRigidOne) {
  test::LawBuilder joint;
  joint.coefficient("motor_angle", "beta", 2.0)
      .coefficient("joint_offset", "offset", 0.5)
      .coefficient("tendon_elongation", "top", -1.0);
  auto law = joint.law<Q24>();
  const Q24 tau = number<Q24>(0.25);
  const auto first = law.update(Q24::from_int(1), tau);
  EXPECT_EQ(law.sample().q2, number<Q24>(2.5));
  EXPECT_EQ(first.q2, number<Q24>(2.25));
  law.update(Q24::from_int(2), tau);
  EXPECT_EQ(law.sample().q2, first.q2);
}

TEST(LawInverse, DoesNotDependOnWhereTheMotorIsWithoutAPeriodicTerm) {
  test::LawBuilder joint;
  joint.coefficient("motor_angle", "beta", 1.142)
      .coefficient("tendon_elongation", "top", -1.626)
      .coefficient("pretension_offset", "contrast", 0.017);
  const auto law = joint.law<Q24>();
  Sample<Q24> motion{.tau = number<Q24>(0.1)};
  const Q24 q1 = law.invert(number<Q24>(0.7), motion);
  for (const double elsewhere : {-30.0, 0.1234567, 25.0}) {
    motion.q1 = number<Q24>(elsewhere);
    EXPECT_EQ(law.invert(number<Q24>(0.7), motion), q1);
  }
}

}  // namespace
}  // namespace capstan
