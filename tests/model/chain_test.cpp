// SPDX-License-Identifier: Apache-2.0
// The law as a chain: input terms, sum, output terms.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::LawBuilder;
using test::number;
using test::value_of;

auto plain() -> LawBuilder {
  LawBuilder builder;
  builder.conditioner(0.001, 0.002)
      .coefficient("motor_angle", "beta", 0.93)
      .coefficient("joint_offset", "offset", 0.02)
      .coefficient("tendon_elongation", "top", -0.4)
      .coefficient("tendon_elongation", "bottom", -0.3)
      .coefficient("transmission_viscous", "top", 0.004)
      .coefficient("transmission_viscous", "bottom", -0.003);
  return builder;
}

template <typename Scalar>
class Chain : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Chain, Formats);

// Widths without weights, shapes without coefficients: as if they were not there, bit for bit.
TYPED_TEST(Chain, OfStagesThatAreOffIsBitIdenticalToTheSum) {
  LawBuilder off = plain();
  off.shape("hysteresis", "half_width_1", 0.3)
      .shape("hysteresis", "half_width_4", 0.05)
      .shape("curved_ratio", "span", 2.0)
      .shape("coupled_hysteresis_2", "half_width", 0.1)
      .shape("table", "knots", 17)
      .shape("table", "low", -1.0)
      .shape("table", "high", 1.0)
      .shape("table", "factor", 2.0);
  auto with = off.law<TypeParam>();
  auto without = plain().law<TypeParam>();
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.001 * i;
    Measured<TypeParam> now{.q1 = number<TypeParam>(1.3 * std::sin(3.0 * t)),
                            .tau = number<TypeParam>(0.1 * std::cos(2.0 * t))};
    now.others.fill({number<TypeParam>(std::sin(t)), number<TypeParam>(0.1), i % 7 < 3});
    const auto a = with.update(now);
    const auto b = without.update(now);
    ASSERT_EQ(a.q2, b.q2);
    ASSERT_EQ(a.q2_reported, b.q2_reported);
    ASSERT_EQ(a.saturated, b.saturated);
    ASSERT_EQ(with.invert(a.q2, with.sample()), without.invert(a.q2, without.sample()));
  }
}

// beta q1 + sum c_i (P_i - q1) is how a bank of plays is fitted; folded into the stage it is the same law.
TYPED_TEST(Chain, OfAHysteresisAndARatioIsABankOfPlaysBesideTheRatio) {
  LawBuilder chain;
  chain.coefficient("motor_angle", "beta", 0.8)
      .shape("hysteresis", "half_width_1", 0.05)
      .shape("hysteresis", "weight_1", 0.25);
  LawBuilder sum;
  sum.coefficient("motor_angle", "beta", 0.8).coefficient("play", "gain", 0.2).shape("play", "half_width", 0.05);
  auto a = chain.law<TypeParam>();
  auto b = sum.law<TypeParam>();
  for (int i = 0; i < 5000; ++i) {
    const auto q1 = number<TypeParam>(0.4 * std::sin(0.004 * i) + 0.1 * std::sin(0.017 * i));
    ASSERT_NEAR(value_of(a.update(q1, TypeParam{}).q2), value_of(b.update(q1, TypeParam{}).q2), 4.0 * test::kLsb);
  }
}

// Torque, direction and what hangs on the motor itself do not see the stage.
TYPED_TEST(Chain, LeavesTorqueAndDirectionToTheMotor) {
  LawBuilder builder = plain();
  builder.shape("hysteresis", "half_width_1", 0.5).shape("hysteresis", "weight_1", 1.0);
  auto law = builder.law<TypeParam>();
  auto bare = plain().law<TypeParam>();
  for (int i = 0; i < 300; ++i) {
    const auto q1 = number<TypeParam>(0.001 * (i < 150 ? i : 300 - i));
    law.update(q1, number<TypeParam>(0.1));
    bare.update(q1, number<TypeParam>(0.1));
    ASSERT_EQ(law.sample().forward, bare.sample().forward);
    ASSERT_EQ(law.sample().dq1, bare.sample().dq1);
    ASSERT_EQ(law.sample().q1, q1);
    ASSERT_NEAR(value_of(law.sample().h), 0.0, 1e-12) << "the play is not crossed yet";
  }
}

// (6.21) in lost motion: the joint stands, so v is half of r1 q1'; beyond it is r1 q1'.
TYPED_TEST(Chain, DragsByTheMeanSpeedOfBothPulleys) {
  LawBuilder builder;
  builder.conditioner(0.001, 0.002)
      .coefficient("motor_angle", "beta", 1.0)
      .coefficient("transmission_viscous", "top", 0.05)
      .coefficient("transmission_viscous", "bottom", 0.05)
      .shape("hysteresis", "half_width_1", 0.1)
      .shape("hysteresis", "weight_1", 1.0);
  auto law = builder.law<TypeParam>();
  double q2 = 0.0;
  for (int i = 0; i <= 1000; ++i) {  // 1 rad/s: in the gap until i = 100
    q2 = value_of(law.update(number<TypeParam>(0.001 * i), TypeParam{}).q2);
    if (i == 80) {
      EXPECT_NEAR(q2, 0.05 * 0.5, 1e-4);
    }
  }
  EXPECT_NEAR(q2, 1.0 - 0.1 + 0.05, 1e-4);
}

/// A law with every stage of the chain, monotone.
auto any_chain() -> LawBuilder {
  LawBuilder builder;
  const double beta = 0.01 * *rc::gen::inRange(40, 150) * *rc::gen::element(-1.0, 1.0);
  const double span = 0.1 * *rc::gen::inRange(5, 40);
  builder.conditioner(0.0005, 0.002)
      .coefficient("motor_angle", "beta", beta)
      .coefficient("joint_offset", "offset", 0.01 * *rc::gen::inRange(-50, 50))
      .coefficient("tendon_elongation", "top", -0.01 * *rc::gen::inRange(0, 100))
      .coefficient("tendon_elongation", "bottom", -0.01 * *rc::gen::inRange(0, 100))
      .coefficient("curved_ratio", "square", 0.2 * beta * span * 0.01 * *rc::gen::inRange(-100, 101))
      .coefficient("curved_ratio", "cube", 0.1 * beta * span * 0.01 * *rc::gen::inRange(-100, 101))
      .shape("curved_ratio", "centre", 0.1 * *rc::gen::inRange(-5, 6))
      .shape("curved_ratio", "span", span);
  for (const char* play : {"1", "2", "3", "4", "5", "6"}) {
    builder.shape("hysteresis", std::string("half_width_") + play, 0.001 * *rc::gen::inRange(1, 60))
        .shape("hysteresis", std::string("weight_") + play, 0.01 * *rc::gen::inRange(0, 17));
  }
  return builder;
}

// Where a long motion ends, its inverse must put the motor: there and back through every stage, either way.
template <typename Scalar>
void goes_there_and_back(const LawBuilder& builder, bool forward, double within) {
  auto law = builder.law<Scalar>();
  const double sign = forward ? 1.0 : -1.0;
  Estimate<Scalar> estimate;
  for (int i = 0; i <= 900; ++i) {
    estimate = law.update(number<Scalar>(sign * (0.002 * i - 0.9)), number<Scalar>(0.05 * sign));
  }
  Sample<Scalar> motion = law.sample();
  const double q1 = value_of(motion.q1);
  motion.q1 = number<Scalar>(q1 - 0.05 * sign);  // where the reference was, not where it is
  RC_ASSERT(std::fabs(value_of(law.invert(estimate.q2, motion)) - q1) < within);
}
RC_GTEST_PROP(ChainInverse, PutsTheMotorWhereTheMotionEnded, ()) {
  const LawBuilder builder = any_chain();
  const bool forward = *rc::gen::arbitrary<bool>();
  goes_there_and_back<double>(builder, forward, 1e-5);
  goes_there_and_back<Q24>(builder, forward, 1e-5);
}

RC_GTEST_PROP(ChainAccuracy, OfFixedPointIsThatOfTheTermsTogether, ()) {
  const LawBuilder builder = any_chain();
  auto exact = builder.law<double>();
  auto fixed = builder.law<Q24>();
  const test::RandomMultisine angle(static_cast<std::uint32_t>(*rc::gen::inRange(0, 100000)), 2.0, 0.2, 3.0);
  const test::RandomMultisine torque(static_cast<std::uint32_t>(*rc::gen::inRange(0, 100000)), 0.3, 0.2, 3.0);
  for (int i = 0; i < 500; ++i) {
    const double count = 3e-4;
    const double q1 = count * std::round(angle(0.001 * i) / count);
    const auto wanted = exact.update(q1, torque(0.001 * i));
    const auto got = fixed.update(number<Q24>(q1), number<Q24>(torque(0.001 * i)));
    RC_ASSERT(!got.saturated);
    RC_ASSERT(exact.sample().forward != fixed.sample().forward || std::fabs(got.q2.to_double() - wanted.q2) < 2e-5);
  }
}

TEST(LawCheck, RefusesARatioThatTurnsBackAndATableWithItsEndsOutOfOrder) {
  LawBuilder builder = plain();
  EXPECT_EQ(check_parts(builder.parameters<Q24>()), LawFault::kNone);
  builder.shape("curved_ratio", "span", 1.0).coefficient("curved_ratio", "square", 0.44);
  EXPECT_EQ(check_parts(builder.parameters<Q24>()), LawFault::kNone) << "0.93 - 0.88 is left at one end";
  builder.coefficient("curved_ratio", "square", 0.47);
  EXPECT_EQ(check_parts(builder.parameters<Q24>()), LawFault::kRatioTurnsBack);
  LawBuilder table = plain();
  table.shape("table", "knots", 3).shape("table", "low", 1.0).shape("table", "high", 0.5);
  EXPECT_EQ(check_parts(table.parameters<Q24>()), LawFault::kNone) << "it is off";
  table.coefficient("table", "backward_1", 0.1);
  EXPECT_EQ(check_parts(table.parameters<Q24>()), LawFault::kTableEnds);
}

}  // namespace
}  // namespace capstan
