// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/preisach_rows.hpp"

#include <algorithm>

#include "capstan/tools/identify/conditioning.hpp"

namespace capstan::tools {
namespace {

using PreisachLaw = Preisach<double, kMostPreisachLevels>;

auto grid_of(const Levels& levels) -> PreisachTable {
  PreisachTable table;
  table.levels = static_cast<std::uint32_t>(levels.size());
  std::copy(levels.begin(), levels.end(), table.inputs.begin());
  return table;
}

/// The table of a joint whose only relays fill one cell evenly and add up to one: up once the input has been above the
/// cell's row, until it falls below its column.
auto table_of_cell(PreisachTable table, std::size_t row, std::size_t column) -> PreisachTable {
  for (std::size_t a = 0; a < table.levels; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      table.set_force(a, b, a > row && b > column ? 1.0 : 0.0);
    }
  }
  return table;
}

/// Calls visit(column, table) for every cell's table; column 0 is the lower saturation.
template <typename Visit>
void for_each_cell(const PreisachTable& levels, Visit&& visit) {
  Eigen::Index column = 1;
  for (std::size_t row = 0; row + 1 < levels.levels; ++row) {
    for (std::size_t cell = 0; cell <= row; ++cell, ++column) {
      visit(column, table_of_cell(levels, row, cell));
    }
  }
}

auto cells_of(std::size_t levels) -> Eigen::Index {
  return static_cast<Eigen::Index>(levels * (levels - 1) / 2);
}

}  // namespace

auto even_levels(double low, double high, std::size_t count) -> Levels {
  Levels levels;
  for (std::size_t i = 0; i < count; ++i) {
    levels.push_back(low + (high - low) * static_cast<double>(i) / static_cast<double>(count - 1));
  }
  return levels;
}

auto levels_over(const ForceRows& rows, std::size_t count) -> Levels {
  constexpr double kInside = 0.005;
  const double margin = kInside * (rows.in.maxCoeff() - rows.in.minCoeff());
  return even_levels(rows.in.minCoeff() + margin, rows.in.maxCoeff() - margin, count);
}

auto averaged_rows(const std::vector<AxisLog>& logs) -> ForceRows {
  constexpr Eigen::Index kMostRows = 8000;
  const Eigen::VectorXd& time_s = logs.front().time_s;
  const double period_s = (time_s.tail(1)[0] - time_s[0]) / static_cast<double>(time_s.size() - 1);
  const Eigen::Index stretch = averaging_stretch(total_samples(logs), kMostRows, period_s);
  ForceRows averaged;
  Eigen::Index row = 0;
  for (const auto& log : logs) {
    const Eigen::Index rows = averaged.log_rows.emplace_back(log.samples() / stretch);
    averaged.in.conservativeResize(row + rows);
    averaged.out.conservativeResize(row + rows);
    averaged.in.tail(rows) = decimated(log.tau_nm, stretch);
    averaged.out.tail(rows) = decimated(log.effort, stretch);
    row += rows;
  }
  return averaged;
}

auto relay_columns(const Levels& levels, const Eigen::VectorXd& tau_nm) -> Eigen::MatrixXd {
  Eigen::MatrixXd columns(tau_nm.size(), cells_of(levels.size()) + 1);
  columns.col(0).setOnes();
  for_each_cell(grid_of(levels), [&](Eigen::Index column, const PreisachTable& table) {
    PreisachLaw relays(table);
    for (Eigen::Index i = 0; i < tau_nm.size(); ++i) {
      columns(i, column) = relays.update(tau_nm[i]).force;
    }
  });
  return columns;
}

auto relays_of(const Levels& levels, const ForceRows& rows) -> Relays {
  Relays result{grid_of(levels), Eigen::MatrixXd(rows.in.size(), cells_of(levels.size()) + 1), {}};
  const PreisachTable any_cell = table_of_cell(result.levels, 0, 0);
  Eigen::Index at = 0;
  for (const Eigen::Index count : rows.log_rows) {
    const Eigen::VectorXd in = rows.in.segment(at, count);
    result.columns.middleRows(at, count) = relay_columns(levels, in);
    PreisachLaw any(any_cell);
    for (const double input : in) {
      result.known.push_back(any.update(input).known);
    }
    at += count;
  }
  return result;
}

void keep_known(Relays& relays, ForceRows& rows) {
  std::vector<Eigen::Index> kept;
  Eigen::Index at = 0;
  for (Eigen::Index& count : rows.log_rows) {
    const auto before = kept.size();
    for (Eigen::Index i = 0; i < count; ++i, ++at) {
      if (relays.known[static_cast<std::size_t>(at)]) {
        kept.push_back(at);
      }
    }
    count = static_cast<Eigen::Index>(kept.size() - before);
  }
  rows.log_rows.erase(std::remove(rows.log_rows.begin(), rows.log_rows.end(), 0), rows.log_rows.end());
  relays.columns = Eigen::MatrixXd(relays.columns(kept, Eigen::all));
  rows.in = Eigen::VectorXd(rows.in(kept));
  rows.out = Eigen::VectorXd(rows.out(kept));
}

auto table_from_weights(const PreisachTable& levels) -> Eigen::MatrixXd {
  const auto values = static_cast<Eigen::Index>(levels.levels * (levels.levels + 1) / 2);
  Eigen::MatrixXd result(values, cells_of(levels.levels) + 1);
  result.col(0).setOnes();
  for_each_cell(levels, [&](Eigen::Index column, const PreisachTable& table) {
    for (Eigen::Index i = 0; i < values; ++i) {
      result(i, column) = table.forces[static_cast<std::size_t>(i)];
    }
  });
  return result;
}

auto with_weights(const PreisachTable& levels, const Eigen::VectorXd& weights) -> PreisachTable {
  PreisachTable table = levels;
  const Eigen::VectorXd values = table_from_weights(levels) * weights;
  std::copy(values.begin(), values.end(), table.forces.begin());
  return table;
}

auto signs_of_weights(Eigen::Index count) -> std::vector<Sign> {
  std::vector<Sign> signs(static_cast<std::size_t>(count), Sign::kNonNegative);
  signs[0] = Sign::kAny;
  return signs;
}

}  // namespace capstan::tools
