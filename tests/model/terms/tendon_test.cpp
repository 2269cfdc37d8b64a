// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/tendon.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

static_assert(SumTerm<Tendons<double>, double> && SumTerm<Tendons<Q24>, Q24>);

struct Joint {
  double eta_top = 1.1, eta_bottom = 0.9, pretension = 0.072, top_share = 0.55, friction = 0.0, viscous = 0.0,
         inertia = 0.0, free_share = 0.0;
};

template <typename Scalar>
auto make(const Joint& j) -> Tendons<Scalar> {
  return Tendons<Scalar>(one_khz<Scalar>(),
                         {number<Scalar>(j.eta_top), number<Scalar>(j.eta_bottom), number<Scalar>(j.pretension),
                          number<Scalar>(j.top_share), number<Scalar>(j.friction), number<Scalar>(j.viscous),
                          number<Scalar>(j.inertia), number<Scalar>(j.free_share)});
}
template <typename Scalar>
auto stretch(Tendons<Scalar>& term, double tau) -> double {
  return value_of(term.update({.tau_late = number<Scalar>(tau)})[0]);
}

/// One tendon as many short pieces, each of which holds its tension while its neighbour's on the input side stays
/// within a factor of it: the friction of the definition, place by place, and nothing of the term's own ways.
struct Pieces {
  Pieces(double eta, double start) : ratio(std::exp(-eta / kCount)), tension(kCount + 1, start) {}
  static constexpr int kCount = 200;
  double ratio;
  std::vector<double> tension;
  [[nodiscard]] auto pulled(double input) const -> Pieces {
    Pieces next = *this;
    next.tension[0] = input;
    for (std::size_t i = 1; i < tension.size(); ++i) {
      next.tension[i] = std::clamp(next.tension[i], next.tension[i - 1] * ratio, next.tension[i - 1] / ratio);
    }
    return next;
  }
  /// @param free  share of the length at the two ends that touches nothing
  [[nodiscard]] auto integral(double free) const -> double {
    const double ends = 0.5 * (tension.front() + tension.back());
    double sum = ends;
    for (std::size_t i = 1; i + 1 < tension.size(); ++i) {
      sum += tension[i];
    }
    return (1.0 - free) * sum / kCount + free * ends;
  }
};

/// Both tendons between their pulleys, by bisection.
struct SlowPair {
  explicit SlowPair(const Joint& j)
      : joint(j),
        top(j.eta_top, j.pretension * (1.0 - j.top_share)),
        bottom(j.eta_bottom, j.pretension * j.top_share),
        rest(j.top_share * top.integral(j.free_share)) {}
  Joint joint;
  Pieces top, bottom;
  double rest;
  auto pull(double x) -> double {
    double low = std::max(x, 0.0);
    double high = low + 10.0 * joint.pretension;
    const auto excess = [&](double input) {
      return joint.top_share * top.pulled(input).integral(joint.free_share) +
             (1.0 - joint.top_share) * bottom.pulled(input - x).integral(joint.free_share) - 2.0 * rest;
    };
    const bool slack = excess(low) >= 0.0;
    for (int i = 0; i < 50 && !slack; ++i) {
      const double middle = 0.5 * (low + high);
      (excess(middle) < 0.0 ? low : high) = middle;
    }
    top = top.pulled(low);
    bottom = bottom.pulled(low - x);
    return slack && x < 0.0 ? rest - (1.0 - joint.top_share) * bottom.integral(joint.free_share)
                            : joint.top_share * top.integral(joint.free_share) - rest;
  }
};

TEST(Tendon, FollowsManyShortPiecesThroughLoopsWithinLoops) {
  for (const Joint& joint :
       {Joint{}, Joint{.eta_top = 0.3, .eta_bottom = 0.4, .pretension = 0.3, .top_share = 0.5},
        Joint{.eta_top = 2.0, .eta_bottom = 1.5, .pretension = 0.02, .top_share = 0.35}, Joint{.free_share = 0.3}}) {
    const double size = 1.2 * joint.pretension * joint.eta_top;
    Tendons<double> term = make<double>(joint);
    SlowPair slow(joint);
    double range = 0.0;
    double worst = 0.0;
    for (int i = 0; i < 500; ++i) {
      const double t = 0.024 * i;
      const double tau = size * (std::sin(t) + 0.5 * std::sin(3.7 * t)) / 1.5;
      const double wanted = slow.pull(tau);
      worst = std::max(worst, std::fabs(stretch(term, tau) - wanted));
      range = std::max(range, std::fabs(wanted));
    }
    EXPECT_LT(worst, 0.05 * range) << "eight places know a front to a part of a cell";
    EXPECT_GT(range, 0.04 * joint.pretension);
  }
}

// The tip free and all of it sliding: T = T_o e^(eta (1 - phi)) above and e^-(...) below, so tau = I r1 eta, and the
// top tendon is longer by I/2 tanh(eta/2) than at rest.
TEST(Tendon, SettlesToTheLoopOfAFreeTip) {
  for (const double eta : {0.2, 0.7, 1.14, 2.5}) {
    const Joint joint{.eta_top = eta, .eta_bottom = eta, .pretension = 0.1, .top_share = 0.5};
    Tendons<double> term = make<double>(joint);
    const double tau = joint.pretension * eta;
    const double wanted = 0.5 * 0.5 * joint.pretension * std::tanh(0.5 * eta);
    EXPECT_NEAR(term.steady_state({.tau = tau, .forward = true})[0], wanted, 1e-12);
    EXPECT_NEAR(term.steady_state({.tau = -tau, .forward = false})[0], -wanted, 1e-12);
  }
}

TEST(Tendon, SettlesOnceBothTendonsSlideInTheirWholeLength) {
  for (const double eta : {0.2, 1.14, 2.5}) {
    const Joint joint{.eta_top = eta, .eta_bottom = 0.8 * eta, .pretension = 0.1, .top_share = 0.6};
    Tendons<double> term = make<double>(joint);
    const double most = 1.6 * joint.pretension * eta;
    double last = 0.0;
    for (int i = 0; i <= 600; ++i) {
      last = stretch(term, i < 200 ? -most * i / 200.0 : most * (i - 400) / 200.0);
    }
    EXPECT_TRUE(term.tendons().is_known());
    EXPECT_NEAR(last, term.steady_state({.tau = most, .forward = true})[0], 1e-4 * joint.pretension) << eta;
  }
}

TEST(Tendon, HangsOnTheOneTendonThatIsLeftWhenTheOtherIsSlack) {
  const Joint joint{.eta_top = 0.8, .eta_bottom = 0.6, .pretension = 0.05, .top_share = 0.4};
  Tendons<double> term = make<double>(joint);
  const double mean = (1.0 - std::exp(-0.8)) / 0.8;
  const double rest = 0.4 * 0.6 * 0.05;
  EXPECT_NEAR(stretch(term, 0.5), 0.4 * 0.5 * mean - rest, 1e-9);
  EXPECT_NEAR(term.steady_state({.tau = 0.5, .forward = true})[0], 0.4 * 0.5 * mean - rest, 1e-9);
  EXPECT_EQ(term.tendons().phase(), ForcePhase::kOneSlack);
  const double bottom_mean = (1.0 - std::exp(-0.6)) / 0.6;
  EXPECT_NEAR(stretch(term, -0.5), rest - 0.6 * 0.5 * bottom_mean, 1e-9);
  EXPECT_NEAR(term.steady_state({.tau = -0.5, .forward = false})[0], rest - 0.6 * 0.5 * bottom_mean, 1e-9);
}

TEST(Tendon, TakesFrictionAndInertiaAheadOfTheTendonsFromTheTorque) {
  const Joint bare;
  const Joint with{.friction = 0.01, .viscous = 0.002, .inertia = 0.02};
  Tendons<double> term = make<double>(with);
  Tendons<double> other = make<double>(bare);
  const Sample<double> sample{
      .dq1 = 3.0, .forward = true, .advance = 0.001, .ddq1 = 0.1, .tau_late = 0.09, .course_late = 1.0};
  EXPECT_DOUBLE_EQ(term.update(sample)[0], stretch(other, 0.09 - 0.01 - 0.006 - 0.002));
  const Sample<double> back{
      .dq1 = -3.0, .forward = false, .advance = -0.001, .ddq1 = 0.1, .tau_late = -0.09, .course_late = -1.0};
  EXPECT_DOUBLE_EQ(term.update(back)[0], stretch(other, -0.09 + 0.01 + 0.006 - 0.002));
}

// At a reversal the torque falls by twice the friction before the motor moves, and the tendons feel nothing of it.
TEST(Tendon, FrictionHoldsTheTensionWhileTheMotorStands) {
  Tendons<double> term = make<double>(Joint{.friction = 0.01});
  const double moving = term.update({.forward = true, .advance = 0.001, .tau_late = 0.06, .course_late = 1.0})[0];
  EXPECT_GT(moving, 0.0);
  for (const double tau : {0.055, 0.05, 0.0401}) {
    EXPECT_DOUBLE_EQ(term.update({.forward = true, .tau_late = tau})[0], moving) << tau;
  }
  EXPECT_LT(term.update({.forward = true, .tau_late = 0.03})[0], moving);
}

// After a quick turn the motor rings against its servo, here at 60 Hz: its own mass takes the torque's peaks, and
// friction would keep what they did to the tension. With the torque of now and a late acceleration it does.
TEST(Tendon, PeaksThatTheMotorsMassTakesLeaveNothingBehind) {
  constexpr double kInertia = 3e-5;  // kg m2
  constexpr double kSteady = 0.06;   // Nm
  const auto angle = [](double t) { return t <= 0.0 ? 0.0 : 1.5e-3 * std::exp(-t / 0.05) * std::sin(377.0 * t); };
  Tendons<double> term = make<double>(Joint{.inertia = 1e3 * kInertia});
  Tendons<double> of_now = term;
  Tendons<double> calm = make<double>(Joint{});
  SampleConditioner<double> conditioner(one_khz<double>(), {.rate_time_constant_s = 0.0005});
  double left = 0.0;
  double left_of_now = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double t = 1e-3 * i;
    const double acceleration = 1e6 * (angle(t) - 2.0 * angle(t - 1e-3) + angle(t - 2e-3));  // rad/s2
    const double steady = std::min(1.0, t / 0.01) * kSteady;
    conditioner.update(angle(t), steady + kInertia * acceleration);
    conditioner.delay_torque();
    Sample<double> s = conditioner.sample();
    const double wanted = stretch(calm, steady);
    left = std::fabs(term.update(s)[0] - wanted);
    s.tau_late = s.tau;
    left_of_now = std::fabs(of_now.update(s)[0] - wanted);
  }
  EXPECT_GT(left_of_now, 0.02 * stretch(calm, kSteady));
  EXPECT_LT(left, 0.1 * left_of_now);
}

/// A motor that turns back at once, 1 rad/s either way, and rubs: what reaches its tendons stays as it is.
template <typename Change>
auto most_beside_after_a_turn(Change&& change) -> double {
  constexpr double kFriction = 0.01;
  constexpr double kSteady = 0.05;
  constexpr int kTurn = 500;
  Tendons<double> term = make<double>(Joint{.friction = kFriction});
  SampleConditioner<double> conditioner(one_khz<double>(),
                                        {.direction_threshold_rad = 1e-4, .rate_time_constant_s = 0.001});
  double wanted = 0.0;
  double most = 0.0;
  for (int i = 0; i < 2 * kTurn; ++i) {
    const bool forward = i <= kTurn;
    conditioner.update(1e-3 * (forward ? i : 2 * kTurn - i), kSteady + (forward ? kFriction : -kFriction));
    conditioner.delay_torque();
    Sample<double> s = conditioner.sample();
    s.advance_late = 0.0;  // what the torque alone makes of them
    change(s);
    const double now = term.update(s)[0];
    wanted = i == kTurn ? now : wanted;
    most = std::max(most, i > kTurn ? std::fabs(now - wanted) : 0.0);
  }
  return most / wanted;
}

TEST(Tendon, FrictionOfTheMotorTurnsOverAsLateAsTheTorqueIsSeen) {
  EXPECT_LT(most_beside_after_a_turn([](auto&) {}), 1e-3);
  EXPECT_GT(most_beside_after_a_turn([](auto& s) { s.course_late = s.forward ? 1.0 : -1.0; }), 0.05);
}

/// A motor at 0.5 rad/s whose torque rises within `rise_ms`, stays for half a second and falls by a tenth within
/// another one; what the stretch is over what it is while both tendons slide under that torque.
template <typename Scalar>
auto over_sliding_after_the_torque_fell(double rise_ms, double rad_per_ms) -> double {
  const Joint joint{.eta_top = 1.1, .eta_bottom = 1.1, .pretension = 0.1, .top_share = 0.5, .free_share = 0.1};
  constexpr double kSliding = 0.11;  // eta I r1
  Tendons<Scalar> term = make<Scalar>(joint);
  SampleConditioner<Scalar> conditioner(one_khz<Scalar>(), {.rate_time_constant_s = number<Scalar>(0.001)});
  double now = 0.0;
  for (int i = 0; i < 2100; ++i) {
    const double torque =
        kSliding * (i < 1000 ? std::min(1.0, i / rise_ms) : 1.0 - 0.1 * std::min(1.0, (i - 1000) / 400.0));
    conditioner.update(number<Scalar>(rad_per_ms * std::min(i, 2000)), number<Scalar>(torque));
    conditioner.delay_torque();
    now = value_of(term.update(conditioner.sample())[0]);
  }
  return now / make<double>(joint).steady_state({.tau = 0.9 * kSliding, .forward = true})[0];
}

template <typename Scalar>
class TendonSlide : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(TendonSlide, Formats);

// Friction of a tendon that moves acts against its motion, whatever its tension did before: T = T_in e^(-eta phi).
TYPED_TEST(TendonSlide, GoesOnWithAMotorThatGoesOnWithoutMoreTorque) {
  EXPECT_NEAR(over_sliding_after_the_torque_fell<TypeParam>(100.0, 0.0005), 1.0, 0.003);
  EXPECT_GT(over_sliding_after_the_torque_fell<TypeParam>(100.0, 0.0), 1.05) << "a motor that stands holds them";
}

// What is left of the filters behind the way must not move the tendons of a motor that has come to rest.
TYPED_TEST(TendonSlide, EndsWithTheMotorsMotion) {
  Tendons<TypeParam> term = make<TypeParam>({.eta_top = 1.1, .eta_bottom = 1.1, .pretension = 0.1, .top_share = 0.5});
  SampleConditioner<TypeParam> conditioner(one_khz<TypeParam>(), {.direction_threshold_rad = number<TypeParam>(0.0001),
                                                                  .rate_time_constant_s = number<TypeParam>(0.002)});
  double soon_after = 0.0;
  double now = 0.0;
  for (int i = 0; i < 61000; ++i) {
    const double torque = i < 500 ? 0.0002 * i : 0.1 - 0.01 * std::min(1.0, (i - 500) / 500.0);
    conditioner.update(number<TypeParam>(0.0005 * std::min(i, 505)), number<TypeParam>(torque));
    conditioner.delay_torque();
    now = value_of(term.update(conditioner.sample())[0]);
    soon_after = i == 1100 ? now : soon_after;
  }
  EXPECT_NEAR(now, soon_after, 1e-6) << "a minute later";
}

// A torque that rises all the way stretches tendons of a joint that stands; and a motor that turned back a little and
// goes on again has to come to the torque of before first.
TEST(Tendon, SlidesNotWhileTheTorqueRises) {
  Tendons<double> moving = make<double>(Joint{});
  Tendons<double> standing = make<double>(Joint{});
  Sample<double> s{.course_late = 1.0, .direction_threshold = 0.001};
  for (int i = 0; i < 600; ++i) {
    s.tau_late = i < 200 ? 0.0002 * i : i < 250 ? 0.04 - 0.0002 * (i - 200) : 0.03 + 0.0002 * (i - 250);
    s.advance = s.advance_late = i < 200 || i >= 250 ? 0.001 : -0.001;
    s.forward = s.advance > 0.0;
    s.course_late = s.forward ? 1.0 : -1.0;
    ASSERT_DOUBLE_EQ(moving.update(s)[0], stretch(standing, s.tau_late)) << i;
  }
}

// A load that drives the motor's pulley through tendons of much friction: their far end would have e^3 times 6.5 Nm,
// which is beyond fixed point. No tension is cut in silence.
TEST(Tendon, SaysThatSlidingTakesATensionBeyondTheRange) {
  Tendons<Q24> term = make<Q24>({.eta_top = 3.0, .eta_bottom = 3.0, .pretension = 0.1, .top_share = 0.5});
  const auto goes_on = [&term](double torque, int cycles) {
    Sample<Q24> s{.course_late = Sample<Q24>::kWhole};
    s.tau_late = number<Q24>(torque);
    s.advance = s.advance_late = s.direction_threshold = number<Q24>(0.001);
    bool in_range = true;
    for (int i = 0; i < cycles; ++i) {
      in_range = !ScalarTraits<Q24>::is_saturated(term.update(s)[0]) && in_range;
    }
    return in_range;
  };
  EXPECT_TRUE(goes_on(-6.0, 50)) << "e^3 times 6 Nm are 120.5";
  EXPECT_FALSE(goes_on(-6.5, 50)) << "and times 6.5 Nm 130.6";
  EXPECT_TRUE(goes_on(-6.0, 50)) << "it is over with the torque that was too large";
}

// Without friction the stretch is a share of the torque, and of a torque that grows evenly nothing is left late.
template <typename Scalar>
class TendonLateness : public testing::Test {};
TYPED_TEST_SUITE(TendonLateness, Formats);

TYPED_TEST(TendonLateness, IsMadeUpForBehindTheTendons) {
  const Joint joint{.eta_top = 0.0, .eta_bottom = 0.0};
  Tendons<TypeParam> term = make<TypeParam>(joint);
  Tendons<TypeParam> of_now = make<TypeParam>(joint);
  SampleConditioner<TypeParam> conditioner(one_khz<TypeParam>(), {.rate_time_constant_s = number<TypeParam>(0.001)});
  constexpr double kPerMs = 0.0003;  // Nm
  double late = 0.0;
  double left = 0.0;
  for (int i = 0; i < 200; ++i) {
    conditioner.update(TypeParam{}, number<TypeParam>(kPerMs * i));
    conditioner.delay_torque();
    Sample<TypeParam> s = conditioner.sample();
    const double ahead = value_of(term.update(s)[0]);
    const double behind = stretch(of_now, value_of(s.tau_late));
    const double wanted = stretch(of_now, kPerMs * i);
    late = wanted - behind;
    left = wanted - ahead;
  }
  EXPECT_GT(late, 4.0 * kPerMs * joint.top_share * (1.0 - joint.top_share)) << "five milliseconds";
  EXPECT_LT(std::fabs(left), 0.05 * late);
}

RC_GTEST_PROP(TendonProperties, FixedPointFollowsDoubleAndStartsAnewAsNewlyMade, ()) {
  const auto share = [](int low, int high) { return 1e-3 * *rc::gen::inRange(low, high); };
  const Joint joint{.eta_top = share(0, 3000),
                    .eta_bottom = share(0, 3000),
                    .pretension = share(5, 4000),
                    .top_share = share(150, 850),
                    .free_share = share(0, 500)};
  Tendons<double> exact = make<double>(joint);
  Tendons<Q24> fixed = make<Q24>(joint);
  const double size = 1.5 * joint.pretension;
  const auto steps = *rc::gen::container<std::vector<int>>(rc::gen::inRange(-1000, 1001));
  std::vector<double> first;
  for (const int step : steps) {
    const double tau = 1e-3 * step * size;
    const double wanted = stretch(exact, tau);
    // What the search for the balance may leave in either, twice, and the last places of fourteen tensions.
    RC_ASSERT(std::fabs(stretch(fixed, tau) - wanted) <= 2e-3 * (joint.pretension + std::fabs(tau)) + 1e-5);
    first.push_back(wanted);
  }
  exact.restart();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    RC_ASSERT(stretch(exact, 1e-3 * steps[i] * size) == first[i]);
  }
}

TEST(Tendon, OutOfRangeTorqueIsNoEstimate) {
  MotionLaw<Q24> motion =
      test::LawBuilder().coefficient("motor_angle", "beta", 1.0).coefficient("tendon", "compliance", -3.0).law<Q24>();
  EXPECT_FALSE(motion.update(number<Q24>(0.1), number<Q24>(7.9)).saturated);
  for (int i = 0; i < 100; ++i) {  // until the tendons see it
    motion.update(number<Q24>(0.1), number<Q24>(8.1));
  }
  EXPECT_TRUE(motion.update(number<Q24>(0.1), number<Q24>(8.1)).saturated);
}

}  // namespace
}  // namespace capstan
