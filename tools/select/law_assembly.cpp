// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/law_assembly.hpp"

#include <algorithm>

namespace capstan::tools {

auto ordered_in_parts(const SelectionData& data, const Blocks& allowed) -> RowOrder {
  std::vector<std::vector<Eigen::Index>> of_log(data.settled().size());
  for (std::size_t log = 0; log < of_log.size(); ++log) {
    const RowRange& settled = data.settled()[log];
    for (const auto& block : allowed) {
      for (Eigen::Index row = std::max(block.begin, settled.begin); row < std::min(block.end, settled.end); ++row) {
        of_log[log].push_back(row);
      }
    }
  }
  RowOrder order;
  const Eigen::Index parts = data.numbers().parts;
  for (Eigen::Index part = 0; part < parts; ++part) {
    const auto begin = static_cast<Eigen::Index>(order.rows.size());
    for (std::size_t log = 0; log < of_log.size(); ++log) {
      const auto count = static_cast<Eigen::Index>(of_log[log].size());
      for (Eigen::Index i = count * part / parts; i < count * (part + 1) / parts; ++i) {
        order.rows.push_back(of_log[log][static_cast<std::size_t>(i)]);
      }
    }
    order.parts.push_back({begin, static_cast<Eigen::Index>(order.rows.size())});
  }
  return order;
}

auto solve_ridge(const Eigen::MatrixXd& gram, const std::vector<Sign>& signs, const Eigen::VectorXd& ridge)
    -> Eigen::VectorXd {
  const Eigen::Index n = gram.cols() - 1;
  Eigen::VectorXd scale = gram.diagonal().head(n).cwiseSqrt();
  scale = scale.unaryExpr([](double x) { return x > 0.0 ? 1.0 / x : 0.0; });
  Eigen::MatrixXd scaled = scale.asDiagonal() * gram.topLeftCorner(n, n) * scale.asDiagonal();
  scaled.diagonal() += ridge;
  const Eigen::VectorXd rhs = scale.cwiseProduct(gram.col(n).head(n));
  Eigen::VectorXd theta = scaled.ldlt().solve(rhs);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!has_sign(theta[i], signs[static_cast<std::size_t>(i)])) {
      theta = solve_signed(scaled, rhs, signs);
      break;
    }
  }
  return theta.cwiseProduct(scale);
}

auto energy_left(const Eigen::MatrixXd& gram, const Eigen::VectorXd& theta) -> double {
  const Eigen::Index n = theta.size();
  const Eigen::VectorXd rhs = gram.col(n).head(n);
  return std::max(0.0, gram(n, n) - 2.0 * theta.dot(rhs) + theta.dot(gram.topLeftCorner(n, n) * theta));
}

auto LawAssembly::are_apart(Eigen::Index a, Eigen::Index b) const -> bool {
  const auto line_of = [this](Eigen::Index column) {
    return std::find_if(lines.begin(), lines.end(),
                        [column](const auto& line) { return column >= line.begin && column < line.end; });
  };
  const auto one = line_of(a);
  const auto other = line_of(b);
  const bool both = one != lines.end() && other != lines.end();
  return both && (one != other || std::abs(a - b) > 1);
}

auto LawAssembly::sum(Eigen::Index first, Eigen::Index end) const -> Eigen::MatrixXd {
  Eigen::MatrixXd all = grams[static_cast<std::size_t>(first)];
  for (Eigen::Index part = first + 1; part < end; ++part) {
    all += grams[static_cast<std::size_t>(part)];
  }
  return all;
}

auto LawAssembly::ridge_about_means(const Eigen::MatrixXd& gram) const -> Eigen::VectorXd {
  constexpr double kLeastShare = 1e-4;  // of a column that hardly varies, rounding alone would be left
  Eigen::VectorXd about_means = ridge;
  for (Eigen::Index i = 0; i < ridge.size(); ++i) {
    double of_mean = 0.0;
    for (const Eigen::Index offset : offsets) {
      const double energy = gram(i, i) * gram(offset, offset);
      of_mean += energy > 0.0 ? gram(i, offset) * gram(i, offset) / energy : 0.0;
    }
    about_means[i] *= std::max(kLeastShare, 1.0 - of_mean);
  }
  return about_means;
}

auto LawAssembly::solved(Eigen::MatrixXd gram) const -> Eigen::VectorXd {
  const Eigen::VectorXd about_means = ridge_about_means(gram);
  for (const auto& line : lines) {
    const double weight =
        smoothness * gram.diagonal().segment(line.begin, line.size()).mean();  // steps cost as rows of this energy do
    for (Eigen::Index i = line.begin; i + 1 < line.end; ++i) {
      gram(i, i) += weight;
      gram(i + 1, i + 1) += weight;
      gram(i, i + 1) -= weight;
      gram(i + 1, i) -= weight;
    }
  }
  return solve_ridge(gram, signs, about_means);
}

auto LawAssembly::fit(Eigen::Index parts) const -> Eigen::VectorXd {
  return solved(sum(0, parts));
}

}  // namespace capstan::tools
