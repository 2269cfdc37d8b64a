// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/sample.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::kLsb;
using test::number;
using test::one_khz;
using test::value_of;

constexpr double kThreshold = 0.001;
constexpr double kTimeConstant = 0.005;

template <typename Scalar>
class Conditioner : public testing::Test {
 protected:
  static auto make(double threshold = kThreshold, double time_constant = kTimeConstant) -> SampleConditioner<Scalar> {
    return SampleConditioner<Scalar>(one_khz<Scalar>(), {number<Scalar>(threshold), number<Scalar>(time_constant)});
  }
  auto feed(double q1, double tau = 0.0) -> Sample<Scalar> {
    return conditioner_.update(number<Scalar>(q1), number<Scalar>(tau));
  }

  SampleConditioner<Scalar> conditioner_ = make();
};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Conditioner, Formats);

TYPED_TEST(Conditioner, NoiseUnderTheThresholdNeverSwitchesTheDirection) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> noise(-0.49 * kThreshold, 0.49 * kThreshold);
  for (const bool forward : {true, false}) {
    const double sign = forward ? 1.0 : -1.0;
    for (int i = 0; i <= 1000; ++i) {
      this->feed(sign * i * 1e-3);
    }
    for (int i = 0; i < 20000; ++i) {
      ASSERT_EQ(this->feed(sign + noise(engine)).forward, forward) << "sample " << i;
    }
  }
}

TYPED_TEST(Conditioner, SwitchesAtTheFirstSampleBeyondTheThresholdAndNotBefore) {
  this->feed(0.0);
  this->feed(1.0);
  EXPECT_TRUE(this->feed(1.0 - 0.99 * kThreshold).forward);
  EXPECT_FALSE(this->feed(1.0 - 1.01 * kThreshold).forward);
  EXPECT_FALSE(this->feed(1.0 - 1.01 * kThreshold + 0.99 * kThreshold).forward);
  EXPECT_TRUE(this->feed(1.0).forward);
}

TYPED_TEST(Conditioner, KeepsTheDirectionAtRestForAMinute) {
  for (const bool forward : {true, false}) {
    this->feed(forward ? -0.5 : 0.5);
    this->feed(0.0);
    for (int i = 0; i < 60000; ++i) {
      ASSERT_EQ(this->feed(0.0).forward, forward) << "sample " << i;
    }
  }
}

TYPED_TEST(Conditioner, FindsTheDirectionOfSlowCreepTooSlowForAnyRateThreshold) {
  this->feed(0.0);
  for (int i = 0; i < 20000; ++i) {  // 0.0002 rad/s, a hundredth of an encoder count per 38 samples
    this->feed(-2e-7 * i);
  }
  EXPECT_FALSE(this->feed(-0.004).forward);
}

RC_GTEST_PROP(ConditionerDirection, IsTheDirectionOfEveryStretchLongerThanTheThreshold, ()) {
  SampleConditioner<Q24> conditioner(SamplePeriod<Q24>(1000), {});
  const Q24 threshold = ConditionerShape<Q24>{}.direction_threshold_rad;
  Q24 q1 = Q24::from_raw(*rc::gen::inRange(-1000000, 1000000));
  conditioner.update(q1, Q24{});
  const auto stretches = *rc::gen::container<std::vector<std::int32_t>>(rc::gen::inRange(1, 200000));
  bool forward = *rc::gen::arbitrary<bool>();
  for (const std::int32_t beyond : stretches) {
    const Q24 step = threshold + Q24::from_raw(beyond);
    q1 = forward ? q1 + step : q1 - step;
    RC_ASSERT(conditioner.update(q1, Q24{}).forward == forward);
    forward = !forward;
  }
}

TYPED_TEST(Conditioner, FirstSampleHasNoRateWhereverItIs) {
  const auto sample = this->feed(25.0, 0.25);
  EXPECT_EQ(value_of(sample.dq1), 0.0);
  EXPECT_EQ(value_of(sample.q1), 25.0);
  EXPECT_EQ(value_of(sample.tau), 0.25);
  EXPECT_FALSE(sample.saturated);
}

// x += g (u - x) from rest with constant u: x_k = u (1 - (1 - g)^k), g = dt / (T + dt).
TYPED_TEST(Conditioner, RateFilterFollowsTheGeometricStepResponse) {
  constexpr double kSlope = 8.0;
  const double g = 0.001 / (kTimeConstant + 0.001);
  // q1 is known to half a unit, so its difference quotient to 1000 units; the filter passes at most a sixth of that at
  // once.
  const double bound = std::is_same_v<TypeParam, double> ? 1e-10 : 1000.0 * kLsb;
  this->feed(0.0);
  for (int k = 1; k < 400; ++k) {
    const double expected = kSlope * (1.0 - std::pow(1.0 - g, k));
    ASSERT_NEAR(value_of(this->feed(kSlope * 0.001 * k).dq1), expected, bound) << "sample " << k;
  }
}

// The first-order lag 1/(T s + 1) on the rate of A sin(w t): A w / sqrt(1 + (w T)^2) cos(w t - atan(w T)). The discrete
// filter tends to it with the sample period; the double conditioner can be run at 100 kHz to see that.
TEST(ConditionerRate, TendsToTheAnalogFirstOrderLagOfTheRate) {
  constexpr double kOmega = 40.0;
  double previous_error = 0.0;
  for (const double dt : {1e-4, 1e-5}) {
    SampleConditioner<double> conditioner(SamplePeriod<double>(dt), {kThreshold, kTimeConstant});
    double worst = 0.0;
    for (int i = 0; i * dt < 0.5; ++i) {
      const double t = i * dt;
      const double rate = conditioner.update(std::sin(kOmega * t), 0.0).dq1;
      const double lag = kOmega / std::sqrt(1.0 + kOmega * kOmega * kTimeConstant * kTimeConstant) *
                         std::cos(kOmega * t - std::atan(kOmega * kTimeConstant));
      worst = t > 0.1 ? std::fmax(worst, std::fabs(rate - lag)) : worst;  // twenty time constants after the start
    }
    EXPECT_LT(worst, 2.0 * dt * kOmega * kOmega);  // half a sample late in the difference, as much in the filter
    if (previous_error > 0.0) {
      EXPECT_NEAR(previous_error / worst, 10.0, 1.0);
    }
    previous_error = worst;
  }
}

// Both go through the same two filters, so torque that a mass takes and the mass's acceleration stay each other's.
TYPED_TEST(Conditioner, LateTorqueOfAMassIsThatOfItsFilteredAcceleration) {
  constexpr double kMass = 0.05;  // g m2, so that krad/s2 give N m
  SampleConditioner<TypeParam> conditioner = this->make(kThreshold, 0.003);
  const auto angle = [](int i) { return i <= 0 ? 0.0 : 0.02 * std::sin(0.11 * i) * std::min(1.0, 0.02 * i); };
  double most = 0.0;
  for (int i = 0; i < 400; ++i) {
    const double acceleration = 1e3 * (angle(i) - 2.0 * angle(i - 1) + angle(i - 2));  // krad/s2
    const auto& s = conditioner.update(number<TypeParam>(angle(i)), number<TypeParam>(kMass * acceleration));
    conditioner.delay_torque();
    EXPECT_NEAR(value_of(s.tau_late), kMass * value_of(s.ddq1), 2e-5) << i;  // a step of q1 is 0.06 rad/s2
    most = std::max(most, std::fabs(value_of(s.tau_late)));
  }
  EXPECT_GT(most, 2e-3);
}

TYPED_TEST(Conditioner, LateTorqueBeginsWhereTheTorqueIsAndSettlesThere) {
  SampleConditioner<TypeParam> conditioner = this->make();
  conditioner.update(TypeParam{}, number<TypeParam>(0.25));
  conditioner.delay_torque();
  EXPECT_EQ(conditioner.sample().tau_late, number<TypeParam>(0.25));
  for (int i = 0; i < 1000; ++i) {
    conditioner.update(TypeParam{}, number<TypeParam>(-0.5));
    conditioner.delay_torque();
  }
  EXPECT_NEAR(value_of(conditioner.sample().tau_late), -0.5, 1e-6);
}

TYPED_TEST(Conditioner, LateDirectionTurnsOverAsATorqueThatTurnsOverWithIt) {
  SampleConditioner<TypeParam> conditioner = this->make(kThreshold, 0.003);
  bool between = false;
  for (int i = 0; i < 300; ++i) {
    const bool forward = i <= 150;
    const double angle = 0.01 * (forward ? i : 300 - i);  // steps beyond the threshold: it turns with the motor
    const auto& s = conditioner.update(number<TypeParam>(angle), number<TypeParam>(forward ? 0.5 : -0.5));
    conditioner.delay_torque();
    EXPECT_NEAR(value_of(s.course_late), 2.0 * value_of(s.tau_late), 1e-5) << i;
    between = between || std::fabs(value_of(s.course_late)) < 0.9;
  }
  EXPECT_TRUE(between);
  EXPECT_NEAR(value_of(conditioner.sample().course_late), -1.0, 1e-4);
  const auto gain = conditioner.sample().late_gain;
  conditioner.restart();
  EXPECT_EQ(conditioner.sample().late_gain, gain) << "a new start is as late";
}

// Counted from the extreme, so they add up to the way.
TYPED_TEST(Conditioner, AdvancesAddUpToTheWaySinceTheTurnAndAreAsLateAsTheTorque) {
  SampleConditioner<TypeParam> conditioner = this->make(kThreshold, 0.003);
  double way = 0.0;
  double way_late = 0.0;
  for (int i = 0; i <= 700; ++i) {
    const double there = 0.002 * std::min(i, 300);
    const double back = 0.002 * std::max(0, std::min(i, 450) - 300);
    const auto& s = conditioner.update(number<TypeParam>(there - back), TypeParam{});
    conditioner.delay_torque();
    way += value_of(s.advance);
    way_late += value_of(s.advance_late);
    if (i == 300) {
      EXPECT_NEAR(way, 0.6, 1e-5);
      EXPECT_NEAR(way_late, 0.6 - 0.002 * 15.0, 1e-3) << "both filters, 15 ms";
    }
  }
  EXPECT_NEAR(way, 0.3, 1e-5);
  EXPECT_NEAR(way_late, 0.3, 3e-4);  // a filter in fixed point stops short of its end
  EXPECT_EQ(conditioner.sample().direction_threshold, number<TypeParam>(kThreshold));
}

TEST(ConditionerSaturation, IsFlaggedForAngleTorqueAndRateAndGoesWithItsCause) {
  SampleConditioner<Q24> conditioner(SamplePeriod<Q24>(1000), {});
  const Q24 zero;
  EXPECT_FALSE(conditioner.update(zero, zero).saturated);
  EXPECT_TRUE(conditioner.update(zero, Q24::max()).saturated);
  EXPECT_TRUE(conditioner.update(zero, Q24::lowest()).saturated);
  EXPECT_FALSE(conditioner.update(zero, zero).saturated);
  EXPECT_TRUE(conditioner.update(Q24::from_double(0.2), zero).saturated) << "200 rad/s is beyond the range";
  EXPECT_FALSE(conditioner.update(Q24::from_double(0.2), zero).saturated);
  EXPECT_TRUE(conditioner.update(Q24::max(), zero).saturated);
}

TEST(ConditionerSaturation, OfTheRateIsFlaggedInFullMotionToo) {
  SampleConditioner<Q24> conditioner(SamplePeriod<Q24>(1000), {});
  double q1 = 0.0;
  for (int i = 0; i < 200; ++i, q1 += 0.05) {  // 50 rad/s, so that the step of the filter itself stays small
    ASSERT_FALSE(conditioner.update(number<Q24>(q1), Q24{}).saturated);
  }
  EXPECT_TRUE(conditioner.update(number<Q24>(q1 + 0.2), Q24{}).saturated);
}

TEST(ConditionerSaturation, OfTheFilterStepIsFlaggedBetweenTwoRatesInRange) {
  SampleConditioner<Q24> conditioner(SamplePeriod<Q24>(1000), {});
  double q1 = 0.0;
  for (int i = 0; i < 200; ++i, q1 += 0.1) {
    ASSERT_FALSE(conditioner.update(number<Q24>(q1), Q24{}).saturated);
  }
  EXPECT_TRUE(conditioner.update(number<Q24>(q1 - 0.2), Q24{}).saturated) << "from 100 to -100 rad/s";
}

}  // namespace
}  // namespace capstan
