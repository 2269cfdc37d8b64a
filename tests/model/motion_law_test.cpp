// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/motion_law.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "capstan/model/declared_range.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::kLsb;
using test::LawBuilder;
using test::number;
using test::one_khz;
using test::RandomMultisine;
using test::value_of;

// The law is a constant expression: no hidden state, no I/O, no allocation.
static_assert([] {
  LawParameters<Q24> parameters;
  parameters.coefficients[0] = Q24::from_double(0.5);
  MotionLaw<Q24> law(SamplePeriod<Q24>(1000), parameters);
  return law.update(Q24::from_int(3), Q24{}).q2 == Q24::from_double(1.5);
}());

auto joint_with_everything() -> LawBuilder {
  LawBuilder joint;
  joint.coefficient("motor_angle", "beta", 1.142)
      .coefficient("joint_offset", "offset", -0.31)
      .coefficient("tendon_elongation", "top", -1.626)
      .coefficient("tendon_elongation", "bottom", -1.213)
      .coefficient("transmission_viscous", "top", -0.021)
      .coefficient("transmission_viscous", "bottom", -0.034)
      .coefficient("pretension_offset", "contrast", 0.017)
      .coefficient("play", "gain", 1.142)
      .shape("play", "half_width", 0.0213)
      .coefficient("slip_propagation", "a", -0.7)
      .shape("slip_propagation", "torque", 0.05)
      .shape("transport_delay", "delay", 0.0127)
      .conditioner(0.001, 0.005);
  return joint;
}

/// The same joint written out by hand, the whole history at hand and nothing shared with the model.
struct HandWritten {
  std::vector<double> q1;
  std::vector<double> joint_angle;
  double rate = 0.0;
  double pulled_up_to = 0.0;  // extreme of q1 in the present direction
  double middle_of_gap = 0.0;
  std::array<double, 8> torque_arrived{};  // from no torque on
  int direction = 1;

  auto next(double q, double tau) -> double {
    const double before = q1.empty() ? q : q1.back();
    pulled_up_to = q1.empty() ? q : pulled_up_to;
    middle_of_gap = q1.empty() ? q : middle_of_gap;
    q1.push_back(q);
    rate = (0.005 * rate + (q - before)) / 0.006;  // T x' + x = u by backward Euler: (T x_old + dt u) / (T + dt)
    if (direction * (pulled_up_to - q) > 0.001) {
      direction = -direction;
      pulled_up_to = q;
    }
    pulled_up_to = direction > 0 ? std::max(pulled_up_to, q) : std::min(pulled_up_to, q);
    middle_of_gap = std::min(std::max(middle_of_gap, q - 0.0213), q + 0.0213);
    double missing_torque = 0.0;
    for (std::size_t k = 0; k < 8; ++k) {
      const double half_width = 0.05 * (2.0 * static_cast<double>(k) + 1.0) / 16.0;
      torque_arrived[k] = std::min(std::max(torque_arrived[k], tau - half_width), tau + half_width);
      missing_torque += (torque_arrived[k] - tau) / 8.0;
    }
    const double y = -0.31 + 1.142 * middle_of_gap + (direction > 0 ? -1.626 : -1.213) * tau +
                     (direction > 0 ? -0.021 : -0.034) * rate + 0.017 * direction - 0.7 * missing_torque;
    joint_angle.push_back(y);
    return y;
  }
  [[nodiscard]] auto reported() const -> double {
    auto past = [this](std::size_t age) {
      return joint_angle.size() > age ? joint_angle[joint_angle.size() - 1 - age] : joint_angle[0];
    };
    return 0.3 * past(12) + 0.7 * past(13);  // 12.7 samples ago
  }
};

TEST(MotionLaw, IsTheSumWrittenOutByHand) {
  auto exact = joint_with_everything().law<double>();
  auto fixed = joint_with_everything().law<Q24>();
  HandWritten by_hand;
  const RandomMultisine angle(11, 6.0, 0.1, 3.0);
  const RandomMultisine torque(12, 0.4, 0.1, 3.0);
  for (int i = 0; i < 20000; ++i) {
    const double q1 = angle(0.001 * i);
    const double tau = torque(0.001 * i);
    const auto estimate = exact.update(q1, tau);
    const auto fixed_estimate = fixed.update(number<Q24>(q1), number<Q24>(tau));
    const double expected = by_hand.next(q1, tau);
    ASSERT_NEAR(estimate.q2, expected, 1e-11) << "sample " << i;
    ASSERT_NEAR(estimate.q2_reported, by_hand.reported(), 1e-11) << "sample " << i;
    ASSERT_NEAR(fixed_estimate.q2.to_double(), expected, 2e-5) << "sample " << i;
    ASSERT_NEAR(fixed_estimate.q2_reported.to_double(), by_hand.reported(), 2e-5) << "sample " << i;
    ASSERT_FALSE(fixed_estimate.saturated);
  }
}

// The base law is put together here from its three terms alone; the full law has all other effects in it with
// coefficients of zero but shapes far from harmless.
TEST(MotionLaw, WithEffectsTurnedOffIsBitIdenticalToOneWithoutThem) {
  LawBuilder joint;
  joint.coefficient("motor_angle", "beta", 1.142)
      .coefficient("joint_offset", "offset", -0.31)
      .coefficient("tendon_elongation", "top", -1.626)
      .coefficient("tendon_elongation", "bottom", -1.213)
      .shape("play", "half_width", 0.4)
      .shape("slip_propagation", "torque", 1.3);
  auto full = joint.law<Q24>();
  SampleConditioner<Q24> conditioner(one_khz<Q24>(), {});
  MotorAngle<Q24> motor_angle(one_khz<Q24>(), {});
  TendonElongation<Q24> elongation(one_khz<Q24>(), {});
  const RandomMultisine angle(21, 20.0, 0.1, 3.0);
  const RandomMultisine torque(22, 2.0, 0.1, 3.0);
  for (int i = 0; i < 20000; ++i) {
    const Q24 q1 = number<Q24>(angle(0.001 * i));
    const Q24 tau = number<Q24>(torque(0.001 * i));
    const auto sample = conditioner.update(q1, tau);
    const auto pair = elongation.update(sample);
    // Added up exactly and rounded once, halves upwards.
    const auto product = [](double coefficient, Q24 regressor) {
      return std::int64_t{number<Q24>(coefficient).raw()} * regressor.raw();
    };
    const std::int64_t exact = product(1.142, motor_angle.update(sample)[0]) + product(-0.31, Q24::from_int(1)) +
                               product(-1.626, pair[0]) + product(-1.213, pair[1]);
    const Q24 base = Q24::from_raw(static_cast<std::int32_t>((exact + (1 << 23)) >> 24));
    const auto estimate = full.update(q1, tau);
    ASSERT_EQ(estimate.q2.raw(), base.raw()) << "sample " << i;
    ASSERT_EQ(estimate.q2_reported.raw(), base.raw()) << "sample " << i;
  }
}

template <typename Scalar>
class AnyMotionLaw : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(AnyMotionLaw, Formats);

// Every effect is on, so no memory of any of them may be left.
TYPED_TEST(AnyMotionLaw, ARestartedOneGoesOnBitForBitLikeANewOne) {
  LawParameters<TypeParam> parameters;
  parameters.coefficients.fill(number<TypeParam>(0.05));
  std::size_t next = 0;
  const auto add = [&]<typename Term>() {
    for (const auto& shape : Term::kInfo.shapes) {
      parameters.shapes[next++] = number<TypeParam>(std::max(shape.initial, 0.01));
    }
  };
  InputTerms::for_each<TypeParam>(add);
  SumTerms::for_each<TypeParam>(add);
  OutputTerms::for_each<TypeParam>(add);
  const RandomMultisine angle(41, 6.0, 0.1, 3.0);
  const RandomMultisine torque(42, 0.4, 0.1, 3.0);
  MotionLaw<TypeParam> used(one_khz<TypeParam>(), parameters);
  MotionLaw<TypeParam> fresh(one_khz<TypeParam>(), parameters);
  const auto step = [&](MotionLaw<TypeParam>& law, int i) {
    return law.update(number<TypeParam>(angle(0.001 * i)), number<TypeParam>(torque(0.001 * i)));
  };
  for (int i = 0; i < 1777; ++i) {
    step(used, i);
  }
  used.restart();
  bool differed = false;
  for (int i = 2000; i < 5000; ++i) {
    const auto first = step(used, i);
    const auto second = step(fresh, i);
    ASSERT_EQ(first.q2, second.q2) << i;
    ASSERT_EQ(first.q2_reported, second.q2_reported) << i;
    ASSERT_EQ(used.invert(first.q2, used.sample()), fresh.invert(second.q2, fresh.sample())) << i;
    ASSERT_EQ(first.saturated, second.saturated) << i;
    differed |= first.q2 != first.q2_reported;
  }
  EXPECT_TRUE(differed) << "the output term has a memory too";
}

TEST(MotionLaw, ACopyGoesOnBitForBitLikeTheOriginal) {
  auto original = joint_with_everything().law<Q24>();
  const RandomMultisine angle(31, 6.0, 0.1, 3.0);
  for (int i = 0; i < 777; ++i) {
    original.update(number<Q24>(angle(0.001 * i)), Q24{});
  }
  auto copy = original;
  for (int i = 777; i < 3000; ++i) {
    const Q24 q1 = number<Q24>(angle(0.001 * i));
    const auto first = original.update(q1, Q24{});
    const auto second = copy.update(q1, Q24{});
    ASSERT_EQ(first.q2, second.q2);
    ASSERT_EQ(first.q2_reported, second.q2_reported);
  }
}

/// A random number of millionths, |x| <= limit.
auto any_within(double limit) -> double {
  const auto bound = static_cast<std::int32_t>(limit * 1e6);
  return 1e-6 * *rc::gen::inRange(-bound, bound + 1);
}

// q2 = round(beta q1 + rest) and q1 = round((q2 - round(rest)) / beta) with the rest in two parts, so in units of the
// last place the way back errs by 1/2 in the sum and 1/2 in each part, divided by beta, and by 1/2 in the quotient and
// 2^-31 of it in the reciprocal: a 128th of a unit per rad.
RC_GTEST_PROP(MotionLawInverse, FindsTheMotorAngleOfASettledMotion, ()) {
  const double beta = (*rc::gen::arbitrary<bool>() ? 1.0 : -1.0) * (0.25 + std::fabs(any_within(1.5)));
  LawBuilder joint = joint_with_everything();
  joint.coefficient("motor_angle", "beta", beta)
      .coefficient("tendon_elongation", "top", any_within(5.0))
      .coefficient("tendon_elongation", "bottom", any_within(5.0))
      .coefficient("transmission_viscous", "top", any_within(0.1))
      .coefficient("play", "gain", any_within(2.0))
      .shape("transport_delay", "delay", 0.0);
  auto law = joint.law<Q24>();
  const double speed = (*rc::gen::arbitrary<bool>() ? 1.0 : -1.0) * (1.0 + std::fabs(any_within(10.0)));
  const double tau = any_within(4.0);
  const Q24 step = number<Q24>(0.001 * speed);
  Q24 q1 = number<Q24>(any_within(8.0));
  const double growth = speed > 0.0 ? 0.0005 : -0.0005;  // the torque rises with the motion, by more than 2 R
  Estimate<Q24> estimate;
  for (int i = 499; i >= 0; --i) {
    q1 += step;
    estimate = law.update(q1, number<Q24>(tau - growth * i));
  }
  RC_ASSERT(!estimate.saturated);
  const double back = law.invert(estimate.q2, law.sample()).to_double();
  RC_ASSERT(std::fabs(back - q1.to_double()) <=
            (1.5 / std::fabs(law.beta().to_double()) + 0.5 + std::fabs(back) / 128.0) * kLsb);
}

// The other way round: the joint stands at the wanted angle once the motor stands where `invert` says, but for the
// quotient's error times beta, 1/2 in each part of the rest and 1/2 in the sum.
RC_GTEST_PROP(MotionLawInverse, LeadsTheJointToTheWantedAngle, ()) {
  auto law = joint_with_everything().law<Q24>();
  const Q24 wanted = number<Q24>(any_within(20.0));
  Sample<Q24> motion{.tau = number<Q24>(any_within(0.5)), .forward = *rc::gen::arbitrary<bool>()};
  const Q24 q1 = law.invert(wanted, motion);
  // Come from far enough away in the given direction, torque and all, then rest until the rate has gone.
  const Q24 away = number<Q24>(motion.forward ? -0.0625 : 0.0625);
  Estimate<Q24> estimate;
  for (int i = 4; i >= 0; --i) {
    estimate = law.update(q1 + away * Q24::from_int(i), motion.tau + away * Q24::from_int(i));
  }
  for (int i = 0; i < 500; ++i) {
    estimate = law.update(q1, motion.tau);
  }
  RC_ASSERT(law.sample().forward == motion.forward);
  // A filter at rest stops up to three units above zero, where a sixth of it rounds to nothing; times 0.034 s that is
  // no unit.
  RC_ASSERT(std::fabs(estimate.q2.to_double() - wanted.to_double()) <=
            (1.142 * (0.5 + std::fabs(q1.to_double()) / 128.0) + 1.0 + 0.034 * 3.0 + 0.5) * kLsb);
}

TEST(MotionLawInverse, SaturatesWithoutARatio) {
  const auto law = LawBuilder().law<Q24>();
  EXPECT_EQ(law.invert(Q24::from_int(1), {}), Q24::max());
  EXPECT_EQ(law.invert(Q24::from_int(-1), {}), Q24::lowest());
}

TEST(MotionLawInverse, KnowsHowFarTheMotorGoesWhileTheJointTurnsRound) {
  LawBuilder joint;
  joint.coefficient("motor_angle", "beta", 1.08)
      .coefficient("joint_offset", "offset", 0.3)
      .coefficient("tendon_elongation", "top", -0.9)
      .coefficient("tendon_elongation", "bottom", -0.7)
      .coefficient("play", "gain", 1.0)
      .shape("play", "half_width", 0.02);
  const double stretch_and_gap = 0.9 * 0.06 + 0.7 * 0.04 + 2.0 * 0.02;
  EXPECT_NEAR(joint.law<double>().lost_motion(-0.04, 0.06), stretch_and_gap / 1.08, 1e-12);
  EXPECT_NEAR(value_of(joint.law<Q24>().lost_motion(number<Q24>(-0.04), number<Q24>(0.06))), stretch_and_gap / 1.08,
              4.0 * kLsb);
  joint.shape("hysteresis", "half_width_1", 0.01).shape("hysteresis", "weight_1", 0.5);
  EXPECT_NEAR(joint.law<double>().lost_motion(-0.04, 0.06), stretch_and_gap / 1.08 + 2.0 * 0.5 * 0.01, 1e-12);
  joint.coefficient("play", "gain", -9.0);
  EXPECT_EQ(joint.law<double>().lost_motion(-0.04, 0.06), 0.0) << "a joint that goes ahead of its motor";
}

TEST(MotionLawSaturation, CutsNothingWhereALaterTermLeadsTheSumBack) {
  LawBuilder joint;
  joint.coefficient("motor_angle", "beta", 2.0)
      .coefficient("joint_offset", "offset", 30.0)
      .coefficient("tendon_elongation", "top", -10.0);
  auto law = joint.law<Q24>();
  const auto estimate = law.update(Q24::from_int(50), Q24::from_int(5));  // 2 * 50 + 30 is beyond 128
  EXPECT_EQ(estimate.q2, Q24::from_int(80));
  EXPECT_FALSE(estimate.saturated);
  EXPECT_TRUE(law.update(Q24::from_int(50), Q24{}).saturated);
}

// Every regressor at an end of its range and the largest coefficients that may be: what is not within the range is cut
// there, and says so.
RC_GTEST_PROP(MotionLawSaturation, IsNeverAWrap, ()) {
  using Limits = std::numeric_limits<std::int32_t>;
  const auto any_raw =
      rc::gen::oneOf(rc::gen::arbitrary<std::int32_t>(), rc::gen::element(Limits::min(), Limits::max()));
  WeightedSum<Q24> sum;
  long double exact = 0.0L;
  std::array<Q24, 4> coefficients{};
  for (Q24& coefficient : coefficients) {
    coefficient = Q24::from_raw(*any_raw / 3);
    const Q24 regressor = Q24::from_raw(*any_raw);
    sum.add_checked(coefficient, regressor);
    exact += static_cast<long double>(coefficient.raw()) * regressor.raw() * 0x1p-48L;
  }
  RC_ASSERT(WeightedSum<Q24>::holds(coefficients));
  const long double within = std::clamp(exact, -128.0L, 128.0L - 0x1p-24L);
  RC_ASSERT(std::fabs(static_cast<double>(static_cast<long double>(sum.value().to_double()) - within)) <= 0.5 * kLsb);
  RC_ASSERT(sum.cut() || sum.value().is_saturated() || within == exact);
}

TEST(MotionLawSaturation, IsAllThatALawOfTooLargeCoefficientsSays) {
  LawParameters<Q24> parameters;
  parameters.coefficients.fill(Q24::from_int(12));
  EXPECT_TRUE(fits(LawParameters<Q24>{}));
  EXPECT_FALSE(fits(parameters));
  MotionLaw<Q24> law(one_khz<Q24>(), parameters);
  const auto estimate = law.update(Q24::from_double(0.5), Q24::from_double(0.1));
  EXPECT_TRUE(estimate.saturated);
  EXPECT_EQ(estimate.q2, Q24{});
}

TEST(MotionLawSaturation, IsFlaggedForEveryInputAndProduct) {
  LawBuilder joint;
  joint.coefficient("motor_angle", "beta", 2.0).coefficient("tendon_elongation", "top", -5.0);
  EXPECT_TRUE(joint.law<Q24>().update(Q24::max(), Q24{}).saturated);
  EXPECT_TRUE(joint.law<Q24>().update(Q24::from_int(65), Q24{}).saturated);
  EXPECT_TRUE(joint.law<Q24>().update(Q24{}, Q24::from_int(26)).saturated);
  EXPECT_TRUE(joint.law<Q24>().update(Q24{}, Q24::lowest()).saturated);
  EXPECT_FALSE(joint.law<Q24>().update(Q24::from_int(63), Q24{}).saturated);
}

TEST(MotionLawSaturation, DoesNotHappenInTheCornersOfTheDeclaredRange) {
  using Range = DeclaredRange;
  for (const double sign : {1.0, -1.0}) {
    LawBuilder joint;
    joint.coefficient("motor_angle", "beta", Range::kBeta)
        .coefficient("joint_offset", "offset", sign * Range::kOffsetRad)
        .coefficient("tendon_elongation", "top", -Range::kElongationRadPerNm)
        .coefficient("tendon_elongation", "bottom", -Range::kElongationRadPerNm)
        .coefficient("transmission_viscous", "top", Range::kViscousS)
        .coefficient("transmission_viscous", "bottom", Range::kViscousS)
        .coefficient("pretension_offset", "contrast", Range::kContrastRad)
        .coefficient("play", "gain", -Range::kPlayGain)
        .shape("play", "half_width", Range::kPlayHalfWidthRad)
        .coefficient("slip_propagation", "a", Range::kElongationRadPerNm)
        .shape("slip_propagation", "torque", Range::kSlipTorqueNm)
        .shape("transport_delay", "delay", 0.06);
    auto law = joint.law<Q24>();
    double largest = 0.0;
    for (int i = -530; i <= 530; ++i) {  // the full angle at nearly the full rate
      const double q1 = sign * std::clamp(0.06 * i, -Range::kMotorAngleRad, Range::kMotorAngleRad);
      const double tau = i < 0 ? 0.0 : -sign * Range::kTorqueNm;
      const auto estimate = law.update(number<Q24>(q1), number<Q24>(tau));
      ASSERT_FALSE(estimate.saturated) << "sample " << i;
      largest = std::fmax(largest, std::fabs(estimate.q2.to_double()));
    }
    EXPECT_GT(largest, Range::kJointAngleRad - 1.0) << "the motion must reach the corner, or this test shows nothing";
  }
}

}  // namespace
}  // namespace capstan
