// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnose/cross_validation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace capstan::tools {
namespace {

constexpr std::size_t kFolds = 5;

/// Least squares of the last of the gram's columns on the others; those from `first_penalised` on pay a ridge relative to their
/// own size.
auto ridge_solution(const Eigen::MatrixXd& gram, Eigen::Index first_penalised, double ridge) -> Eigen::VectorXd {
  const Eigen::Index n = gram.cols() - 1;
  const Eigen::VectorXd scale = gram.diagonal().head(n).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * gram.topLeftCorner(n, n) * scale.asDiagonal();
  scaled.diagonal().array() += 1e-12;
  scaled.diagonal().tail(n - first_penalised).array() += ridge;
  return scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(gram.col(n).head(n))));
}

auto out_of_fold(const BlockGrams& grams, const std::vector<std::size_t>& blocks, const ColumnList& columns,
                 Eigen::Index first_penalised, double ridge) -> Eigen::VectorXd {
  ColumnList with_error = columns;
  with_error.push_back(grams.layout().error());
  Eigen::VectorXd energies(static_cast<Eigen::Index>(blocks.size()));
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (i % kFolds != fold) {
        others.push_back(blocks[i]);
      }
    }
    const ColumnModel model{columns, ridge_solution(grams.sum(others, with_error), first_penalised, ridge)};
    for (std::size_t i = fold; i < blocks.size(); i += kFolds) {
      energies[static_cast<Eigen::Index>(i)] = grams.energy(blocks[i], model.columns, model.theta);
    }
  }
  return energies;
}

}  // namespace

auto law_columns_of(const Layout& layout) -> ColumnList {
  ColumnList columns(static_cast<std::size_t>(layout.law));
  std::iota(columns.begin(), columns.end(), Eigen::Index{0});
  return columns;
}

auto columns_of(const Family& family, std::size_t variant) -> ColumnList {
  ColumnList columns(family.signs.size());
  std::iota(columns.begin(), columns.end(), family.variants[variant].first);
  return columns;
}

auto beside_law(const BlockGrams& grams, const std::vector<std::size_t>& blocks, const Family& family, const FamilyFit& fit)
    -> ColumnModel {
  const ColumnList law = law_columns_of(grams.layout());
  const ColumnList own = columns_of(family, fit.variant);
  ColumnList all = law;
  all.insert(all.end(), own.begin(), own.end());
  ColumnList with_error = all;
  with_error.push_back(grams.layout().error());
  const Eigen::MatrixXd gram = grams.sum(blocks, with_error);
  const auto k = static_cast<Eigen::Index>(law.size());
  const auto n = static_cast<Eigen::Index>(own.size());
  Eigen::MatrixXd reduced(k + 1, k + 1);
  reduced.topLeftCorner(k, k) = gram.topLeftCorner(k, k);
  reduced.col(k).head(k) = gram.col(k + n).head(k) - gram.block(0, k, k, n) * fit.theta;
  reduced(k, k) = 1.0;
  ColumnModel model{all, Eigen::VectorXd(k + n)};
  model.theta << ridge_solution(reduced, k, 0.0), fit.theta;
  return model;
}

auto block_energies(const BlockGrams& grams, const std::vector<std::size_t>& blocks, const ColumnModel& model) -> Eigen::VectorXd {
  Eigen::VectorXd energies(static_cast<Eigen::Index>(blocks.size()));
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    energies[static_cast<Eigen::Index>(i)] = grams.energy(blocks[i], model.columns, model.theta);
  }
  return energies;
}

auto cross_validated(const BlockGrams& grams, const std::vector<std::size_t>& blocks, const ColumnList& extra) -> Eigen::VectorXd {
  ColumnList columns = law_columns_of(grams.layout());
  columns.insert(columns.end(), extra.begin(), extra.end());
  return out_of_fold(grams, blocks, columns, static_cast<Eigen::Index>(columns.size()), 0.0);
}

auto flexible_ceiling(const BlockGrams& grams, const std::vector<std::size_t>& blocks, const ColumnList& own) -> Eigen::VectorXd {
  ColumnList columns = law_columns_of(grams.layout());
  columns.insert(columns.end(), own.begin(), own.end());
  const auto first_penalised = static_cast<Eigen::Index>(columns.size());
  for (Eigen::Index i = grams.layout().first_variant(); i < grams.layout().total; ++i) {
    if (std::find(own.begin(), own.end(), i) == own.end()) {
      columns.push_back(i);
    }
  }
  Eigen::VectorXd best;
  for (const double ridge : {1e-6, 1e-4, 1e-2, 1.0}) {
    Eigen::VectorXd energies = out_of_fold(grams, blocks, columns, first_penalised, ridge);
    if (best.size() == 0 || energies.sum() < best.sum()) {
      best = std::move(energies);
    }
  }
  return best;
}

auto t_statistic(const Eigen::VectorXd& values) -> double {
  const auto n = static_cast<double>(values.size());
  const double mean = values.mean();
  const double variance = (values.array() - mean).square().sum() / std::max(1.0, n - 1.0);
  return variance > 0.0 ? mean / std::sqrt(variance / n) : 0.0;
}

}  // namespace capstan::tools
