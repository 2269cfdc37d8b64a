// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>

#include "capstan/model/preisach.hpp"
#include "capstan/tests/model/relays.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::RandomMultisine;
using test::Relays;

constexpr int kRelays = 200;

/// Inputs between the relays' thresholds: reversals of all sizes, now and then an end of the range.
auto random_inputs(int count, double step) -> std::vector<double> {
  std::mt19937 engine(5);
  std::uniform_int_distribution<int> line(0, kRelays);
  std::geometric_distribution<int> small(0.05);
  std::vector<double> inputs;
  int at = 0;
  for (int i = 0; i < count; ++i) {
    const bool far = i % 10 == 0;
    at = far ? line(engine) : std::clamp(at + (i % 2 == 0 ? 1 : -1) * small(engine), 0, kRelays);
    inputs.push_back(Relays::kLow + at * step);
  }
  return inputs;
}

struct Error {
  double span = 0.0;
  double rms = 0.0;
  double worst = 0.0;
};

/// A model on a grid of so many levels against the relays, over the same inputs from the same saturation.
template <std::size_t MaxLevels>
auto error_of_grid(std::size_t levels) -> Error {
  Relays relays(kRelays);
  const auto table = relays.table<MaxLevels>(levels);
  EXPECT_EQ(describe(check(table, 1e-12).fault), describe(TableFault::kNone));
  Preisach<double, MaxLevels, 128> model(table, StartState::kNegativeSaturation, 1e-12);
  const auto inputs = random_inputs(1500, relays.step());
  Error error;
  error.span = table.force(levels - 1, levels - 1) - table.force(0, 0);
  for (const double u : inputs) {
    const double difference = model.update(u).force - relays.update(u);
    error.rms += difference * difference;
    error.worst = std::fmax(error.worst, std::fabs(difference));
  }
  EXPECT_EQ(model.cut_loops(), 0U) << "the memory must suffice, or the comparison is not of the grid alone";
  error.rms = std::sqrt(error.rms / static_cast<double>(inputs.size()));
  return error;
}

TEST(PreisachAgainstRelays, EqualsTheSumOfRelaysWhenTheGridIsAsFineAsThey) {
  EXPECT_LT(error_of_grid<kRelays + 1>(kRelays + 1).worst, 1e-10);
}

// Bilinear interpolation of a smooth table errs with the square of the cell, so twice the levels make a quarter of the
// error.
TEST(PreisachAgainstRelays, ErrorFallsWithTheSquareOfTheCell) {
  const Error coarse = error_of_grid<41>(11);
  const Error middle = error_of_grid<41>(21);
  const Error fine = error_of_grid<41>(41);
  for (const Error& error : {coarse, middle, fine}) {
    std::printf("grid error of full scale: rms %.1e, worst %.1e\n", error.rms / error.span, error.worst / error.span);
  }
  EXPECT_NEAR(coarse.rms / middle.rms, 4.0, 0.8);
  EXPECT_NEAR(middle.rms / fine.rms, 4.0, 0.8);
  EXPECT_LT(fine.worst, middle.worst);
  EXPECT_LT(middle.worst, coarse.worst);
}

TEST(PreisachAgainstRelays, TableCountedIsTheTableMeasured) {
  Relays relays(kRelays);
  const auto table = relays.table<11>(11);
  for (std::size_t row = 0; row < 11; ++row) {
    relays.saturate_low();
    for (std::size_t column = row + 1; column-- > 0;) {
      relays.update(table.inputs[row]);
      ASSERT_NEAR(relays.update(table.inputs[column]), table.force(row, column), 1e-10) << row << ", " << column;
    }
  }
}

// A million samples of random input, so far apart that nearly each one turns and some leave the table.
template <std::size_t MaxLevels>
void expect_fixed_follows_double() {
  const auto table = Relays(kRelays).table<MaxLevels>(MaxLevels);
  const auto fixed_table = convert_table<Q24>(table);
  const double span = table.force(MaxLevels - 1, MaxLevels - 1) - table.force(0, 0);
  Preisach<double, MaxLevels> exact(table, StartState::kNegativeSaturation, 1e-12);
  Preisach<Q24, MaxLevels> fixed(fixed_table, StartState::kNegativeSaturation, number<Q24>(1e-6));
  const RandomMultisine slow(7, 4.0, 0.5, 20.0);
  std::mt19937 engine(8);
  std::uniform_real_distribution<double> noise(-1.2, 1.2);
  double worst = 0.0;
  std::size_t deepest = 0;
  for (int i = 0; i < 1000000; ++i) {
    // Rounded to fixed point before both: the models compare inputs, and must see the same ones to see the same order.
    const Q24 u = number<Q24>(slow(0.001 * i) + noise(engine));
    const auto expected = exact.update(u.to_double());
    const auto estimate = fixed.update(u);
    worst = std::fmax(worst, std::fabs(estimate.force.to_double() - expected.force));
    ASSERT_EQ(estimate.beyond_table, expected.beyond_table);
    ASSERT_EQ(estimate.known, expected.known);
    deepest = std::max(deepest, fixed.extremes());
  }
  std::printf("law preisach_%zu | input to the table's ends and beyond | %.1e of full scale\n", MaxLevels,
              worst / span);
  EXPECT_LT(worst, 1e-3 * span);
  EXPECT_GE(deepest, 8U) << "the input must nest loops, or the sum is not tried";
}

TEST(PreisachAccuracy, FixedIsWithinAThousandthOfFullScaleOnTheThesisGrid) {
  expect_fixed_follows_double<11>();
}
TEST(PreisachAccuracy, FixedIsWithinAThousandthOfFullScaleOnAFineGrid) {
  expect_fixed_follows_double<41>();
}

}  // namespace
}  // namespace capstan
