// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/tools/diagnose/evidence.hpp"

namespace capstan::tools {

using ColumnList = std::vector<Eigen::Index>;
using BlockList = std::vector<std::size_t>;

/// A model of the error by columns of the layout: free ones with signs, and perhaps one whose factor is 1.
struct ColumnModel {
  ColumnList free;
  std::vector<Sign> signs;
  Eigen::Index fixed = -1;  ///< -1: none
};

/// The law alone.
auto law_model(const Layout& layout) -> ColumnModel;
/// The law refitted beside a candidate's variant. For an output term's exact variant, the law through the term.
auto model_of(const Layout& layout, const Candidate& candidate, std::size_t variant) -> ColumnModel;

/// A model's columns with their coefficients, the fixed one included.
struct FittedModel {
  ColumnList columns;
  Eigen::VectorXd theta;
};
auto fit_model(const BlockGrams& grams, const BlockList& blocks, const ColumnModel& model) -> FittedModel;

/// Residual energy of a fitted model in each of some blocks.
auto block_energies(const BlockGrams& grams, const BlockList& blocks, const FittedModel& model) -> Eigen::VectorXd;

/// Out-of-fold residual energy per block: the model refitted without the block's fold.
auto cross_validated(const BlockGrams& grams, const BlockList& blocks, const ColumnModel& model) -> Eigen::VectorXd;

/// The flexible model: the law, and everything else there is by ridge regression, its strength chosen by the same
/// cross-validation. Energy per block, out of fold.
auto flexible_model(const BlockGrams& grams, const BlockList& blocks) -> Eigen::VectorXd;

/// Student's t of the mean.
auto t_statistic(const Eigen::VectorXd& values) -> double;
/// Normal score of Wilcoxon's signed-rank test that the values tend to be positive: the same question, asked so that a
/// few blocks with much motion do not decide alone.
auto signed_rank_score(const Eigen::VectorXd& values) -> double;

}  // namespace capstan::tools
