// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "capstan/model/term.hpp"

namespace capstan::tools {

/// Rows begin <= row < end.
struct RowRange {
  Eigen::Index begin = 0;
  Eigen::Index end = 0;
  [[nodiscard]] auto size() const -> Eigen::Index { return end - begin; }
};
using Blocks = std::vector<RowRange>;

auto rows_in(const Blocks& blocks) -> Eigen::Index;
/// The blocks' rows, stacked.
auto stacked(const Eigen::VectorXd& values, const Blocks& blocks) -> Eigen::VectorXd;

/// Minimises t'At - 2b't with the signs kept (active set, after Lawson and Hanson). A is positive semidefinite; a
/// column that adds nothing (A_jj = 0) gets 0.
auto solve_signed(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs, const std::vector<Sign>& signs)
    -> Eigen::VectorXd;

struct LinearFit {
  Eigen::VectorXd theta;
  /// Covariance from the sums of scores over the blocks, each widened for what the fit owes to it (CR2): holds under
  /// any correlation that is shorter than a block.
  Eigen::MatrixXd covariance;
  /// 1 - R^2 of each column against the others: near 0, the log can not tell them apart.
  Eigen::VectorXd tolerance;
  std::vector<bool> at_bound;
  double rmse = 0.0;
  double degrees_of_freedom = 1.0;  ///< for Student's t: independent blocks less one
};

/// Least squares over the rows of the blocks. @pre at least two blocks
auto fit_columns(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, const Blocks& blocks,
                 const std::vector<Sign>& signs) -> LinearFit;

/// Half width of the 95 % interval of theta[i].
auto half_interval(const LinearFit& fit, Eigen::Index i) -> double;
/// Half width of the 95 % interval of the sum of theta[i] weights[i].
auto half_interval_of_sum(const LinearFit& fit, const Eigen::VectorXd& weights) -> double;

/// Splits the pieces into `count` blocks overall, at least one each and none across two.
auto even_parts(const Blocks& pieces, Eigen::Index count) -> Blocks;
/// The same for whole logs.
auto even_blocks(const std::vector<Eigen::Index>& log_rows, Eigen::Index count) -> Blocks;
/// Whole logs, one below the other.
auto pieces_of(const std::vector<Eigen::Index>& log_rows) -> Blocks;
/// Blocks that follow each other without a gap, as one. @pre in order
auto unbroken(const Blocks& blocks) -> Blocks;

/// Takes out of columns what a base explains of them on some rows, on all rows (Frisch, Waugh, Lovell). The base's
/// columns may depend on each other.
void project_out(const Eigen::MatrixXd& base, const Blocks& rows, Eigen::Ref<Eigen::MatrixXd> columns);

}  // namespace capstan::tools
