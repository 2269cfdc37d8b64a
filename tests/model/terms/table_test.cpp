// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/table.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

static_assert(SumTerm<Table<double>, double> && SumTerm<Table<Q24>, Q24>);

constexpr std::size_t kKnots = Table<double>::kKnots;

template <typename Scalar>
auto table_over(TableSignal signal, double knots, double low, double high, TableFactor factor = TableFactor::kOne)
    -> Table<Scalar> {
  return {one_khz<Scalar>(),
          {number<Scalar>(static_cast<double>(signal)), number<Scalar>(knots), number<Scalar>(low),
           number<Scalar>(high), number<Scalar>(static_cast<double>(factor))}};
}

/// A hat around each knot, by its definition: 1 there, 0 at the neighbours, straight between.
auto hat(double x, std::size_t knot, std::size_t knots, double low, double high) -> double {
  const double cell = (high - low) / static_cast<double>(knots - 1);
  const double held = std::fmax(low, std::fmin(high, x));
  return std::fmax(0.0, 1.0 - std::fabs(held - (low + cell * static_cast<double>(knot))) / cell);
}

RC_GTEST_PROP(Table, IsAHatAroundEveryKnotOfItsDirection, ()) {
  const auto knots = static_cast<std::size_t>(*rc::gen::inRange(2, static_cast<int>(kKnots) + 1));
  const double low = 0.01 * *rc::gen::inRange(-5000, 5000);
  const double high = low + 0.01 * *rc::gen::inRange(1, 6000);
  const double x = low + (high - low) * 0.001 * *rc::gen::inRange(-200, 1201);
  const bool forward = *rc::gen::arbitrary<bool>();
  auto exact = table_over<double>(TableSignal::kTorque, static_cast<double>(knots), low, high);
  auto fixed = table_over<Q24>(TableSignal::kTorque, static_cast<double>(knots), low, high);
  const auto phi = exact.update({.tau = x, .forward = forward});
  const auto raw = fixed.update({.tau = number<Q24>(x), .forward = forward});
  const double cell = (high - low) / static_cast<double>(knots - 1);
  for (std::size_t k = 0; k < 2 * kKnots; ++k) {
    const bool own = (k < kKnots) == forward;
    const double wanted = own && k % kKnots < knots ? hat(x, k % kKnots, knots, low, high) : 0.0;
    RC_ASSERT(std::fabs(phi[k] - wanted) < 1e-9);
    // Signal and ends are rounded, over a cell; then the share.
    RC_ASSERT(std::fabs(raw[k].to_double() - wanted) < (4.0 / cell + 40.0) * test::kLsb);
  }
}

/// The factor by its definition.
auto factor_of(TableFactor factor, const Sample<double>& s) -> double {
  return factor == TableFactor::kTorque       ? s.tau
         : factor == TableFactor::kRate       ? s.dq1
         : factor == TableFactor::kMotorAngle ? s.q1
                                              : 1.0;
}

RC_GTEST_PROP(Table, TimesAFactorIsTheHatTimesIt, ()) {
  const auto knots = static_cast<std::size_t>(*rc::gen::inRange(2, static_cast<int>(kKnots) + 1));
  const auto factor = static_cast<TableFactor>(*rc::gen::inRange(0, kTableFactors));
  const double low = 0.01 * *rc::gen::inRange(-500, 500);
  const double high = low + 0.01 * *rc::gen::inRange(10, 600);
  Sample<double> s{.q1 = 0.01 * *rc::gen::inRange(-12700, 12701),
                   .dq1 = 0.01 * *rc::gen::inRange(-12700, 12701),
                   .tau = 0.01 * *rc::gen::inRange(-12700, 12701),
                   .forward = *rc::gen::arbitrary<bool>()};
  s.others[0].q1 = low + (high - low) * 0.001 * *rc::gen::inRange(-200, 1201);
  Sample<Q24> raw{.q1 = number<Q24>(s.q1), .dq1 = number<Q24>(s.dq1), .tau = number<Q24>(s.tau), .forward = s.forward};
  raw.others[0].q1 = number<Q24>(s.others[0].q1);
  auto exact = table_over<double>(TableSignal::kOtherAngle, static_cast<double>(knots), low, high, factor);
  auto fixed = table_over<Q24>(TableSignal::kOtherAngle, static_cast<double>(knots), low, high, factor);
  const auto of_double = exact.update(s);
  const auto of_fixed = fixed.update(raw);
  const double times = factor_of(factor, s);
  const double cell = (high - low) / static_cast<double>(knots - 1);
  for (std::size_t k = 0; k < 2 * kKnots; ++k) {
    const bool own = (k < kKnots) == s.forward && k % kKnots < knots;
    const double wanted = own ? times * hat(s.others[0].q1, k % kKnots, knots, low, high) : 0.0;
    RC_ASSERT(std::fabs(of_double[k] - wanted) < 1e-7);
    // The hat's own error times the factor, and one rounding.
    RC_ASSERT(std::fabs(of_fixed[k].to_double() - wanted) <
              ((4.0 / cell + 40.0) * (1.0 + std::fabs(times))) * test::kLsb);
    RC_ASSERT(!of_fixed[k].is_saturated());
  }
  RC_ASSERT(of_fixed.rest + of_fixed.share == number<Q24>(times));
  RC_ASSERT(fixed.steady_state(raw) == of_fixed);
}

TEST(Table, HoldsItsEndsOutside) {
  auto table = table_over<Q24>(TableSignal::kTorque, 5, -1.0, 1.0);
  EXPECT_EQ(table.update({.tau = number<Q24>(-90.0)})[0], number<Q24>(1.0));
  EXPECT_EQ(table.update({.tau = number<Q24>(90.0)})[4], number<Q24>(1.0));
}

TEST(Table, ReadsTheSignalItIsToldTo) {
  Sample<double> s{.q1 = 5.0, .dq1 = 0.2, .tau = 0.1, .h = 0.3, .q1_reversal = 4.6, .warmth = 0.7};
  s.others = {{{.q1 = 0.5}, {.q1 = 0.6}, {.q1 = 0.8}}};
  const auto read = [&s](TableSignal signal) {
    auto table = table_over<double>(signal, 2, 0.0, 1.0);
    return table.update(s)[1];
  };
  EXPECT_NEAR(read(TableSignal::kMotorAngle), 0.3, 1e-12);
  EXPECT_NEAR(read(TableSignal::kTorque), 0.1, 1e-12);
  EXPECT_NEAR(read(TableSignal::kRate), 0.2, 1e-12);
  EXPECT_NEAR(read(TableSignal::kSinceReversal), 0.001, 1e-12);
  EXPECT_NEAR(read(TableSignal::kTravelledSince), 0.4, 1e-12);
  EXPECT_NEAR(read(TableSignal::kOtherAngle), 0.5, 1e-12);
  EXPECT_NEAR(read(TableSignal::kSecondOtherAngle), 0.6, 1e-12);
  EXPECT_NEAR(read(TableSignal::kThirdOtherAngle), 0.8, 1e-12);
  EXPECT_NEAR(read(TableSignal::kWarmth), 0.7, 1e-12);
  std::set<std::string> words;
  for (int i = 0; i < kTableSignals; ++i) {
    words.insert(describe(static_cast<TableSignal>(i)));
  }
  EXPECT_EQ(words.size(), static_cast<std::size_t>(kTableSignals));
}

TEST(Table, CountsTheTimeSinceTheDirectionTurned) {
  auto table = table_over<Q24>(TableSignal::kSinceReversal, 2, 0.0, 10.0);
  auto exact = table_over<double>(TableSignal::kSinceReversal, 2, 0.0, 10.0);
  for (int i = 1; i <= 3000; ++i) {
    EXPECT_NEAR(table.update({.forward = true})[1].to_double(), 1e-4 * i, 1e-6);
    exact.update({.forward = true});
  }
  EXPECT_EQ(table.update({.forward = false})[kKnots + 1], Q24{}) << "and starts again at a reversal";
  EXPECT_EQ(exact.update({.forward = false})[kKnots + 1], 0.0);
}

TEST(Table, IsNoneWithoutKnotsOrWithEndsOutOfOrder) {
  for (auto table :
       {table_over<Q24>(TableSignal::kTorque, 0, -1.0, 1.0), table_over<Q24>(TableSignal::kTorque, 1, -1.0, 1.0),
        table_over<Q24>(TableSignal::kTorque, 9, 1.0, 1.0), table_over<Q24>(TableSignal::kTorque, 9, 1.0, -1.0)}) {
    const auto phi = table.update({.tau = number<Q24>(0.3)});
    for (std::size_t k = 0; k < 2 * kKnots; ++k) {
      EXPECT_EQ(phi[k], Q24{});
    }
  }
}

TEST(Table, SaysItsFactorsInDifferentWords) {
  std::set<std::string> words;
  for (int i = 0; i < kTableFactors; ++i) {
    words.insert(describe(static_cast<TableFactor>(i)));
  }
  EXPECT_EQ(words.size(), static_cast<std::size_t>(kTableFactors));
}

// Friction by rate times torque: what the law adds, and what its inverse takes away again.
template <typename Scalar>
void goes_there_and_back(bool forward) {
  test::LawBuilder builder;
  builder.conditioner(0.0005, 0.002)
      .coefficient("motor_angle", "beta", 0.9)
      .shape("table", "signal", static_cast<double>(TableSignal::kRate))
      .shape("table", "knots", 3)
      .shape("table", "low", -2.0)
      .shape("table", "high", 2.0)
      .shape("table", "factor", static_cast<double>(TableFactor::kTorque))
      .coefficient("table", "forward_1", 0.2)
      .coefficient("table", "forward_2", 0.5)
      .coefficient("table", "backward_0", -0.4)
      .coefficient("table", "backward_1", 0.1);
  auto law = builder.law<Scalar>();
  const double sign = forward ? 1.0 : -1.0;
  Estimate<Scalar> estimate;
  for (int i = 0; i <= 1000; ++i) {  // at 1 rad/s, half of a cell
    estimate = law.update(number<Scalar>(0.001 * sign * i), number<Scalar>(0.3));
  }
  const double gain = forward ? 0.5 * (0.2 + 0.5) : 0.5 * (-0.4 + 0.1);
  EXPECT_NEAR(value_of(estimate.q2), 0.9 * sign + gain * 0.3, 1e-5);
  Sample<Scalar> motion = law.sample();
  EXPECT_NEAR(value_of(law.invert(estimate.q2, motion)), sign, 1e-5);
}
TEST(Table, OverRateTimesTorqueIsAddedAndTakenAwayByTheInverse) {
  for (const bool forward : {true, false}) {
    goes_there_and_back<double>(forward);
    goes_there_and_back<Q24>(forward);
  }
}

TEST(Table, OfManyLargeValuesFitsWhereASumOfThemWouldNot) {
  test::LawBuilder builder;
  for (std::size_t k = 0; k < kKnots; ++k) {
    builder.coefficient("table", "forward_" + std::to_string(k), 10.0);
  }
  EXPECT_TRUE(fits(builder.parameters<Q24>()));
  builder.coefficient("table", "forward_0", 127.0).coefficient("motor_angle", "beta", 127.0);
  builder.coefficient("tendon_elongation", "top", -2.5);
  EXPECT_FALSE(fits(builder.parameters<Q24>()));
}

TEST(Table, IsWhatTheLawAddsToTheRestAndOffItIsNothing) {
  test::LawBuilder builder;
  builder.coefficient("motor_angle", "beta", 0.9)
      .shape("table", "knots", 3)
      .shape("table", "low", -1.0)
      .shape("table", "high", 1.0);
  auto without = builder.law<Q24>();
  builder.coefficient("table", "forward_2", 0.25).coefficient("table", "backward_0", -0.125);
  auto with = builder.law<Q24>();
  for (int i = 0; i < 3000; ++i) {
    const Q24 q1 = number<Q24>(std::sin(0.01 * i));
    const Q24 apart = with.update(q1, Q24{}).q2 - without.update(q1, Q24{}).q2;
    const double up = std::fmax(0.0, q1.to_double());
    const double down = std::fmax(0.0, -q1.to_double());
    const double wanted = with.sample().forward ? 0.25 * up : -0.125 * down;
    ASSERT_NEAR(apart.to_double(), wanted, 2e-7) << i;
  }
}

}  // namespace
}  // namespace capstan
