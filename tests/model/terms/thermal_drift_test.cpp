// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/thermal_drift.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::kLsb;
using test::make_term;
using test::number;
using test::one_khz;
using test::value_of;

static_assert(SumTerm<ThermalDrift<double>, double> && SumTerm<ThermalDrift<Q24>, Q24>);

template <typename Scalar>
class Drift : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Drift, Formats);

// Twenty minutes: far beyond the 128 s that a quantity in seconds can count.
TYPED_TEST(Drift, WarmsUpAsAnExponentialForTwentyMinutes) {
  constexpr double kMinutes = 5.0;
  auto term = make_term<ThermalDrift, TypeParam>(kMinutes);
  for (int i = 1; i <= 1'200'000; ++i) {
    const double warmed = value_of(term.update({})[0]);
    if (i % 1000 == 0) {
      const double t = 0.001 * i / 60.0;
      // 1 ms of 5 minutes is the difference between a step of the filter and the exponential.
      ASSERT_NEAR(warmed, 1.0 - std::exp(-t / kMinutes), 2e-6) << t << " minutes";
    }
  }
}

TYPED_TEST(Drift, StaysAtOneOnceItIsWarm) {
  auto term = make_term<ThermalDrift, TypeParam>(0.05);
  for (int i = 0; i < 3'000'000; ++i) {
    const double warmed = value_of(term.update({})[0]);
    ASSERT_LE(warmed, 1.0) << i;
    ASSERT_GE(warmed, 0.0) << i;
  }
  EXPECT_NEAR(value_of(term.steady_state({})[0]), 1.0, kLsb);
}

TYPED_TEST(Drift, SecondPartIsTheTemperatureAboveTheReferenceAlone) {
  SampleConditioner<TypeParam> conditioner(one_khz<TypeParam>(), {});
  auto term = make_term<ThermalDrift, TypeParam>(5.0);
  EXPECT_EQ(value_of(term.update(conditioner.update({}))[1]), 0.0) << "without a thermometer";
  for (const double temperature : {-10.0, 25.0, 37.5, 85.0}) {
    const auto sample = conditioner.update({.temperature = number<TypeParam>(temperature)});
    EXPECT_EQ(value_of(term.update(sample)[1]), temperature - 25.0);
    EXPECT_EQ(value_of(term.steady_state(sample)[1]), temperature - 25.0);
  }
}

TYPED_TEST(Drift, SettledIsAsWarmAsItIsNow) {
  auto term = make_term<ThermalDrift, TypeParam>(1.0);
  TypeParam now{};
  for (int i = 0; i < 30000; ++i) {
    now = term.update({})[0];
  }
  EXPECT_EQ(term.steady_state({})[0], now);
}

}  // namespace
}  // namespace capstan
