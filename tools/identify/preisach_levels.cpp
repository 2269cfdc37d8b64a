// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "capstan/tools/identify/preisach_rows.hpp"

namespace capstan::tools {
namespace {

// Every fourth stretch of so many averaged rows takes no part in the fit: short beside a branch, of which some is left
// to fit, and long beside the noise.
constexpr Eigen::Index kStretch = 8;
constexpr Eigen::Index kEvery = 4;
// Even levels stay unless others err this much less. Like the stretches, set beforehand (23 November 2026) and not
// varied.
constexpr double kWorthIt = 0.97;

auto held_out(Eigen::Index row) -> bool {
  return row / kStretch % kEvery == kEvery - 1;
}

/// The table fitted to the rows that take part, and no others.
auto fitted_table(const Levels& levels, ForceRows rows) -> PreisachTable {
  Relays relays = relays_of(levels, rows);
  const Eigen::Index n = relays.columns.cols();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < rows.in.size(); ++i) {
    if (relays.known[static_cast<std::size_t>(i)] && !held_out(i)) {
      kept.push_back(i);
    }
  }
  const Eigen::MatrixXd columns = relays.columns(kept, Eigen::all);
  const Eigen::VectorXd out = rows.out(kept);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n, n);
  gram.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  return with_weights(relays.levels, solve_signed(gram, columns.transpose() * out, signs_of_weights(n)));
}

/// Root mean square on the rows that take no part.
auto error_of(const PreisachTable& table, const ForceRows& rows) -> double {
  double squares = 0.0;
  long count = 0;
  Eigen::Index row = 0;
  for (const Eigen::Index in_log : rows.log_rows) {
    Preisach<double, kMostPreisachLevels> law(table, StartState::kNegativeSaturation, 1e-9);
    for (Eigen::Index i = 0; i < in_log; ++i, ++row) {
      const auto estimate = law.update(rows.in[row]);
      if (estimate.known && held_out(row)) {
        squares += (estimate.force - rows.out[row]) * (estimate.force - rows.out[row]);
        ++count;
      }
    }
  }
  return std::sqrt(squares / static_cast<double>(std::max(1L, count)));
}

auto without(const PreisachTable& table, std::size_t level) -> PreisachTable {
  PreisachTable less;
  less.levels = table.levels - 1;
  for (std::size_t a = 0, row = 0; a < table.levels; ++a) {
    if (a == level) {
      continue;
    }
    less.inputs[row] = table.inputs[a];
    for (std::size_t b = 0, column = 0; b <= a; ++b) {
      if (b != level) {
        less.set_force(row, column++, table.force(a, b));
      }
    }
    ++row;
  }
  return less;
}

auto inputs_of(const PreisachTable& table) -> Levels {
  return {table.inputs.begin(), table.inputs.begin() + table.levels};
}

}  // namespace

auto chosen_levels(const ForceRows& rows, std::size_t count) -> ChosenLevels {
  PreisachTable table = fitted_table(levels_over(rows, kMostPreisachLevels), rows);
  while (table.levels > count) {
    PreisachTable best = table;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t level = 1; level + 1 < table.levels; ++level) {  // the ends stay
      const PreisachTable less = without(table, level);
      if (const double error = error_of(less, rows); error < least) {
        least = error;
        best = less;
      }
    }
    table = best;
  }
  const Levels even = levels_over(rows, count);
  ChosenLevels chosen{inputs_of(table), error_of(fitted_table(even, rows), rows), 0.0};
  chosen.adaptive_rmse_nm = error_of(fitted_table(chosen.levels, rows), rows);
  if (!(chosen.adaptive_rmse_nm < kWorthIt * chosen.even_rmse_nm)) {
    chosen.levels = even;
  }
  return chosen;
}

}  // namespace capstan::tools
