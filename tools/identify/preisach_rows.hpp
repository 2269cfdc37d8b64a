// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/tools/identify/force_fit.hpp"

namespace capstan::tools {

/// Motor torque and joint torque, N m, log below log.
struct ForceRows {
  Eigen::VectorXd in, out;
  std::vector<Eigen::Index> log_rows;
};
/// Logs averaged over stretches: noise of the torque would else be taken for reversals.
auto averaged_rows(const std::vector<AxisLog>& logs) -> ForceRows;

/// A relay in each cell of a grid, as columns over rows.
struct Relays {
  PreisachTable levels;     ///< of which the forces are nothing yet
  Eigen::MatrixXd columns;  ///< ones, then a column per cell
  std::vector<bool> known;  ///< the row's past no longer matters
};
auto relays_of(const Levels& levels, const ForceRows& rows) -> Relays;
/// Drops the rows before each log's first saturation.
void keep_known(Relays& relays, ForceRows& rows);

/// Values of the table from the saturation and the weights of the cells, in its order.
auto table_from_weights(const PreisachTable& levels) -> Eigen::MatrixXd;
auto with_weights(const PreisachTable& levels, const Eigen::VectorXd& weights) -> PreisachTable;

/// The saturation may be anything, weights may not be negative.
auto signs_of_weights(Eigen::Index count) -> std::vector<Sign>;

/// Over the range of the input, the ends a little inside so that the outermost swings saturate.
auto levels_over(const ForceRows& rows, std::size_t count) -> Levels;

/// Levels as PreisachGrid::adaptive says, with what was found.
struct ChosenLevels {
  Levels levels;
  double even_rmse_nm, adaptive_rmse_nm;  ///< on rows that the table was not fitted to
};
auto chosen_levels(const ForceRows& rows, std::size_t count) -> ChosenLevels;

}  // namespace capstan::tools
