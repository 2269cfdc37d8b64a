// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr std::size_t kCells = kPreisachLevels * (kPreisachLevels - 1) / 2;
using Table = ReversalTable<double, kPreisachLevels>;

/// Logs averaged over stretches: noise of the torque would else be taken for reversals.
struct Averaged {
  Eigen::VectorXd in, out;
  std::vector<Eigen::Index> log_rows;
};
auto average(const std::vector<ForceLog>& logs) -> Averaged {
  constexpr Eigen::Index kMostRows = 8000;
  constexpr double kLongestRowS = 0.04;  // beyond, the mean cuts off what a quick motion reaches
  Eigen::Index total = 0;
  for (const auto& log : logs) {
    total += log.samples();
  }
  const Eigen::VectorXd& time_s = logs.front().time_s;
  const double period_s = (time_s.tail(1)[0] - time_s[0]) / static_cast<double>(time_s.size() - 1);
  const auto longest = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(kLongestRowS / period_s));
  const Eigen::Index stretch = std::clamp<Eigen::Index>((total + kMostRows - 1) / kMostRows, 1, longest);
  Averaged averaged;
  Eigen::Index rows = 0;
  for (const auto& log : logs) {
    averaged.log_rows.push_back(log.samples() / stretch);
    rows += averaged.log_rows.back();
  }
  averaged.in.resize(rows);
  averaged.out.resize(rows);
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < logs.size(); ++k) {
    for (Eigen::Index i = 0; i < averaged.log_rows[k]; ++i, ++row) {
      averaged.in[row] = logs[k].tau_nm.segment(i * stretch, stretch).mean();
      averaged.out[row] = logs[k].tau_out_nm.segment(i * stretch, stretch).mean();
    }
  }
  return averaged;
}

/// Levels in equal steps.
auto levels_between(double low, double high, std::size_t levels = kPreisachLevels) -> Table {
  Table table;
  table.levels = static_cast<decltype(table.levels)>(levels);
  for (std::size_t i = 0; i < levels; ++i) {
    table.inputs[i] = low + (high - low) * static_cast<double>(i) / static_cast<double>(levels - 1);
  }
  return table;
}

/// Levels over the range of the input, its ends a little inside so that the outermost swings saturate.
auto grid(const Eigen::VectorXd& in) -> Table {
  constexpr double kInside = 0.005;
  const double margin = kInside * (in.maxCoeff() - in.minCoeff());
  return levels_between(in.minCoeff() + margin, in.maxCoeff() - margin);
}

/// The table of a joint whose only relays fill one cell evenly and add up to one: up once the input has been above the
/// cell's row, until it falls below its column.
auto table_of_cell(Table table, std::size_t row, std::size_t column) -> Table {
  for (std::size_t a = 0; a < table.levels; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      table.set_force(a, b, a > row && b > column ? 1.0 : 0.0);
    }
  }
  return table;
}

/// Calls visit(column, table) for every cell's table; column 0 is the lower saturation.
template <typename Visit>
void for_each_cell(const Table& levels, Visit&& visit) {
  Eigen::Index column = 1;
  for (std::size_t row = 0; row + 1 < levels.levels; ++row) {
    for (std::size_t cell = 0; cell <= row; ++cell, ++column) {
      visit(column, table_of_cell(levels, row, cell));
    }
  }
}

struct Regressors {
  Eigen::MatrixXd columns;           ///< ones, then a column per cell
  std::vector<bool> known;           ///< the row's past no longer matters
  Eigen::MatrixXd table_from_theta;  ///< values of the table, in its order
};
auto regressors(const Table& levels, const Averaged& averaged) -> Regressors {
  Regressors result;
  result.columns.resize(averaged.in.size(), kCells + 1);
  result.table_from_theta.resize(Table::kMaxValues, kCells + 1);
  result.table_from_theta.col(0).setOnes();
  for_each_cell(levels, [&](Eigen::Index column, const Table& table) {
    for (std::size_t i = 0; i < Table::kMaxValues; ++i) {
      result.table_from_theta(static_cast<Eigen::Index>(i), column) = table.forces[i];
    }
  });
  const Table any_cell = table_of_cell(levels, 0, 0);
  Eigen::Index at = 0;
  for (const Eigen::Index count : averaged.log_rows) {
    const Eigen::VectorXd in = averaged.in.segment(at, count);
    result.columns.middleRows(at, count) =
        relay_columns(levels.inputs[0], levels.inputs[levels.levels - 1], levels.levels, in);
    Preisach<double, kPreisachLevels> any(any_cell);
    for (const double input : in) {
      result.known.push_back(any.update(input).known);
    }
    at += count;
  }
  return result;
}

/// Drops the rows before each log's first saturation.
void keep_known(Regressors& regressors, Averaged& averaged) {
  std::vector<Eigen::Index> kept;
  Eigen::Index at = 0;
  for (Eigen::Index& count : averaged.log_rows) {
    const auto before = kept.size();
    for (Eigen::Index i = 0; i < count; ++i, ++at) {
      if (regressors.known[static_cast<std::size_t>(at)]) {
        kept.push_back(at);
      }
    }
    count = static_cast<Eigen::Index>(kept.size() - before);
  }
  averaged.log_rows.erase(std::remove(averaged.log_rows.begin(), averaged.log_rows.end(), 0), averaged.log_rows.end());
  regressors.columns = Eigen::MatrixXd(regressors.columns(kept, Eigen::all));
  averaged.in = Eigen::VectorXd(averaged.in(kept));
  averaged.out = Eigen::VectorXd(averaged.out(kept));
}

/// Values of the table that no row can tell: those with a part in a direction along which the columns add up to
/// nothing.
auto invisible(const Regressors& regressors) -> std::vector<bool> {
  constexpr double kNothing = 1e-9;
  const Eigen::MatrixXd gram =
      regressors.columns.transpose() * regressors.columns / static_cast<double>(regressors.columns.rows());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> directions(gram);
  std::vector<bool> result(Table::kMaxValues, false);
  for (Eigen::Index k = 0; k < gram.cols() && directions.eigenvalues()[k] < kNothing; ++k) {
    const Eigen::VectorXd change = regressors.table_from_theta * directions.eigenvectors().col(k);
    for (std::size_t i = 0; i < Table::kMaxValues; ++i) {
      result[i] = result[i] || std::abs(change[static_cast<Eigen::Index>(i)]) > 1e-3;
    }
  }
  return result;
}

void judge_run(const std::vector<ForceLog>& logs, PreisachFit& result) {
  double squares = 0.0;
  for (const auto& log : logs) {
    Preisach<double, kPreisachLevels> law(result.table, StartState::kNegativeSaturation, 1e-9);
    for (Eigen::Index i = 0; i < log.samples(); ++i) {
      const auto estimate = law.update(log.tau_nm[i]);
      squares += estimate.known ? std::pow(estimate.force - log.tau_out_nm[i], 2.0) : 0.0;
      result.samples += estimate.known ? 1 : 0;
    }
  }
  result.rmse_nm = std::sqrt(squares / static_cast<double>(std::max(1L, result.samples)));
}

void judge_values(const LinearFit& fit, const Regressors& regressors, PreisachFit& result) {
  constexpr double kLoose = 0.1;  // of full scale: an interval wider than that says little
  const Eigen::MatrixXd covariance =
      regressors.table_from_theta * fit.covariance * regressors.table_from_theta.transpose();
  const double t95 = half_interval(fit, 0) > 0.0 ? half_interval(fit, 0) / std::sqrt(fit.covariance(0, 0)) : 2.0;
  const auto unseen = invisible(regressors);
  for (std::size_t a = 0; a < kPreisachLevels; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      const std::size_t i = Table::index(a, b);
      const auto at = static_cast<Eigen::Index>(i);
      const double half =
          unseen[i] ? std::numeric_limits<double>::infinity() : t95 * std::sqrt(std::max(0.0, covariance(at, at)));
      result.half_intervals.push_back(half);
      if (!(half < kLoose * result.full_scale_nm)) {
        result.undetermined.push_back("f(" + rounded(result.table.inputs[a], 3) + ", " +
                                      rounded(result.table.inputs[b], 3) + ")");
      }
    }
  }
}

}  // namespace

auto relay_columns(double low_nm, double high_nm, std::size_t levels, const Eigen::VectorXd& tau_nm)
    -> Eigen::MatrixXd {
  Eigen::MatrixXd columns(tau_nm.size(), static_cast<Eigen::Index>(levels * (levels - 1) / 2 + 1));
  columns.col(0).setOnes();
  for_each_cell(levels_between(low_nm, high_nm, levels), [&](Eigen::Index column, const Table& table) {
    Preisach<double, kPreisachLevels> relays(table);
    for (Eigen::Index i = 0; i < tau_nm.size(); ++i) {
      columns(i, column) = relays.update(tau_nm[i]).force;
    }
  });
  return columns;
}

auto fit_preisach(const std::vector<ForceLog>& logs) -> PreisachFit {
  constexpr Eigen::Index kFewest = 200;
  Averaged averaged = average(logs);
  PreisachFit result;
  result.table = grid(averaged.in);
  Regressors all = regressors(result.table, averaged);
  keep_known(all, averaged);
  if (averaged.in.size() < kFewest) {
    throw Refusal(
        "hardly anything was recorded after the torque had first been at an end of its range, so the past of the "
        "joint is not known; start the record with one full swing in both directions");
  }
  std::vector<Sign> signs(kCells + 1, Sign::kNonNegative);
  signs[0] = Sign::kAny;
  const LinearFit first = fit_columns(all.columns, averaged.out, even_blocks(averaged.log_rows, 2), signs);
  const Blocks blocks = interval_blocks(pieces_of(averaged.log_rows), averaged.out - all.columns * first.theta);
  const LinearFit fit = fit_columns(all.columns, averaged.out, blocks, signs);
  const Eigen::VectorXd values = all.table_from_theta * fit.theta;
  for (std::size_t i = 0; i < Table::kMaxValues; ++i) {
    result.table.forces[i] = values[static_cast<Eigen::Index>(i)];
  }
  const std::size_t last = kPreisachLevels - 1;
  result.full_scale_nm = result.table.force(last, last) - result.table.force(0, 0);
  result.parameters.push_back({"input_low", "Nm", result.table.inputs[0], 0.0});
  result.parameters.push_back({"input_high", "Nm", result.table.inputs[last], 0.0});
  judge_values(fit, all, result);
  result.parameters.push_back({"saturation_low", "Nm", result.table.force(0, 0), result.half_intervals.front()});
  result.parameters.push_back({"saturation_high", "Nm", result.table.force(last, last), result.half_intervals.back()});
  result.cure =
      "rise to every level of torque in turn and fall back to the lowest each time, as "
      "tools/scenarios/recipe_preisach.toml does";
  result.notes.push_back(std::to_string(averaged.in.size()) + " averaged rows after the first saturation, grid of " +
                         std::to_string(kPreisachLevels) + " levels");
  judge_run(logs, result);
  result.error_bar = force_error_bar(logs, {.kind = ForceLawKind::kPreisach}, result.table);
  return result;
}

}  // namespace capstan::tools
