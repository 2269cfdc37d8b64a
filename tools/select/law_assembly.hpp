// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "capstan/tools/select/selection_data.hpp"

namespace capstan::tools {

/// Rows of one part of every log, log after log, and the parts one after the other.
struct RowOrder {
  std::vector<Eigen::Index> rows;
  Blocks parts;
};

auto ordered_in_parts(const SelectionData& data, const Blocks& allowed) -> RowOrder;

/// Least squares with a little ridge, from scalar products; the last row and column are the target's.
auto solve_ridge(const Eigen::MatrixXd& gram, const std::vector<Sign>& signs, const Eigen::VectorXd& ridge)
    -> Eigen::VectorXd;
/// What these coefficients leave of the target's energy.
auto energy_left(const Eigen::MatrixXd& gram, const Eigen::VectorXd& theta) -> double;

/// The columns of a fit and what becomes of their coefficients.
struct LawAssembly {
  static constexpr std::size_t kNotKept = std::numeric_limits<std::size_t>::max();
  struct Column {
    std::size_t id = kNotKept;
    Eigen::VectorXd own;  ///< where it is not kept
    Sign sign = Sign::kAny;
    double ridge = 0.0;
    std::vector<Eigen::Index> coefficients;  ///< of the law
  };
  LawCandidate law;  ///< with what is placed by the log where it lies
  std::vector<Column> columns;
  Eigen::Index coefficients = 0, beta = -1, first_play = 0, plays = 0, first_bent = 0;
  Eigen::VectorXd held;                ///< weights of plays that are no columns any more
  std::vector<Eigen::MatrixXd> grams;  ///< per part, the target last
  std::vector<Sign> signs;
  Eigen::VectorXd ridge;
  std::vector<Eigen::Index> offsets;  ///< columns that only move a zero
  std::vector<RowRange> lines;        ///< columns that are neighbouring knots of a table
  double smoothness = 0.0;            ///< of what lies on them: DecidingNumbers

  /// Whether two columns never differ from nothing in one row: knots of a table that are no neighbours, or of different
  /// directions. A law has one table at most.
  [[nodiscard]] auto are_apart(Eigen::Index a, Eigen::Index b) const -> bool;
  /// The ridge of each column, which counts about its mean: where angles are counted from must not matter.
  [[nodiscard]] auto ridge_about_means(const Eigen::MatrixXd& gram) const -> Eigen::VectorXd;
  /// Of the parts from `first` to before `end`.
  [[nodiscard]] auto sum(Eigen::Index first, Eigen::Index end) const -> Eigen::MatrixXd;
  /// To the rows of these products.
  [[nodiscard]] auto solved(Eigen::MatrixXd gram) const -> Eigen::VectorXd;
  /// To the first `parts`.
  [[nodiscard]] auto fit(Eigen::Index parts) const -> Eigen::VectorXd;
};

}  // namespace capstan::tools
