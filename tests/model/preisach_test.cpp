// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/preisach.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <vector>

#include "capstan/tests/model/any_table.hpp"
#include "capstan/tests/model/relays.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::any_input;
using test::any_table;
using test::number;
using test::play_history;
using test::Relays;
using test::value_of;

constexpr double kNoise = 1e-6;  // above the rounding of a table in either format

/// The small real instrument of these tests: 11 levels over [-5, 5], saturations that differ.
template <typename Scalar>
auto table() -> const ReversalTable<Scalar, 11>& {
  static const auto kCached = convert_table<Scalar>(Relays(20).table<11>(11));
  return kCached;
}

template <typename Scalar, std::size_t Depth = 64>
auto model(StartState start = StartState::kNegativeSaturation) -> Preisach<Scalar, 11, Depth> {
  return Preisach<Scalar, 11, Depth>(table<Scalar>(), start, number<Scalar>(kNoise));
}

template <typename Scalar>
class PreisachModel : public testing::Test {
 protected:
  static auto feed(auto& preisach, double u) -> ForceEstimate<Scalar> { return preisach.update(number<Scalar>(u)); }
  static constexpr double kBound = std::is_same_v<Scalar, double> ? 1e-12 : 4.0 * test::kLsb;
};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(PreisachModel, Formats);

TYPED_TEST(PreisachModel, ReproducesEveryReversalValueItWasMadeOf) {
  auto preisach = model<TypeParam>();
  for (std::size_t row = 0; row < 11; ++row) {
    for (std::size_t column = 0; column <= row; ++column) {
      this->feed(preisach, -5.0);
      preisach.update(table<TypeParam>().inputs[row]);
      const auto estimate = preisach.update(table<TypeParam>().inputs[column]);
      ASSERT_NEAR(value_of(estimate.force), value_of(table<TypeParam>().force(row, column)), this->kBound)
          << row << ", " << column;
    }
  }
}

TYPED_TEST(PreisachModel, StartsFromTheMeasuredLowerSaturationNotFromTheUpperOneReversed) {
  const double lower = value_of(table<TypeParam>().force(0, 0));
  const double upper = value_of(table<TypeParam>().force(10, 10));
  ASSERT_GT(std::fabs(lower + upper), 1.0) << "the table must be asymmetric, or this shows nothing";
  auto preisach = model<TypeParam>();
  EXPECT_NEAR(value_of(this->feed(preisach, -5.0).force), lower, this->kBound);
  EXPECT_NEAR(value_of(this->feed(preisach, 5.0).force), upper, this->kBound);
  EXPECT_NEAR(value_of(this->feed(preisach, -5.0).force), lower, this->kBound);
}

TYPED_TEST(PreisachModel, InputBeyondTheTableSaturatesAndIsFlagged) {
  auto preisach = model<TypeParam>();
  const auto at_end = this->feed(preisach, 5.0);
  EXPECT_FALSE(at_end.beyond_table);
  for (const double u : {5.001, 40.0, 127.9}) {
    const auto estimate = this->feed(preisach, u);
    EXPECT_TRUE(estimate.beyond_table) << u;
    EXPECT_EQ(estimate.force, at_end.force);
  }
  EXPECT_FALSE(this->feed(preisach, 4.9).beyond_table);
  EXPECT_TRUE(this->feed(preisach, -5.001).beyond_table);
  EXPECT_NEAR(value_of(this->feed(preisach, -100.0).force), value_of(table<TypeParam>().force(0, 0)), this->kBound);
}

TYPED_TEST(PreisachModel, IsKnownFromTheFirstSaturationOnAndNotBefore) {
  for (const double end : {-5.0, 5.0}) {
    for (const StartState start : {StartState::kNegativeSaturation, StartState::kDemagnetised}) {
      auto preisach = model<TypeParam>(start);
      EXPECT_FALSE(preisach.is_known());
      EXPECT_FALSE(this->feed(preisach, 0.99 * end).known);
      EXPECT_FALSE(this->feed(preisach, -0.99 * end).known);
      EXPECT_TRUE(this->feed(preisach, end).known);
      EXPECT_TRUE(this->feed(preisach, 0.0).known);
      EXPECT_TRUE(preisach.is_known());
      preisach.reset(start);
      EXPECT_FALSE(preisach.is_known());
    }
  }
}

TYPED_TEST(PreisachModel, ForgetsItsStartStateAtTheFirstSaturation) {
  auto saturated = model<TypeParam>(StartState::kNegativeSaturation);
  auto demagnetised = model<TypeParam>(StartState::kDemagnetised);
  EXPECT_NE(this->feed(saturated, 0.3).force, this->feed(demagnetised, 0.3).force);
  this->feed(saturated, 5.0);
  this->feed(demagnetised, 5.0);
  for (const double u : {-2.0, 3.0, -1.0, 2.0, 0.1}) {
    EXPECT_EQ(this->feed(saturated, u).force, this->feed(demagnetised, u).force) << u;
  }
}

// The real thing: a decaying swing of a thousand turns about the middle, played to the relays.
TYPED_TEST(PreisachModel, DemagnetisedStartIsCloseToASlowlyDecayingSwing) {
  Relays relays(200);
  for (int i = 0; i < 1000; ++i) {
    relays.update((i % 2 == 0 ? 5.0 : -5.0) * (1.0 - i / 1000.0));
  }
  const double span = value_of(table<TypeParam>().force(10, 10)) - value_of(table<TypeParam>().force(0, 0));
  auto preisach = model<TypeParam>(StartState::kDemagnetised);
  for (const double u : {0.0, 0.7, -0.6, 1.9, -2.3, 3.4, -4.1}) {
    EXPECT_NEAR(value_of(this->feed(preisach, u).force), relays.update(u), 0.01 * span) << u;
  }
  EXPECT_EQ(preisach.cut_loops(), 0U);
}

TYPED_TEST(PreisachModel, FullMemoryDropsTheSmallestLoopCountsItAndRecovers) {
  auto deep = model<TypeParam, 64>();
  auto shallow = model<TypeParam, 8>();
  double force_at_last_peak = 0.0;
  double force_at_last_valley = 0.0;
  std::uint32_t cuts_reported = 0;
  for (int i = 0; i < 40; ++i) {  // an inward spiral
    const double u = (i % 2 == 0 ? 1.0 : -1.0) * (4.8 - 0.1 * i);
    const double expected = value_of(this->feed(deep, u).force);
    const auto estimate = this->feed(shallow, u);
    cuts_reported += estimate.history_cut ? 1 : 0;
    ASSERT_LE(shallow.extremes(), 8U);
    if (shallow.cut_loops() == 0) {
      ASSERT_EQ(value_of(estimate.force), expected) << "nothing dropped yet at turn " << i;
      (i % 2 == 0 ? force_at_last_peak : force_at_last_valley) = expected;
    }
    // Both are inside the smallest loop that the shallow memory still holds, so they differ by its height at most.
    ASSERT_LE(std::fabs(value_of(estimate.force) - expected), force_at_last_peak - force_at_last_valley)
        << "turn " << i;
  }
  EXPECT_EQ(deep.cut_loops(), 0U);
  EXPECT_GT(shallow.cut_loops(), 10U);
  EXPECT_EQ(shallow.cut_loops(), cuts_reported);
  this->feed(deep, 4.9);
  this->feed(shallow, 4.9);
  for (const double u : {-4.0, 3.0, 1.0, 2.0, -5.0, 0.5}) {
    EXPECT_EQ(this->feed(shallow, u).force, this->feed(deep, u).force) << "the dropped loops are wiped out";
  }
}

TYPED_TEST(PreisachModel, WithoutAUsableTableFlagsEveryStep) {
  ReversalTable<TypeParam, 11> incomplete = table<TypeParam>();
  incomplete.set_force(7, 3, ScalarTraits<TypeParam>::missing());
  Preisach<TypeParam, 11> preisach(incomplete, StartState::kNegativeSaturation, number<TypeParam>(kNoise));
  for (const double u : {-5.0, 5.0, 0.5, 100.0}) {
    const auto estimate = this->feed(preisach, u);
    EXPECT_TRUE(estimate.beyond_table);
    EXPECT_FALSE(estimate.known);
    EXPECT_EQ(value_of(estimate.force), 0.0);
  }
}

TYPED_TEST(PreisachModel, StandingStillChangesNothing) {
  auto preisach = model<TypeParam>();
  for (const double u : {3.0, -2.0, 1.0}) {
    const auto arrived = this->feed(preisach, u);
    const std::size_t extremes = preisach.extremes();
    for (int i = 0; i < 100; ++i) {
      ASSERT_EQ(this->feed(preisach, u).force, arrived.force);
    }
    EXPECT_EQ(preisach.extremes(), extremes);
  }
}

TEST(PreisachOnTheHost, TakesNotANumberAsOutsideTheTable) {
  auto preisach = model<double>();
  EXPECT_TRUE(preisach.update(std::numeric_limits<double>::quiet_NaN()).beyond_table);
}

template <typename Scalar>
void check_wipe_out() {
  const auto table = any_table<Scalar>();
  RC_ASSERT(check(table).ok());
  Preisach<Scalar, 9> wandered(table);
  play_history(wandered, table);
  auto direct = wandered;
  const Scalar valley = any_input(table, 0.2, 0.3);
  const Scalar peak = any_input(table, 0.7, 0.8);
  for (auto* preisach : {&wandered, &direct}) {
    preisach->update(valley);
  }
  play_history(wandered, table, 0.3, 0.7);  // inside, and wiped out by the peak
  for (auto* preisach : {&wandered, &direct}) {
    preisach->update(peak);
  }
  RC_ASSERT(wandered.extremes() == direct.extremes());
  for (int i = 0; i < 10; ++i) {
    const Scalar u = any_input(table);
    RC_ASSERT(wandered.update(u).force == direct.update(u).force);
  }
}
RC_GTEST_PROP(PreisachProperties, WiderSwingWipesOutWhatLayInsideIt, ()) {
  check_wipe_out<double>();
}
RC_GTEST_PROP(PreisachProperties, WiderSwingWipesOutWhatLayInsideItInFixedPoint, ()) {
  check_wipe_out<Q24>();
}

template <typename Scalar>
void check_congruency(double bound) {
  const auto table = any_table<Scalar>();
  Preisach<Scalar, 9> first(table);
  Preisach<Scalar, 9> second(table, StartState::kDemagnetised);
  play_history(first, table);
  play_history(second, table);
  const Scalar valley = any_input(table, 0.0, 0.5);
  const Scalar peak = any_input(table, 0.5, 1.0);
  const Scalar between = clamp(any_input(table), valley, peak);
  for (auto* preisach : {&first, &second}) {
    preisach->update(valley);
    preisach->update(peak);
  }
  // Down, up and down again through the same two extremes: same shape, whatever the past and wherever it has put the
  // loop.
  const double apart = value_of(first.update(peak).force) - value_of(second.update(peak).force);
  for (const Scalar u : {between, valley, between, peak, between, valley}) {
    RC_ASSERT(std::fabs(value_of(first.update(u).force) - value_of(second.update(u).force) - apart) <= bound);
  }
}
RC_GTEST_PROP(PreisachProperties, LoopsBetweenTheSameExtremesAreCongruent, ()) {
  check_congruency<double>(1e-12);
}
RC_GTEST_PROP(PreisachProperties, LoopsBetweenTheSameExtremesAreCongruentInFixedPoint, ()) {
  check_congruency<Q24>(8.0 * test::kLsb);
}

template <typename Scalar>
void check_monotone(double bound) {
  const auto table = any_table<Scalar>();
  Preisach<Scalar, 9> preisach(table);
  play_history(preisach, table);
  std::array<Scalar, 20> inputs{};
  for (Scalar& input : inputs) {
    input = any_input(table);
  }
  std::sort(inputs.begin(), inputs.end());
  const bool rising = *rc::gen::arbitrary<bool>();
  if (!rising) {
    std::reverse(inputs.begin(), inputs.end());
  }
  const double sign = rising ? 1.0 : -1.0;
  double before = sign * value_of(preisach.update(inputs.front()).force);
  for (const Scalar u : inputs) {
    const double force = sign * value_of(preisach.update(u).force);
    RC_ASSERT(force >= before - bound);
    before = force;
  }
}
RC_GTEST_PROP(PreisachProperties, EveryBranchIsMonotone, ()) {
  check_monotone<double>(1e-12);
}
RC_GTEST_PROP(PreisachProperties, EveryBranchIsMonotoneInFixedPoint, ()) {
  check_monotone<Q24>(4.0 * test::kLsb);
}

// Whatever comes in, the force stays between the two saturations and the memory within its bound.
RC_GTEST_PROP(PreisachProperties, ForceStaysBetweenTheSaturationsAndMemoryWithinItsDepth, ()) {
  const auto table = any_table<Q24>();
  Preisach<Q24, 9, 6> preisach(table);
  const auto inputs = *rc::gen::arbitrary<std::vector<std::int32_t>>();
  const double lower = table.force(0, 0).to_double() - 16.0 * test::kLsb;
  const double upper = table.force(table.levels - 1, table.levels - 1).to_double() + 16.0 * test::kLsb;
  for (const std::int32_t raw : inputs) {
    const double force = preisach.update(Q24::from_raw(raw)).force.to_double();
    RC_ASSERT(force >= lower && force <= upper);
    RC_ASSERT(preisach.extremes() >= 1 && preisach.extremes() <= 6);
  }
}

}  // namespace
}  // namespace capstan
