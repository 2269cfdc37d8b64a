// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/preisach_rows.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Values of the table that no row can tell: those with a part in a direction along which the columns add up to
/// nothing.
auto invisible(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& table_from_theta) -> std::vector<bool> {
  constexpr double kNothing = 1e-9;
  const Eigen::MatrixXd gram = columns.transpose() * columns / static_cast<double>(columns.rows());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> directions(gram);
  std::vector<bool> result(static_cast<std::size_t>(table_from_theta.rows()), false);
  for (Eigen::Index k = 0; k < gram.cols() && directions.eigenvalues()[k] < kNothing; ++k) {
    const Eigen::VectorXd change = table_from_theta * directions.eigenvectors().col(k);
    for (std::size_t i = 0; i < result.size(); ++i) {
      result[i] = result[i] || std::abs(change[static_cast<Eigen::Index>(i)]) > 1e-3;
    }
  }
  return result;
}

void judge_run(const std::vector<AxisLog>& logs, PreisachFit& result) {
  double squares = 0.0;
  for (const auto& log : logs) {
    Preisach<double, kMostPreisachLevels> law(result.table, StartState::kNegativeSaturation, 1e-9);
    for (Eigen::Index i = 0; i < log.samples(); ++i) {
      const auto estimate = law.update(log.tau_nm[i]);
      squares += estimate.known ? std::pow(estimate.force - log.effort[i], 2.0) : 0.0;
      result.samples += estimate.known ? 1 : 0;
    }
  }
  result.rmse_nm = std::sqrt(squares / static_cast<double>(std::max(1L, result.samples)));
}

void judge_values(const LinearFit& fit, const Eigen::MatrixXd& columns, PreisachFit& result) {
  constexpr double kLoose = 0.1;  // of full scale: an interval wider than that says little
  const Eigen::MatrixXd table_from_theta = table_from_weights(result.table);
  const Eigen::MatrixXd half = table_from_theta * fit.covariance;
  const Eigen::VectorXd variance = half.cwiseProduct(table_from_theta).rowwise().sum();
  const double t95 = half_interval(fit, 0) > 0.0 ? half_interval(fit, 0) / std::sqrt(fit.covariance(0, 0)) : 2.0;
  const auto unseen = invisible(columns, table_from_theta);
  for (std::size_t a = 0; a < result.table.levels; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      const std::size_t i = PreisachTable::index(a, b);
      const double interval = unseen[i] ? std::numeric_limits<double>::infinity()
                                        : t95 * std::sqrt(std::max(0.0, variance[static_cast<Eigen::Index>(i)]));
      result.half_intervals.push_back(interval);
      if (!(interval < kLoose * result.full_scale_nm)) {
        result.undetermined.push_back("f(" + rounded(result.table.inputs[a], 3) + ", " +
                                      rounded(result.table.inputs[b], 3) + ")");
      }
    }
  }
}

auto levels_for(const ForceRows& rows, const PreisachGrid& grid, PreisachFit& result) -> Levels {
  if (!grid.adaptive) {
    return levels_over(rows, grid.levels);
  }
  const ChosenLevels chosen = chosen_levels(rows, grid.levels);
  result.notes.push_back("on rows set aside, even levels leave " + rounded(chosen.even_rmse_nm, 3) +
                         " Nm and levels chosen by the log " + rounded(chosen.adaptive_rmse_nm, 3) + " Nm");
  return chosen.levels;
}

}  // namespace

auto ends_of(const PreisachTable& table, double low_half, double high_half) -> std::vector<ForceParameter> {
  const std::size_t last = table.levels - 1;
  return {{"input_low", "Nm", table.inputs[0], 0.0},
          {"input_high", "Nm", table.inputs[last], 0.0},
          {"saturation_low", "Nm", table.force(0, 0), low_half},
          {"saturation_high", "Nm", table.force(last, last), high_half}};
}

auto fit_preisach(const std::vector<AxisLog>& logs, const PreisachGrid& grid) -> PreisachFit {
  constexpr Eigen::Index kFewest = 200;
  ForceRows rows = averaged_rows(logs);
  PreisachFit result;
  Relays relays = relays_of(levels_for(rows, grid, result), rows);
  keep_known(relays, rows);
  if (rows.in.size() < kFewest) {
    throw Refusal(
        "too little was recorded after the torque first reached an end of its range, so the joint's history is "
        "unknown; start the record with one full swing in both directions");
  }
  const auto signs = signs_of_weights(relays.columns.cols());
  const LinearFit first = fit_columns(relays.columns, rows.out, even_blocks(rows.log_rows, 2), signs);
  const Blocks blocks = interval_blocks(pieces_of(rows.log_rows), rows.out - relays.columns * first.theta);
  const LinearFit fit = fit_columns(relays.columns, rows.out, blocks, signs);
  result.table = with_weights(relays.levels, fit.theta);
  const std::size_t last = result.table.levels - 1;
  result.full_scale_nm = result.table.force(last, last) - result.table.force(0, 0);
  judge_values(fit, relays.columns, result);
  result.parameters = ends_of(result.table, result.half_intervals.front(), result.half_intervals.back());
  result.cure =
      "rise to every level of torque in turn and fall back to the lowest each time, as "
      "tools/scenarios/recipe_preisach.toml does for 11 (with levels = 20 in it for 21), or ask for fewer --levels";
  result.notes.push_back(std::to_string(rows.in.size()) + " averaged rows after the first saturation, grid of " +
                         std::to_string(result.table.levels) + " levels");
  judge_run(logs, result);
  result.error_bar = force_error_bar(logs, {.kind = ForceLawKind::kPreisach}, result.table);
  return result;
}

}  // namespace capstan::tools
