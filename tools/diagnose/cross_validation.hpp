// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tools/diagnose/evidence.hpp"

namespace capstan::tools {

using ColumnList = std::vector<Eigen::Index>;

/// Columns with their coefficients: a law, perhaps with an effect beside it.
struct ColumnModel {
  ColumnList columns;
  Eigen::VectorXd theta;
};

/// The law's own columns in a layout.
auto law_columns_of(const Layout& layout) -> ColumnList;
/// Columns of a family's variant in the layout.
auto columns_of(const Family& family, std::size_t variant) -> ColumnList;

/// A family's fit with the law refitted beside it on the given blocks.
auto beside_law(const BlockGrams& grams, const std::vector<std::size_t>& blocks, const Family& family, const FamilyFit& fit)
    -> ColumnModel;

/// Residual energy of a model in each of some blocks.
auto block_energies(const BlockGrams& grams, const std::vector<std::size_t>& blocks, const ColumnModel& model) -> Eigen::VectorXd;

/// Out-of-fold residual energy per block: the law plus some columns, refitted without the block's fold.
/// `ridge` penalises the columns from index `law columns + free` on, relative to their size.
auto cross_validated(const BlockGrams& grams, const std::vector<std::size_t>& blocks, const ColumnList& extra) -> Eigen::VectorXd;

/// The flexible ceiling: the law, some columns of its own (unpenalised), and everything else there is (ridge, strength chosen by
/// the same cross-validation). Energy per block, out of fold.
auto flexible_ceiling(const BlockGrams& grams, const std::vector<std::size_t>& blocks, const ColumnList& own) -> Eigen::VectorXd;

/// Student's t of the mean.
auto t_statistic(const Eigen::VectorXd& values) -> double;

}  // namespace capstan::tools
