// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/law_assembly.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/tools/select/small_selection.hpp"

namespace capstan::tools {
namespace {

using test::few_parts;
using test::two_sines;

TEST(RowOrder, HasAPartOfEveryLogInEachPart) {
  // Logs of 8 and 4 rows in four parts: two rows of the one and one of the other in each.
  const Preparation p = test::preparation_of_both(two_sines(8), two_sines(4), Eigen::VectorXd::Zero(12));
  const SelectionData data(p, term_catalogue(), few_parts());
  const RowOrder all = ordered_in_parts(data, data.logs());
  EXPECT_EQ(all.rows, (std::vector<Eigen::Index>{0, 1, 8, 2, 3, 9, 4, 5, 10, 6, 7, 11}));
  ASSERT_EQ(all.parts.size(), 4u);
  EXPECT_EQ(all.parts[2].begin, 6);
  EXPECT_EQ(all.parts[2].end, 9);
  // Rows that may not be looked at are in none.
  const RowOrder some = ordered_in_parts(data, {{0, 2}, {6, 10}});
  EXPECT_EQ(some.rows, (std::vector<Eigen::Index>{0, 1, 8, 6, 7, 9}));
  EXPECT_TRUE(ordered_in_parts(data, {}).rows.empty());
}

TEST(RowOrder, LeavesOutWhatHasNotSettled) {
  // The motor reaches nine tenths of its range in the fifth of twenty rows.
  Eigen::VectorXd q1 = Eigen::VectorXd::Zero(20);
  for (Eigen::Index i = 0; i < 20; ++i) {
    q1[i] = i < 4 ? 0.0 : (i % 2 == 0 ? 1.0 : 0.0);
  }
  DecidingNumbers numbers = few_parts();
  numbers.settling.most_share_of_rows = 0.5;
  const test::SmallSelection small(q1, q1, numbers);
  const RowOrder order = ordered_in_parts(small.data, small.data.logs());
  EXPECT_EQ(order.rows.front(), small.data.settled().front().begin);
  EXPECT_GE(order.rows.front(), 4);
  EXPECT_EQ(order.rows.back(), 19);
}

/// Products of columns and target over all rows, the target last.
auto gram_of(const Eigen::MatrixXd& x, const Eigen::VectorXd& y) -> Eigen::MatrixXd {
  Eigen::MatrixXd all(x.rows(), x.cols() + 1);
  all << x, y;
  return all.transpose() * all;
}

TEST(SolveRidge, ByHandAndInAnyUnit) {
  // One column (1, 2), target (2, 4): 2 without a ridge, and 2 / 1.5 where the ridge is half of its size, whatever the
  // column's unit.
  for (const double unit : {1.0, 1e-6, 1e6}) {
    const Eigen::MatrixXd gram = gram_of(unit * Eigen::Vector2d(1, 2), Eigen::Vector2d(2, 4));
    const std::vector<Sign> any = {Sign::kAny};
    EXPECT_NEAR(solve_ridge(gram, any, Eigen::VectorXd::Zero(1))[0] * unit, 2.0, 1e-9);
    EXPECT_NEAR(solve_ridge(gram, any, Eigen::VectorXd::Constant(1, 0.5))[0] * unit, 2.0 / 1.5, 1e-9);
  }
}

TEST(LawAssembly, ItsRidgeCountsFromAnyZero) {
  // A column (-1, 0, 1), counted from anywhere, beside an offset; the target is three times it. With half of its size
  // for a ridge two thirds of that are left.
  for (const double zero : {0.0, 5.0, -20.0}) {
    Eigen::MatrixXd x(3, 2);
    x << zero - 1.0, 1.0, zero, 1.0, zero + 1.0, 1.0;
    LawAssembly fit;
    fit.signs = {Sign::kAny, Sign::kAny};
    fit.ridge = Eigen::Vector2d(0.5, 0.0);
    fit.offsets = {1};
    const Eigen::VectorXd theta = fit.solved(gram_of(x, Eigen::Vector3d(-3.0, 0.0, 3.0)));
    EXPECT_NEAR(theta[0], 2.0, 1e-9) << zero;
    EXPECT_NEAR(theta[1], -2.0 * zero, 1e-8) << zero;
  }
}

TEST(SolveRidge, AColumnOfNothingGetsNothing) {
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(3, 2);
  x.col(0) = Eigen::Vector3d(1, 1, 1);
  const Eigen::VectorXd theta =
      solve_ridge(gram_of(x, Eigen::Vector3d(2, 2, 2)), {Sign::kAny, Sign::kAny}, Eigen::Vector2d(0.0, 1e-6));
  EXPECT_NEAR(theta[0], 2.0, 1e-9);
  EXPECT_EQ(theta[1], 0.0);
}

TEST(SolveRidge, ASignThatIsBrokenIsKeptAndTheOthersFittedAnew) {
  // y = 3 a - 1 b with columns that overlap: with b at nothing a is y's product with a over a's own, 2.5.
  Eigen::MatrixXd x(2, 2);
  x << 1, 1, 1, 0;
  const Eigen::VectorXd y = x * Eigen::Vector2d(3, -1);
  const Eigen::VectorXd theta = solve_ridge(gram_of(x, y), {Sign::kAny, Sign::kNonNegative}, Eigen::VectorXd::Zero(2));
  EXPECT_NEAR(theta[0], 2.5, 1e-9);
  EXPECT_EQ(theta[1], 0.0);
}

TEST(EnergyLeft, IsTheSquareOfWhatAFitLeavesAndNeverLess) {
  const Eigen::MatrixXd x = test::normals(9, 2, 1);
  const Eigen::VectorXd y = test::normals(9, 1, 2);
  const Eigen::Vector2d theta(0.3, -0.7);
  EXPECT_NEAR(energy_left(gram_of(x, y), theta), (y - x * theta).squaredNorm(), 1e-12);
  EXPECT_GE(energy_left(gram_of(1e8 * x, 1e8 * (x * theta)), theta), 0.0);
}

/// Two tables of three knots, then a column that is no knot.
auto tables() -> LawAssembly {
  LawAssembly fit;
  fit.lines = {{0, 3}, {3, 6}};
  return fit;
}

TEST(LawAssembly, KnotsAreApartUnlessTheyAreNeighboursOfOneTable) {
  const LawAssembly fit = tables();
  EXPECT_FALSE(fit.are_apart(1, 1));
  EXPECT_FALSE(fit.are_apart(0, 1));
  EXPECT_FALSE(fit.are_apart(2, 1));
  EXPECT_TRUE(fit.are_apart(0, 2));
  EXPECT_TRUE(fit.are_apart(2, 3));   // of the other direction
  EXPECT_FALSE(fit.are_apart(2, 6));  // whatever is no knot may be anywhere
  EXPECT_FALSE(fit.are_apart(7, 0));
}

TEST(LawAssembly, FitsToTheFirstPartsOnly) {
  LawAssembly fit;
  fit.signs = {Sign::kAny};
  fit.ridge = Eigen::VectorXd::Zero(1);
  const auto part = [](double slope) { return gram_of(Eigen::Vector2d(1, 1), Eigen::Vector2d(slope, slope)); };
  fit.grams = {part(1.0), part(2.0), part(6.0)};
  EXPECT_NEAR(fit.fit(1)[0], 1.0, 1e-12);
  EXPECT_NEAR(fit.fit(2)[0], 1.5, 1e-12);
  EXPECT_NEAR(fit.fit(3)[0], 3.0, 1e-12);
  EXPECT_NEAR(fit.sum(1, 3)(0, 1), 16.0, 1e-12);
}

TEST(LawAssembly, AKnotWhereNoRowHasBeenLiesBetweenItsNeighbours) {
  LawAssembly fit;
  fit.lines = {{0, 3}};
  fit.signs.assign(3, Sign::kAny);
  fit.ridge = Eigen::VectorXd::Constant(3, 1e-12);
  fit.smoothness = 1e-6;
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(2, 3);  // a row at the first knot, one at the last
  x(0, 0) = x(1, 2) = 1.0;
  const Eigen::VectorXd theta = fit.solved(gram_of(x, Eigen::Vector2d(2, 4)));
  EXPECT_NEAR(theta[0], 2.0, 1e-4);
  EXPECT_NEAR(theta[1], 3.0, 1e-4);
  EXPECT_NEAR(theta[2], 4.0, 1e-4);
  fit.smoothness = 1e6;  // steps cost more than anything: one value for all
  const Eigen::VectorXd flat = fit.solved(gram_of(x, Eigen::Vector2d(2, 4)));
  EXPECT_NEAR(flat[0], 3.0, 1e-3);
  EXPECT_NEAR(flat[2], 3.0, 1e-3);
}

}  // namespace
}  // namespace capstan::tools
