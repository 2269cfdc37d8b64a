// SPDX-License-Identifier: Apache-2.0
#include "tools/identify/least_squares.hpp"

#include <algorithm>
#include <cmath>

#include "tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// Solves for the chosen columns, the others 0. Columns are scaled to unit norm first; those that add nothing stay 0.
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
  const Eigen::VectorXd solution = scaled.completeOrthogonalDecomposition().solve(scale.cwiseProduct(rhs(index)));
  theta(index) = scale.cwiseProduct(solution);
  return theta;
}

auto violates(double value, Sign sign) -> bool {
  return (sign == Sign::kNonNegative && value < 0.0) || (sign == Sign::kNonPositive && value > 0.0);
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
  Eigen::VectorXd theta = solve_subset(gram, rhs, chosen);
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
    for (Eigen::VectorXd next = solve_subset(gram, rhs, chosen);; next = solve_subset(gram, rhs, chosen)) {
      bool dropped = false;
      for (std::size_t i = 0; i < n; ++i) {
        if (chosen[i] && violates(next[static_cast<Eigen::Index>(i)], signs[i])) {
          chosen[i] = false;
          dropped = true;
        }
      }
      if (!dropped) {
        theta = next;
        break;
      }
    }
    if (!chosen[best]) {
      break;  // it was freed and fell back at once: at the optimum up to rounding
    }
  }
  return theta;
}

namespace {

struct NormalEquations {
  Eigen::MatrixXd gram;
  Eigen::VectorXd rhs;
};

auto normal_equations(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, const Blocks& blocks)
    -> NormalEquations {
  const Eigen::Index n = columns.cols();
  NormalEquations normal{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (const auto& block : blocks) {
    const auto x = columns.middleRows(block.begin, block.size());
    normal.gram.noalias() += x.transpose() * x;
    normal.rhs.noalias() += x.transpose() * target.segment(block.begin, block.size());
  }
  return normal;
}

/// Inverse of some rows and columns of a gram, columns scaled to unit norm; `scale` gets the scaling. A singular system
/// stays finite, and its diagonal then is huge.
auto scaled_inverse(const Eigen::MatrixXd& gram, const std::vector<Eigen::Index>& chosen, Eigen::VectorXd& scale)
    -> Eigen::MatrixXd {
  const auto k = static_cast<Eigen::Index>(chosen.size());
  scale = gram.diagonal()(chosen).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * gram(chosen, chosen) * scale.asDiagonal();
  scaled.diagonal().array() += 1e-13;
  return scaled.ldlt().solve(Eigen::MatrixXd::Identity(k, k));
}

/// Fills in what the spread of the blocks' scores says about the columns that are free of their bounds, and how far
/// each column can be told from all others.
void judge_coefficients(const Eigen::MatrixXd& gram, const Eigen::MatrixXd& meat, LinearFit& fit) {
  std::vector<Eigen::Index> present;
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < gram.cols(); ++i) {
    if (gram(i, i) > 0.0) {
      present.push_back(i);
      if (!fit.at_bound[static_cast<std::size_t>(i)]) {
        free.push_back(i);
      }
    }
  }
  Eigen::VectorXd scale;
  fit.tolerance(present) = scaled_inverse(gram, present, scale).diagonal().cwiseInverse();
  const Eigen::MatrixXd unscaled = scaled_inverse(gram, free, scale);
  const Eigen::MatrixXd inverse = scale.asDiagonal() * unscaled * scale.asDiagonal();
  fit.covariance(free, free) = inverse * meat(free, free) * inverse;
}

}  // namespace

auto fit_columns(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, const Blocks& blocks,
                 const std::vector<Sign>& signs) -> LinearFit {
  const Eigen::Index n = columns.cols();
  const auto [gram, rhs] = normal_equations(columns, target, blocks);
  LinearFit fit;
  fit.theta = solve_signed(gram, rhs, signs);
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(n, n);
  double squares = 0.0;
  for (const auto& block : blocks) {
    const auto x = columns.middleRows(block.begin, block.size());
    const Eigen::VectorXd residual = target.segment(block.begin, block.size()) - x * fit.theta;
    const Eigen::VectorXd score = x.transpose() * residual;
    meat.noalias() += score * score.transpose();
    squares += residual.squaredNorm();
  }
  double free = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    fit.at_bound.push_back(signs[static_cast<std::size_t>(i)] != Sign::kAny && fit.theta[i] == 0.0);
    free += fit.at_bound.back() ? 0.0 : 1.0;
  }
  const auto count = static_cast<double>(blocks.size());
  fit.covariance = Eigen::MatrixXd::Zero(n, n);
  fit.tolerance = Eigen::VectorXd::Zero(n);
  judge_coefficients(gram, meat * (count / std::max(1.0, count - 1.0)), fit);
  fit.rmse = std::sqrt(squares / static_cast<double>(std::max<Eigen::Index>(1, rows_in(blocks))));
  fit.degrees_of_freedom = std::max(1.0, count - 1.0 - 0.5 * free);
  return fit;
}

auto half_interval(const LinearFit& fit, Eigen::Index i) -> double {
  return student_t95(fit.degrees_of_freedom) * std::sqrt(std::max(0.0, fit.covariance(i, i)));
}

auto even_blocks(const std::vector<Eigen::Index>& log_rows, Eigen::Index count) -> Blocks {
  Eigen::Index total = 0;
  for (const Eigen::Index rows : log_rows) {
    total += rows;
  }
  Blocks blocks;
  Eigen::Index begin = 0;
  for (const Eigen::Index rows : log_rows) {
    const Eigen::Index here = std::max<Eigen::Index>(1, (count * rows + total / 2) / total);
    for (Eigen::Index i = 0; i < here; ++i) {
      blocks.push_back({begin + rows * i / here, begin + rows * (i + 1) / here});
    }
    begin += rows;
  }
  return blocks;
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
