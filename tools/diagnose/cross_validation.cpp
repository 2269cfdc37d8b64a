// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/cross_validation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace capstan::tools {
namespace {

constexpr std::size_t kFolds = 5;

auto without_fold(const BlockList& blocks, std::size_t fold) -> BlockList {
  BlockList others;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (i % kFolds != fold) {
      others.push_back(blocks[i]);
    }
  }
  return others;
}

/// Least squares of the last of the gram's columns on the others; those from `first_penalised` on pay a ridge relative
/// to their `sizes`.
auto ridge_solution(const Eigen::MatrixXd& gram, const Eigen::VectorXd& sizes, Eigen::Index first_penalised,
                    double ridge) -> Eigen::VectorXd {
  const Eigen::Index n = gram.cols() - 1;
  const Eigen::VectorXd scale = sizes.head(n).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * gram.topLeftCorner(n, n) * scale.asDiagonal();
  scaled.diagonal().array() += 1e-12;
  scaled.diagonal().tail(n - first_penalised).array() += ridge;
  return scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(gram.col(n).head(n))));
}

}  // namespace

auto law_model(const Layout& layout) -> ColumnModel {
  ColumnModel model;
  model.free.resize(static_cast<std::size_t>(layout.law));
  std::iota(model.free.begin(), model.free.end(), Eigen::Index{0});
  model.signs.assign(model.free.size(), Sign::kAny);
  return model;
}

auto model_of(const Layout& layout, const Candidate& candidate, std::size_t variant) -> ColumnModel {
  ColumnModel model = law_model(layout);
  const Eigen::Index first = candidate.variants[variant].first;
  if (candidate.acts_on_output) {
    model.fixed = first;
    std::iota(model.free.begin(), model.free.end(), first + 1);
    return model;
  }
  for (std::size_t i = 0; i < candidate.signs.size(); ++i) {
    model.free.push_back(first + static_cast<Eigen::Index>(i));
    model.signs.push_back(candidate.signs[i]);
  }
  return model;
}

auto fit_model(const BlockGrams& grams, const BlockList& blocks, const ColumnModel& model) -> FittedModel {
  FittedModel fitted{model.free, {}};
  ColumnList all = model.free;
  all.push_back(grams.layout().error());
  const auto n = static_cast<Eigen::Index>(model.free.size());
  if (model.fixed >= 0) {
    all.push_back(model.fixed);
  }
  const Eigen::MatrixXd gram = grams.sum(blocks, all);
  Eigen::VectorXd rhs = gram.col(n).head(n);
  if (model.fixed >= 0) {
    rhs -= gram.col(n + 1).head(n);
    fitted.columns.push_back(model.fixed);
  }
  fitted.theta = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(fitted.columns.size()));
  fitted.theta.head(n) = solve_signed(gram.topLeftCorner(n, n), rhs, model.signs);
  return fitted;
}

auto block_energies(const BlockGrams& grams, const BlockList& blocks, const FittedModel& model) -> Eigen::VectorXd {
  Eigen::VectorXd energies(static_cast<Eigen::Index>(blocks.size()));
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    energies[static_cast<Eigen::Index>(i)] = grams.energy(blocks[i], model.columns, model.theta);
  }
  return energies;
}

auto cross_validated(const BlockGrams& grams, const BlockList& blocks, const ColumnModel& model) -> Eigen::VectorXd {
  Eigen::VectorXd energies(static_cast<Eigen::Index>(blocks.size()));
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    const FittedModel fitted = fit_model(grams, without_fold(blocks, fold), model);
    for (std::size_t i = fold; i < blocks.size(); i += kFolds) {
      energies[static_cast<Eigen::Index>(i)] = grams.energy(blocks[i], fitted.columns, fitted.theta);
    }
  }
  return energies;
}

auto flexible_model(const BlockGrams& grams, const BlockList& blocks) -> Eigen::VectorXd {
  constexpr std::array<double, 4> kRidges = {1e-6, 1e-4, 1e-2, 1.0};
  ColumnList columns = law_model(grams.layout()).free;
  const auto first_penalised = static_cast<Eigen::Index>(columns.size());
  for (Eigen::Index i = grams.layout().first_variant(); i < grams.layout().total; ++i) {
    columns.push_back(i);
  }
  ColumnList with_error = columns;
  with_error.push_back(grams.layout().error());
  const Eigen::MatrixXd all = grams.sum(blocks, with_error);
  Eigen::MatrixXd energies(static_cast<Eigen::Index>(blocks.size()), static_cast<Eigen::Index>(kRidges.size()));
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    BlockList held_out;
    for (std::size_t i = fold; i < blocks.size(); i += kFolds) {
      held_out.push_back(blocks[i]);
    }
    const Eigen::MatrixXd gram = all - grams.sum(held_out, with_error);
    for (std::size_t r = 0; r < kRidges.size(); ++r) {
      // Sizes are those on all rows: what the others hardly show of a place is not judged by them.
      const Eigen::VectorXd theta = ridge_solution(gram, all.diagonal(), first_penalised, kRidges[r]);
      for (std::size_t i = fold; i < blocks.size(); i += kFolds) {
        energies(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(r)) = grams.energy(blocks[i], columns, theta);
      }
    }
  }
  Eigen::Index best = 0;
  energies.colwise().sum().minCoeff(&best);
  return energies.col(best);
}

auto t_statistic(const Eigen::VectorXd& values) -> double {
  const auto n = static_cast<double>(values.size());
  const double mean = values.mean();
  const double variance = (values.array() - mean).square().sum() / std::max(1.0, n - 1.0);
  return variance > 0.0 ? mean / std::sqrt(variance / n) : 0.0;
}

auto signed_rank_score(const Eigen::VectorXd& values) -> double {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  double positive = 0.0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    positive += sorted[i] > 0.0 ? static_cast<double>(i + 1) : 0.0;
  }
  const auto n = static_cast<double>(sorted.size());
  const double mean = n * (n + 1.0) / 4.0;
  return (positive - mean) / std::sqrt(n * (n + 1.0) * (2.0 * n + 1.0) / 24.0);
}

}  // namespace capstan::tools
