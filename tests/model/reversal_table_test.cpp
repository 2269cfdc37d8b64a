// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/reversal_table.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <string>

#include "capstan/model/reversal_surface.hpp"
#include "capstan/tests/model/relays.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::value_of;
using Table = ReversalTable<double, 11>;

auto good_table() -> Table {
  return test::Relays(20).table<11>(11);
}

TEST(ReversalTable, CompleteMonotoneTableIsAccepted) {
  EXPECT_TRUE(check(good_table(), 1e-12).ok());
  EXPECT_TRUE(check(convert_table<Q24>(good_table()), number<Q24>(1e-6)).ok());
}

TEST(ReversalTable, ThatNobodyFilledIsRefused) {
  EXPECT_EQ(check(Table{}).fault, TableFault::kLevelCount);
  Table table;
  table.levels = 3;
  table.inputs = {0.0, 1.0, 2.0};
  const auto verdict = check(table);
  EXPECT_EQ(verdict.fault, TableFault::kMissingForce);
  EXPECT_EQ(verdict.row, 0U);
}

TEST(ReversalTable, MoreLevelsThanItHoldsAreRefusedBeforeAnyIsRead) {
  Table table = good_table();
  for (const std::uint32_t levels : {0U, 1U, 12U, 1000000U}) {
    table.levels = levels;
    EXPECT_EQ(check(table).fault, TableFault::kLevelCount) << levels;
  }
}

/// Every single value of a good table, spoilt in turn, must be found at its own row and column.
TEST(ReversalTable, EachMissingValueIsNamedByRowAndColumn) {
  for (const double hole : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (std::size_t row = 0; row < 11; ++row) {
      for (std::size_t column = 0; column <= row; ++column) {
        Table table = good_table();
        table.set_force(row, column, hole);
        for (const TableCheck verdict : {check(table), check(convert_table<Q24>(table))}) {
          ASSERT_EQ(verdict.fault, TableFault::kMissingForce);
          ASSERT_EQ(verdict.row, row);
          ASSERT_EQ(verdict.column, column);
        }
      }
    }
  }
}

TEST(ReversalTable, EachFallAlongARowOrColumnIsNamedWhereItHappens) {
  for (std::size_t row = 1; row < 11; ++row) {
    for (std::size_t column = 1; column <= row; ++column) {
      Table table = good_table();
      table.set_force(row, column, table.force(row, column - 1) - 1e-6);
      auto verdict = check(table, 1e-9);
      ASSERT_EQ(verdict.fault, TableFault::kFallsAlongRow);
      ASSERT_EQ(verdict.row, row);
      ASSERT_EQ(verdict.column, column);
    }
  }
}

TEST(ReversalTable, FallAlongAColumnIsNamedAndAcceptedOnlyWithinTheTolerance) {
  Table table;
  table.levels = 3;
  table.inputs = {0.0, 1.0, 2.0};
  table.forces = {0.0, 0.0, 1.0, 0.0, 0.875, 2.0};  // a peak of 2 leaves less at 1 than a peak of 1 does
  const auto verdict = check(table, 0.1);
  EXPECT_EQ(verdict.fault, TableFault::kFallsAlongColumn);
  EXPECT_EQ(verdict.row, 2U);
  EXPECT_EQ(verdict.column, 1U);
  EXPECT_TRUE(check(table, 0.125).ok());
}

TEST(ReversalTable, CurvesThatEndInDifferentSaturationsAreRefused) {
  Table table = good_table();
  table.set_force(6, 0, table.force(0, 0) - 0.05);
  const auto verdict = check(table, 1e-3);
  EXPECT_EQ(verdict.fault, TableFault::kSaturationDiffers);
  EXPECT_EQ(verdict.row, 6U);
  EXPECT_TRUE(check(table, 0.051).ok()) << "the tolerance is the noise of the measurement";
}

TEST(ReversalTable, InputsOutOfOrderAreRefused) {
  Table table = good_table();
  table.inputs[4] = table.inputs[3];
  EXPECT_EQ(check(table).fault, TableFault::kInputsNotIncreasing);
  EXPECT_EQ(check(table).row, 4U);
  table.inputs[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(check(table).row, 4U);
}

TEST(ReversalTable, SpanThatTheFormatCanNotHoldIsRefused) {
  Table table = good_table();
  const double scale = 130.0 / (table.force(10, 10) - table.force(0, 0));  // from about -65 to +65: each value fits
  for (double& force : table.forces) {
    force *= scale;
  }
  EXPECT_TRUE(check(table, 1e-9).ok());
  EXPECT_EQ(check(convert_table<Q24>(table), number<Q24>(1e-6)).fault, TableFault::kSpanTooWide);
}

TEST(ReversalTable, EveryFaultHasItsOwnSentence) {
  std::vector<std::string> sentences;
  for (int i = 0; i <= static_cast<int>(TableFault::kSaturationDiffers); ++i) {
    sentences.emplace_back(describe(static_cast<TableFault>(i)));
    EXPECT_GT(sentences.back().size(), 20U);
    EXPECT_EQ(std::count(sentences.begin(), sentences.end(), sentences.back()), 1);
  }
}

template <typename Scalar>
class Surface : public testing::Test {};
using Formats = testing::Types<double, Q24>;
TYPED_TEST_SUITE(Surface, Formats);

/// A table of k0 + k1 a + k2 b + k3 a b on uneven levels.
template <typename Scalar>
auto bilinear_table(double k3) -> ReversalTable<Scalar, 11> {
  Table table;
  table.levels = 6;
  table.inputs = {-3.0, -2.25, -0.5, 0.125, 1.0, 4.0};
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column <= row; ++column) {
      const double a = table.inputs[row];
      const double b = table.inputs[column];
      table.set_force(row, column, 0.5 + 1.25 * a + 2.0 * b + k3 * a * b);
    }
  }
  return convert_table<Scalar>(table);
}

// Interpolation is exact on what it is made of: (4.9) on a b, in squares; (4.10) on a plane, in triangles too.
TYPED_TEST(Surface, ReproducesABilinearFunctionInSquaresAndAPlaneEverywhere) {
  const double bound = std::is_same_v<TypeParam, double> ? 1e-12 : 12.0 * test::kLsb;
  for (const double k3 : {0.0, 0.25}) {
    const auto table = bilinear_table<TypeParam>(k3);
    const ReversalSurface<TypeParam, 11> surface(table);
    bool beyond = false;
    for (double a = -3.0; a <= 4.0; a += 0.0617) {
      for (double b = -3.0; b <= a; b += 0.0531) {
        const auto at_a = surface.locate(number<TypeParam>(a), beyond);
        const auto at_b = surface.locate(number<TypeParam>(b), beyond);
        if (k3 == 0.0 || at_a.cell != at_b.cell) {
          ASSERT_NEAR(value_of(surface.at(at_a, at_b)), 0.5 + 1.25 * a + 2.0 * b + k3 * a * b, bound) << a << ", " << b;
        }
      }
    }
  }
}

TYPED_TEST(Surface, MeetsTheTableAtEveryGridPoint) {
  const auto table = bilinear_table<TypeParam>(0.25);
  const ReversalSurface<TypeParam, 11> surface(table);
  bool beyond = true;
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column <= row; ++column) {
      const auto a = surface.locate(table.inputs[row], beyond);
      const auto b = surface.locate(table.inputs[column], beyond);
      EXPECT_FALSE(beyond);
      EXPECT_NEAR(value_of(surface.at(a, b)), value_of(table.force(row, column)), 1e-15) << row << ", " << column;
    }
  }
}

TYPED_TEST(Surface, OrderOfPositionsIsTheOrderOfInputs) {
  const auto table = bilinear_table<TypeParam>(0.0);
  const ReversalSurface<TypeParam, 11> surface(table);
  bool beyond = false;
  auto before = surface.locate(number<TypeParam>(-3.0), beyond);
  EXPECT_EQ(before, surface.lowest());
  for (double u = -2.99; u < 4.0; u += 0.003) {
    const auto here = surface.locate(number<TypeParam>(u), beyond);
    ASSERT_LT(before, here) << u;
    before = here;
  }
  EXPECT_FALSE(surface.highest() < before);
  EXPECT_EQ(surface.locate(number<TypeParam>(4.0), beyond), surface.highest());
}

// Rounded down twice, so within two units of the last place whatever the width of the cell: one raw unit or the whole
// range.
RC_GTEST_PROP(CellScale, FractionOfACellIsRightToTwoUnitsForEveryWidth, ()) {
  using Limits = std::numeric_limits<std::int32_t>;
  auto any = rc::gen::oneOf(rc::gen::arbitrary<std::int32_t>(), rc::gen::inRange(Limits::min(), Limits::max()),
                            rc::gen::element(Limits::min(), Limits::max(), 0, 1, 2, 3));
  const std::int32_t first = *any;
  const std::int32_t second = *any;
  RC_PRE(first != second);
  const std::int64_t low = std::min(first, second);
  const std::int64_t high = std::max(first, second);
  const std::int64_t x =
      low + static_cast<std::int64_t>(static_cast<double>(high - low) * 1e-6 * *rc::gen::inRange(0, 1000001));
  const CellScale<Q24> scale(Q24::from_raw(static_cast<std::int32_t>(low)),
                             Q24::from_raw(static_cast<std::int32_t>(high)));
  const Q30 fraction =
      scale.fraction(Q24::from_raw(static_cast<std::int32_t>(x)), Q24::from_raw(static_cast<std::int32_t>(low)));
  const double exact = static_cast<double>(x - low) / static_cast<double>(high - low);
  RC_ASSERT(std::fabs(fraction.to_double() - exact) <= 2.0 * 0x1p-30);
  RC_ASSERT(fraction >= Q30{} && fraction <= Q30::from_int(1));
}

}  // namespace
}  // namespace capstan
