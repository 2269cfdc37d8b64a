// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/pull_push.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "capstan/tests/model/integrated_tension.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::integrate;
using test::number;
using test::value_of;

constexpr double kR1 = 0.0026;
constexpr double kR2 = 0.0024;
constexpr double kI = 27.6984;

template <typename Scalar>
auto thesis_parameters(double pull = 0.0, double pull_push = 1.0) -> PullPushParameters<Scalar> {
  return {number<Scalar>(1.1414),    number<Scalar>(1.1404), number<Scalar>(kI * kR1),
          number<Scalar>(kR2 / kR1), number<Scalar>(pull),   number<Scalar>(pull_push)};
}

struct Tensions {
  double pulled_in, pulled_out, pushed_in, pushed_out;
};

/// Both tendons at once from integrals (each in proportion to its tension): bisects the pushed tendon's input tension
/// until the two areas make I. A tendon that would have to push is slack.
class Solver {
 public:
  Solver(double eta_pulled, double eta_pushed, double integral)
      : pulled_(integrate(eta_pulled, 1.0, 1.0)), pushed_(integrate(eta_pushed, -1.0, 1.0)), integral_(integral) {}

  [[nodiscard]] auto solve(double torque_nm) const -> Tensions {
    const auto pulled_in = [&](double pushed_in) { return std::fmax(pushed_in + torque_nm / kR1, 0.0); };
    double low = std::fmax(0.0, -torque_nm / kR1);
    double high = low + integral_ * std::exp(3.0);
    if (pulled_.area * pulled_in(low) + pushed_.area * low >= integral_) {
      high = low;
    }
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (low + high);
      (pulled_.area * pulled_in(middle) + pushed_.area * middle < integral_ ? low : high) = middle;
    }
    return {pulled_in(low), pulled_in(low) * pulled_.end_tension, low, low * pushed_.end_tension};
  }

 private:
  test::Integrated pulled_, pushed_;
  double integral_;
};

TEST(TransmissionLine, IsTheTwoTendonsSolvedFromIntegrals) {
  for (const auto& [up, down] : {std::pair{1.1414, 1.1404}, std::pair{0.3, 1.7}, std::pair{2.5, 0.05}}) {
    for (const double integral : {0.0, 5.0, kI}) {
      const TransmissionLine<double> line(up, down, integral * kR1, kR2 / kR1);
      const Solver solver(up, down, integral);
      for (double torque = -0.21; torque < 0.22; torque += 0.02) {
        const Tensions t = solver.solve(torque);
        const double expected = (t.pulled_out - t.pushed_out) * kR2;
        EXPECT_NEAR(line.at(torque).torque, expected, 1e-9 * (std::fabs(expected) + 0.1)) << up << ", " << torque;
        const bool slack = t.pulled_in < 1e-9 || t.pushed_in < 1e-9;
        EXPECT_EQ(line.at(torque).one_slack, slack) << up << ", " << integral << ", " << torque;
      }
    }
  }
}

TEST(TransmissionLine, MeetsItselfWhereATendonGoesSlackAndNeverFalls) {
  const TransmissionLine<double> line(1.1414, 0.7, 0.072, 0.92);
  double before = -1e9;
  for (double x = -0.5; x < 0.5; x += 1e-4) {
    const double now = line.at(x).torque;
    EXPECT_GE(now, before);
    EXPECT_LT(now - std::fmax(before, now - 1.0), 1e-4 * 0.92 * std::exp(0.7) * 1.001 + (before < -1e8 ? 1.0 : 0.0));
    before = now;
  }
}

// Table 2.1: at the slack torque the pushed tendon is just slack, so phase IV begins there and the torque ratio is
// (2.22).
TEST(TransmissionLine, GoesSlackAtTheTorqueFromWhichThesisTookI) {
  const double integral = 28.1393;  // Table 2.2, from 0.1227 N m
  const TransmissionLine<double> line(1.1414, 1.1404, integral * kR1, kR2 / kR1);
  EXPECT_FALSE(line.at(0.1227 - 1e-4).one_slack);
  EXPECT_TRUE(line.at(0.1227 + 1e-4).one_slack);
  EXPECT_NEAR(-std::log(line.at(0.15).torque * kR1 / (0.15 * kR2)), 1.1414, 1e-12);
}

template <typename Scalar>
class PullPushLaw : public testing::Test {
 protected:
  /// Triangle of torque, one sample per 1e-4 N m.
  static auto triangle(double amplitude, int cycles) -> std::vector<std::pair<double, bool>> {
    std::vector<std::pair<double, bool>> samples;
    const int quarter = static_cast<int>(std::lround(amplitude / 1e-4));
    int at = 0;
    int step = 1;
    for (int i = 0; i < 4 * quarter * cycles; ++i) {
      at += step;
      samples.emplace_back(1e-4 * at, step > 0);
      step = at == quarter ? -1 : (at == -quarter ? 1 : step);
    }
    return samples;
  }
  static auto phases(const PullPushParameters<Scalar>& parameters, HoldRule rule) -> std::vector<ForcePhase> {
    PullPush<Scalar> law(parameters, rule);
    std::vector<ForcePhase> seen;
    for (const auto& [torque, forward] : triangle(0.16, 2)) {
      const ForcePhase phase = law.update(number<Scalar>(torque), forward).phase;
      if (seen.empty() || seen.back() != phase) {
        seen.push_back(phase);
      }
    }
    return seen;
  }
};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(PullPushLaw, Formats);

using enum ForcePhase;

TYPED_TEST(PullPushLaw, GoesThroughItsPhasesInOrder) {
  // Four reversals, and the record ends at no torque: held for the fourth time.
  const auto pull_push = this->phases(thesis_parameters<TypeParam>(), HoldRule::kUntilPassed);
  EXPECT_EQ(pull_push, (std::vector{kUnknown, kBothActive, kOneSlack, kHeld, kBothActive, kOneSlack, kHeld, kBothActive,
                                    kOneSlack, kHeld, kBothActive, kOneSlack, kHeld}));
  const auto pull = this->phases(thesis_parameters<TypeParam>(1.0, 0.0), HoldRule::kUntilPulling);
  EXPECT_EQ(pull, (std::vector{kOneSlack, kHeld, kOneSlack, kHeld, kOneSlack, kHeld, kOneSlack, kHeld}));
  const auto blend = this->phases(thesis_parameters<TypeParam>(0.5904, 0.4686), HoldRule::kUntilPulling);
  const std::vector first = {kUnknown, kBothActive, kOneSlack};
  const std::vector cycle = {kHeld, kPulledActive, kBothActive, kOneSlack};
  ASSERT_EQ(blend.size(), first.size() + 3 * cycle.size() + 1);
  for (std::size_t i = 0; i < blend.size(); ++i) {
    EXPECT_EQ(blend[i], i < first.size() ? first[i] : cycle[(i - first.size()) % 4]) << i;
  }
}

TYPED_TEST(PullPushLaw, HoldsTheOutputAfterAReversalUntilTheOtherLineHasComeToIt) {
  PullPush<TypeParam> law(thesis_parameters<TypeParam>());
  double peak = 0.0;
  double before = 0.0;
  double largest_step = 0.0;
  for (const auto& [torque, forward] : this->triangle(0.16, 2)) {
    const auto estimate = law.update(number<TypeParam>(torque), forward);
    const double now = value_of(estimate.force);
    peak = std::fmax(peak, now);
    if (estimate.phase == kHeld) {
      EXPECT_EQ(now, before);
    }
    largest_step = std::fmax(largest_step, std::fabs(now - before));
    before = now;
  }
  EXPECT_NEAR(peak, 0.16 * kR2 / kR1 * std::exp(-1.1414), 1e-6);
  EXPECT_LT(largest_step, 1.2e-4) << "no jump: the steepest piece rises by r2 / r1 times the torque";
}

/// (2.17)-(2.21) and (2.27) word by word, from the integrals above; the pull model of a tendon is the one without I.
struct Printed {
  Solver up{1.1414, 1.1404, kI}, down{1.1404, 1.1414, kI};
  double pull = 0.0, pull_push = 0.0;
  auto update(double torque, bool forward) -> double {
    const double s = forward ? 1.0 : -1.0;
    const double eta = forward ? 1.1414 : 1.1404;
    if (s * torque > 0.0) {
      pull = torque * kR2 / kR1 * std::exp(-eta);
    }
    const Tensions t = (forward ? up : down).solve(s * torque);
    if (s * torque > 0.0 && t.pulled_out > t.pushed_out) {
      pull_push = s * (t.pulled_out - t.pushed_out) * kR2;
    }
    return 0.5904 * pull + 0.4686 * pull_push;
  }
};

TYPED_TEST(PullPushLaw, AsPrintedIsEquations217To227) {
  Printed printed;
  PullPush<TypeParam> law(thesis_parameters<TypeParam>(0.5904, 0.4686), HoldRule::kUntilPulling);
  for (const auto& [torque, forward] : this->triangle(0.16, 2)) {
    const TypeParam tau = number<TypeParam>(torque);
    const double now = value_of(law.update(tau, forward).force);
    ASSERT_NEAR(now, printed.update(value_of(tau), forward), 2e-6) << torque << (forward ? " up" : " down");
  }
}

TYPED_TEST(PullPushLaw, IsKnownOnceTheOutputHasBeenTakenAlong) {
  PullPush<TypeParam> law(thesis_parameters<TypeParam>());
  EXPECT_FALSE(law.update(number<TypeParam>(0.01), true).known);
  EXPECT_TRUE(law.update(number<TypeParam>(0.15), true).known);
  EXPECT_TRUE(law.update(number<TypeParam>(0.14), false).known);
}

TYPED_TEST(PullPushLaw, RefusesParametersOutOfRangeByName) {
  using Parameters = PullPushParameters<TypeParam>;
  const auto fault_of = [](void (*spoil)(Parameters&)) {
    auto p = thesis_parameters<TypeParam>();
    spoil(p);
    EXPECT_EQ(PullPush<TypeParam>(p).update(number<TypeParam>(0.1), true).beyond_table,
              check(p) != PullPushFault::kNone);
    return check(p);
  };
  EXPECT_EQ(fault_of([](Parameters&) {}), PullPushFault::kNone);
  EXPECT_EQ(fault_of([](Parameters& p) { p.eta_top = number<TypeParam>(-0.01); }), PullPushFault::kEtaTop);
  EXPECT_EQ(fault_of([](Parameters& p) { p.eta_bottom = number<TypeParam>(3.01); }), PullPushFault::kEtaBottom);
  EXPECT_EQ(fault_of([](Parameters& p) { p.pretension_nm = number<TypeParam>(8.1); }), PullPushFault::kPretension);
  EXPECT_EQ(fault_of([](Parameters& p) { p.ratio = TypeParam{}; }), PullPushFault::kRatio);
  EXPECT_EQ(fault_of([](Parameters& p) { p.pull_push_weight = TypeParam{}; }), PullPushFault::kWeights);
  EXPECT_NE(std::string_view(describe(PullPushFault::kEtaTop)).find("eta_top"), std::string_view::npos);
  if constexpr (std::is_same_v<TypeParam, double>) {
    EXPECT_EQ(fault_of([](Parameters& p) { p.eta_top = std::numeric_limits<double>::quiet_NaN(); }),
              PullPushFault::kEtaTop);
  }
}

TEST(PullPushInFixedPoint, SaturatesInsteadOfWrappingAndSaysSo) {
  auto parameters = thesis_parameters<Q24>();
  parameters.eta_top = Q24{};
  parameters.ratio = number<Q24>(4.0);
  PullPush<Q24> law(parameters);
  const auto estimate = law.update(number<Q24>(100.0), true);
  EXPECT_TRUE(estimate.saturated);
  EXPECT_EQ(estimate.force, Q24::max());
  EXPECT_FALSE(law.update(number<Q24>(8.0), true).force < Q24{});
}

TEST(MeanDecayInFixedPoint, IsWithinFiveHundredMillionths) {
  double worst = 0.0;
  for (std::int32_t raw = 1; raw > 0 && raw < (4 << 24); raw += raw / 1000 + 1) {
    const Q24 x = Q24::from_raw(raw);
    worst = std::fmax(worst, std::fabs(mean_decay(x).to_double() - mean_decay(x.to_double())));
  }
  EXPECT_LT(worst, 5e-8);
  std::printf("mean decay: worst error %.2e\n", worst);
  EXPECT_EQ(mean_decay(Q24{}), Q30::from_int(1));
}

}  // namespace
}  // namespace capstan
