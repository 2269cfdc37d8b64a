// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/least_squares.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// Of a column's energy: with less than this of its own it is a copy of others, and shares their coefficient.
constexpr double kCopy = 1e-9;

/// Solves for the chosen columns, the others 0. Columns are scaled to unit norm first; those that add nothing stay 0,
/// and of solutions that do equally well the smallest is taken.
auto solve_subset(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs, const std::vector<bool>& chosen)
    -> Eigen::VectorXd {
  std::vector<Eigen::Index> index;
  for (Eigen::Index i = 0; i < rhs.size(); ++i) {
    if (chosen[static_cast<std::size_t>(i)] && gram(i, i) > 0.0) {
      index.push_back(i);
    }
  }
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(rhs.size());
  if (index.empty()) {
    return theta;
  }
  const Eigen::VectorXd scale = gram.diagonal()(index).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * gram(index, index) * scale.asDiagonal();
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors;
  factors.setThreshold(kCopy);
  const Eigen::VectorXd solution = factors.compute(scaled).solve(scale.cwiseProduct(rhs(index)));
  theta(index) = scale.cwiseProduct(solution);
  return theta;
}

auto violates(double value, Sign sign) -> bool {
  return (sign == Sign::kNonNegative && value < 0.0) || (sign == Sign::kNonPositive && value > 0.0);
}

/// With more columns than this they are not freed one by one from none: block pivoting says which to begin with.
constexpr Eigen::Index kMany = 150;

/// Which columns stand free of their bounds, nearly: all that would go the wrong way change sides at once, as long as
/// fewer and fewer do (Kim and Park 2011).
auto pivoted_start(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs, const std::vector<Sign>& signs)
    -> std::vector<bool> {
  constexpr double kRidge = 1e-9;
  constexpr int kMostRounds = 60;
  const auto n = static_cast<std::size_t>(rhs.size());
  std::vector<bool> chosen(n, true);
  for (std::size_t i = 0; i < n; ++i) {
    chosen[i] = gram(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) > 0.0;
  }
  for (int round = 0; round < kMostRounds; ++round) {
    std::vector<Eigen::Index> index;
    for (std::size_t i = 0; i < n; ++i) {
      if (chosen[i]) {
        index.push_back(static_cast<Eigen::Index>(i));
      }
    }
    const Eigen::VectorXd scale = gram.diagonal()(index).cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd scaled = scale.asDiagonal() * gram(index, index) * scale.asDiagonal();
    scaled.diagonal().array() += kRidge;
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(rhs.size());
    theta(index) = scale.cwiseProduct(scaled.llt().solve(scale.cwiseProduct(rhs(index))));
    const Eigen::VectorXd slope = rhs - gram * theta;
    bool changed = false;
    for (std::size_t i = 0; i < n; ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      if (chosen[i] ? violates(theta[at], signs[i])
                    : gram(at, at) > 0.0 && violates(-slope[at], signs[i]) && signs[i] != Sign::kAny) {
        chosen[i] = !chosen[i];
        changed = true;
      }
    }
    if (!changed) {
      break;
    }
  }
  return chosen;
}

/// Solves for the chosen columns, dropping those that would break their signs.
auto solve_keeping_signs(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs, const std::vector<Sign>& signs,
                         std::vector<bool>& chosen) -> Eigen::VectorXd {
  for (;;) {
    Eigen::VectorXd theta = solve_subset(gram, rhs, chosen);
    bool dropped = false;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (chosen[i] && violates(theta[static_cast<Eigen::Index>(i)], signs[i])) {
        chosen[i] = false;
        dropped = true;
      }
    }
    if (!dropped) {
      return theta;
    }
  }
}

}  // namespace

auto rows_in(const Blocks& blocks) -> Eigen::Index {
  Eigen::Index rows = 0;
  for (const auto& block : blocks) {
    rows += block.size();
  }
  return rows;
}

auto stacked(const Eigen::VectorXd& values, const Blocks& blocks) -> Eigen::VectorXd {
  Eigen::VectorXd result(rows_in(blocks));
  Eigen::Index row = 0;
  for (const auto& block : blocks) {
    result.segment(row, block.size()) = values.segment(block.begin, block.size());
    row += block.size();
  }
  return result;
}

auto solve_signed(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs, const std::vector<Sign>& signs)
    -> Eigen::VectorXd {
  const auto n = static_cast<std::size_t>(rhs.size());
  std::vector<bool> chosen(n);
  for (std::size_t i = 0; i < n; ++i) {
    chosen[i] = signs[i] == Sign::kAny;
  }
  if (rhs.size() > kMany) {
    chosen = pivoted_start(gram, rhs, signs);
  }
  Eigen::VectorXd theta = solve_keeping_signs(gram, rhs, signs, chosen);
  for (std::size_t round = 0; round < 3 * n + 3; ++round) {
    // Free the bounded column that most wants to leave zero in its allowed direction.
    const Eigen::VectorXd slope = rhs - gram * theta;
    std::size_t best = n;
    double best_gain = 1e-14;
    for (std::size_t i = 0; i < n; ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      const double wish = signs[i] == Sign::kNonPositive ? -slope[at] : slope[at];
      const double gain = gram(at, at) > 0.0 && wish > 0.0 ? wish * wish / gram(at, at) : 0.0;
      if (!chosen[i] && gain > best_gain * (1.0 + std::abs(rhs.dot(theta)))) {
        best = i;
        best_gain = gain;
      }
    }
    if (best == n) {
      break;
    }
    chosen[best] = true;
    theta = solve_keeping_signs(gram, rhs, signs, chosen);
    if (!chosen[best]) {
      break;  // it was freed and fell back at once: at the optimum up to rounding
    }
  }
  return theta;
}

namespace {

/// Scalar products of the columns with themselves and with the target, block by block.
struct NormalEquations {
  std::vector<Eigen::MatrixXd> grams;
  Eigen::MatrixXd gram;
  Eigen::VectorXd rhs;
};

auto normal_equations(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, const Blocks& blocks)
    -> NormalEquations {
  const Eigen::Index n = columns.cols();
  NormalEquations normal{{}, Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (const auto& block : blocks) {
    const auto x = columns.middleRows(block.begin, block.size());
    normal.grams.emplace_back(x.transpose() * x);
    normal.gram += normal.grams.back();
    normal.rhs.noalias() += x.transpose() * target.segment(block.begin, block.size());
  }
  return normal;
}

auto unit_scale(const Eigen::MatrixXd& gram, const std::vector<Eigen::Index>& chosen) -> Eigen::VectorXd {
  return gram.diagonal()(chosen).cwiseSqrt().cwiseInverse();
}

/// Some rows and columns of a gram, scaled. A singular one can still be inverted, and the inverse's diagonal then is
/// huge.
auto scaled_gram(const Eigen::MatrixXd& gram, const std::vector<Eigen::Index>& chosen, const Eigen::VectorXd& scale)
    -> Eigen::MatrixXd {
  Eigen::MatrixXd scaled = scale.asDiagonal() * gram(chosen, chosen) * scale.asDiagonal();
  scaled.diagonal().array() += 1e-13;
  return scaled;
}

/// 1 - R^2 of each column against the others.
auto tolerances(const Eigen::MatrixXd& gram) -> Eigen::VectorXd {
  std::vector<Eigen::Index> present;
  for (Eigen::Index i = 0; i < gram.cols(); ++i) {
    if (gram(i, i) > 0.0) {
      present.push_back(i);
    }
  }
  const auto count = static_cast<Eigen::Index>(present.size());
  const Eigen::MatrixXd scaled = scaled_gram(gram, present, unit_scale(gram, present));
  Eigen::VectorXd tolerance = Eigen::VectorXd::Zero(gram.cols());
  tolerance(present) = scaled.ldlt().solve(Eigen::MatrixXd::Identity(count, count)).diagonal().cwiseInverse();
  return tolerance;
}

/// Covariance of the coefficients that are free of their bounds, from the spread of the blocks' scores. A fit bends
/// towards each block by the share that this has in it, so a block's residual is too small by the root of the rest:
/// the scores are widened by that (Bell and McCaffrey 2002, CR2).
auto spread_of_scores(const NormalEquations& normal, const Eigen::MatrixXd& scores,
                      const std::vector<Eigen::Index>& free) -> Eigen::MatrixXd {
  constexpr double kLeastRest = 0.01;  // a block that decides a coefficient alone says nothing about its spread
  const Eigen::VectorXd scale = unit_scale(normal.gram, free);
  const Eigen::LLT<Eigen::MatrixXd> root(scaled_gram(normal.gram, free, scale));
  const auto count = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t i = 0; i < normal.grams.size(); ++i) {
    const Eigen::MatrixXd scaled = scale.asDiagonal() * normal.grams[i](free, free) * scale.asDiagonal();
    const Eigen::MatrixXd half = root.matrixL().solve(scaled);
    const Eigen::MatrixXd share = root.matrixL().solve(half.transpose());
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> rest(Eigen::MatrixXd::Identity(count, count) - share);
    const Eigen::VectorXd wider = rest.eigenvalues().cwiseMax(kLeastRest).cwiseSqrt().cwiseInverse();
    const Eigen::VectorXd own = scores.col(static_cast<Eigen::Index>(i))(free).cwiseProduct(scale);
    const Eigen::VectorXd white = root.matrixL().solve(own);
    const Eigen::VectorXd score = rest.eigenvectors() * wider.cwiseProduct(rest.eigenvectors().transpose() * white);
    meat.noalias() += score * score.transpose();
  }
  const Eigen::MatrixXd back = root.matrixU().solve(meat);
  const Eigen::MatrixXd covariance = root.matrixU().solve(back.transpose());
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

}  // namespace

auto fit_columns(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, const Blocks& blocks,
                 const std::vector<Sign>& signs) -> LinearFit {
  const Eigen::Index n = columns.cols();
  const NormalEquations normal = normal_equations(columns, target, blocks);
  LinearFit fit;
  fit.theta = solve_signed(normal.gram, normal.rhs, signs);
  Eigen::MatrixXd scores(n, static_cast<Eigen::Index>(blocks.size()));
  double squares = 0.0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const auto x = columns.middleRows(blocks[i].begin, blocks[i].size());
    const Eigen::VectorXd residual = target.segment(blocks[i].begin, blocks[i].size()) - x * fit.theta;
    scores.col(static_cast<Eigen::Index>(i)) = x.transpose() * residual;
    squares += residual.squaredNorm();
  }
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < n; ++i) {
    fit.at_bound.push_back(signs[static_cast<std::size_t>(i)] != Sign::kAny && fit.theta[i] == 0.0);
    if (!fit.at_bound.back() && normal.gram(i, i) > 0.0) {
      free.push_back(i);
    }
  }
  fit.covariance = Eigen::MatrixXd::Zero(n, n);
  if (!free.empty()) {
    fit.covariance(free, free) = spread_of_scores(normal, scores, free);
  }
  fit.tolerance = tolerances(normal.gram);
  fit.rmse = std::sqrt(squares / static_cast<double>(std::max<Eigen::Index>(1, rows_in(blocks))));
  fit.degrees_of_freedom =
      std::max(1.0, static_cast<double>(blocks.size()) - 1.0 - 0.5 * static_cast<double>(free.size()));
  return fit;
}

auto half_interval(const LinearFit& fit, Eigen::Index i) -> double {
  return student_t95(fit.degrees_of_freedom) * std::sqrt(std::max(0.0, fit.covariance(i, i)));
}

auto half_interval_of_sum(const LinearFit& fit, const Eigen::VectorXd& weights) -> double {
  return student_t95(fit.degrees_of_freedom) * std::sqrt(std::max(0.0, weights.dot(fit.covariance * weights)));
}

auto even_parts(const Blocks& pieces, Eigen::Index count) -> Blocks {
  const Eigen::Index total = rows_in(pieces);
  Blocks blocks;
  for (const auto& piece : pieces) {
    const Eigen::Index here = std::max<Eigen::Index>(1, (count * piece.size() + total / 2) / total);
    for (Eigen::Index i = 0; i < here; ++i) {
      blocks.push_back({piece.begin + piece.size() * i / here, piece.begin + piece.size() * (i + 1) / here});
    }
  }
  return blocks;
}

auto even_blocks(const std::vector<Eigen::Index>& log_rows, Eigen::Index count) -> Blocks {
  return even_parts(pieces_of(log_rows), count);
}

auto pieces_of(const std::vector<Eigen::Index>& log_rows) -> Blocks {
  Blocks pieces;
  Eigen::Index begin = 0;
  for (const Eigen::Index rows : log_rows) {
    pieces.push_back({begin, begin + rows});
    begin += rows;
  }
  return pieces;
}

auto unbroken(const Blocks& blocks) -> Blocks {
  Blocks pieces;
  for (const auto& block : blocks) {
    if (!pieces.empty() && pieces.back().end == block.begin) {
      pieces.back().end = block.end;
    } else {
      pieces.push_back(block);
    }
  }
  return pieces;
}

void project_out(const Eigen::MatrixXd& base, const Blocks& rows, Eigen::Ref<Eigen::MatrixXd> columns) {
  constexpr double kRidge = 1e-9;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(base.cols(), base.cols());
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(base.cols(), columns.cols());
  for (const auto& block : rows) {
    const auto x = base.middleRows(block.begin, block.size());
    gram.noalias() += x.transpose() * x;
    products.noalias() += x.transpose() * columns.middleRows(block.begin, block.size());
  }
  gram.diagonal().array() += kRidge * gram.trace();
  columns -= base * gram.ldlt().solve(products);
}

}  // namespace capstan::tools
