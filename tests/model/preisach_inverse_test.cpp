// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <random>

#include "capstan/model/preisach.hpp"
#include "capstan/tests/model/any_table.hpp"
#include "capstan/tests/model/relays.hpp"

namespace capstan {
namespace {

using test::any_input;
using test::any_table;
using test::number;
using test::play_history;
using test::Relays;
using test::value_of;

template <typename Scalar>
void check_there_and_back() {
  const auto table = any_table<Scalar>();
  const std::size_t last = table.levels - 1;
  Preisach<Scalar, 9> preisach(table);
  play_history(preisach, table);
  const Scalar present = any_input(table);
  const Scalar before = preisach.update(present).force;
  const double low = value_of(table.force(0, 0));
  const double high = value_of(table.force(last, last));
  // A share by division: 0.001 times 1000 times a range may lie one place beyond its end.
  const Scalar wanted = number<Scalar>(low + (high - low) * (*rc::gen::inRange(0, 1001) / 1000.0));
  const auto command = preisach.input_for(wanted);
  RC_ASSERT(command.reachable);
  // One unit of the input's last place is this much force where the table is steepest.
  double steepest = 1.0;
  for (std::size_t row = 0; row < last; ++row) {
    const double width = value_of(table.inputs[row + 1]) - value_of(table.inputs[row]);
    steepest =
        std::max(steepest, (value_of(table.force(row + 1, row + 1)) - value_of(table.force(row + 1, row))) / width);
  }
  const bool fixed = !std::is_same_v<Scalar, double>;
  const double bound = fixed ? 8.0 * test::kLsb * (1.0 + steepest * 16.0) : 1e-9 * (1.0 + high - low);
  auto reached = preisach;
  RC_ASSERT(std::fabs(value_of(reached.update(command.input).force) - value_of(wanted)) <= bound);
  // Half the way there is not there yet, so no nearer input would have done.
  const double half = 0.5 * (value_of(present) + value_of(command.input));
  auto halfway = preisach;
  const double there = value_of(halfway.update(number<Scalar>(half)).force);
  const double over = before < wanted ? there - value_of(wanted) : value_of(wanted) - there;
  RC_ASSERT(over <= bound);
}
RC_GTEST_PROP(PreisachInverse, InputForAForceBringsItAbout, ()) {
  check_there_and_back<double>();
}
RC_GTEST_PROP(PreisachInverse, InputForAForceBringsItAboutInFixedPoint, ()) {
  check_there_and_back<Q24>();
}

// The relays themselves, turned up or down line by line: the force is passed within a line of where the model says.
TEST(PreisachInverse, AgreesWithRelaysTriedOneLineAfterTheOther) {
  constexpr int kLines = 200;
  Relays relays(kLines);
  const auto table = relays.table<kLines + 1>(kLines + 1);
  Preisach<double, kLines + 1, 128> preisach(table, StartState::kNegativeSaturation, 1e-12);
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const double low = table.force(0, 0);
  const double high = table.force(kLines, kLines);
  double present = relays.update(-5.0);
  preisach.update(-5.0);
  int line = 0;
  for (int round = 0; round < 300; ++round) {
    const double wanted = low + (high - low) * unit(engine);
    const auto command = preisach.input_for(wanted);
    ASSERT_TRUE(command.reachable);
    const int step = wanted > present ? 1 : -1;
    while ((wanted - present) * step > 0.0) {
      line += step;
      ASSERT_TRUE(line >= 0 && line <= kLines);
      present = relays.update(Relays::kLow + line * relays.step());
    }
    ASSERT_NEAR(command.input, Relays::kLow + (line - 0.5 * step) * relays.step(), 0.51 * relays.step()) << round;
    preisach.update(Relays::kLow + line * relays.step());
  }
  EXPECT_EQ(preisach.cut_loops(), 0U);
}

TEST(PreisachInverse, ForceBeyondASaturationGivesThatEndAndIsNotReachable) {
  const auto table = Relays(20).table<11>(11);
  Preisach<double, 11> preisach(table, StartState::kNegativeSaturation, 1e-12);
  for (const double u : {-5.0, 2.0, -1.0, 0.5}) {
    preisach.update(u);
    const auto above = preisach.input_for(table.force(10, 10) + 0.01);
    EXPECT_FALSE(above.reachable);
    EXPECT_EQ(above.input, 5.0);
    const auto below = preisach.input_for(table.force(0, 0) - 0.01);
    EXPECT_FALSE(below.reachable);
    EXPECT_EQ(below.input, -5.0);
    EXPECT_TRUE(preisach.input_for(table.force(10, 10) - 1e-9).reachable);
  }
}

TEST(PreisachInverse, WhereTheForceDoesNotChangeStaysPut) {
  // One relay in the middle cell: nothing happens below 0.5 and above 0.5 but a step spread over the cell.
  ReversalTable<double, 11> table;
  table.levels = 4;
  for (std::size_t row = 0; row < 4; ++row) {
    table.inputs[row] = static_cast<double>(row);
    for (std::size_t column = 0; column <= row; ++column) {
      table.set_force(row, column, row >= 2 && column >= 1 ? 1.0 : 0.0);
    }
  }
  Preisach<double, 11> preisach(table);
  preisach.update(0.25);
  EXPECT_EQ(preisach.input_for(0.0).input, 0.25);
  preisach.update(3.0);
  preisach.update(1.5);  // falling: the relay stays up until the cell below 1
  EXPECT_EQ(preisach.input_for(1.0).input, 1.5);
  EXPECT_EQ(preisach.input_for(0.0).input, 0.0) << "falls linearly from 1 to 0, and no farther than needed";
  EXPECT_EQ(preisach.input_for(0.5).input, 0.5);
}

TEST(PreisachInverse, WithoutAUsableTableReachesNothing) {
  const ReversalTable<Q24, 11> empty;
  const Preisach<Q24, 11> preisach(empty);
  EXPECT_FALSE(preisach.input_for(Q24{}).reachable);
}

// Relays with a past that the model has not seen: the force they give lies between the bounds, always.
TEST(PreisachBoundsOfAnUnknownPast, HoldTheForceUntilTheFirstSaturationAndAreExactFromThereOn) {
  constexpr int kLines = 40;
  std::mt19937 engine(12);
  std::uniform_int_distribution<int> any_line(1, kLines - 1);
  double widest = 0.0;
  for (int round = 0; round < 50; ++round) {
    Relays relays(kLines);
    const auto table = relays.table<kLines + 1>(kLines + 1);
    for (int i = 0; i < 20; ++i) {
      relays.update(Relays::kLow + any_line(engine) * relays.step());
    }
    PreisachBounds<double, kLines + 1> bounds(table, 1e-12);
    for (int i = 0; i < 30; ++i) {
      const double u = Relays::kLow + (i == 20 ? kLines : any_line(engine)) * relays.step();
      const double force = relays.update(u);
      const auto estimate = bounds.update(u);
      ASSERT_LE(std::fabs(estimate.middle.force - force), estimate.half_width + 1e-10);
      ASSERT_EQ(estimate.middle.known, i >= 20);
      ASSERT_EQ(estimate.half_width == 0.0, i >= 20);
      widest = std::max(widest, estimate.half_width);
    }
  }
  EXPECT_GT(widest, 1.0) << "an unknown past must matter, or the bounds are of nothing";
}

TEST(PreisachBoundsOfAnUnknownPast, CloseInAsTheInputSweepsMore) {
  const auto table = Relays(20).table<11>(11);
  PreisachBounds<double, 11> bounds(table, 1e-12);
  double before = 1e9;
  for (int i = 1; i < 5; ++i) {
    bounds.update(-static_cast<double>(i));
    bounds.update(static_cast<double>(i));
    const double now = bounds.update(0.0).half_width;
    EXPECT_LT(now, before);
    before = now;
  }
}

}  // namespace
}  // namespace capstan
