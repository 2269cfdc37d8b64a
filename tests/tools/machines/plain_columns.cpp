// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/machines/plain_columns.hpp"

#include <cmath>
#include <limits>

namespace capstan::tools::machines {

auto geometric(double low, double high, int count) -> std::vector<double> {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    values.push_back(low * std::pow(high / low, static_cast<double>(i) / (count - 1)));
  }
  return values;
}

auto side_by_side(const Columns& columns) -> Eigen::MatrixXd {
  Eigen::MatrixXd all(columns.front().size(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    all.col(static_cast<Eigen::Index>(i)) = columns[i];
  }
  return all;
}

auto rms_of(const Eigen::VectorXd& error, Eigen::Index rows) -> double {
  return std::sqrt(error.head(rows).squaredNorm() / static_cast<double>(rows));
}

auto fitted(const Columns& columns, const Eigen::VectorXd& y, Eigen::Index rows) -> Eigen::VectorXd {
  const Eigen::MatrixXd all = side_by_side(columns);
  const Eigen::VectorXd scale =
      all.topRows(rows).cwiseAbs().colwise().maxCoeff().transpose().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd scaled = all * scale.asDiagonal();
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors;
  factors.setThreshold(1e-10);
  return scaled * factors.compute(scaled.topRows(rows)).solve(y.head(rows));
}

auto best_of(const std::vector<Columns>& all, const Eigen::VectorXd& y, Eigen::Index rows) -> Eigen::VectorXd {
  Eigen::VectorXd best;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& columns : all) {
    Eigen::VectorXd estimate = fitted(columns, y, rows);
    if (const double left = rms_of(y - estimate, rows); left < least) {
      least = left;
      best = std::move(estimate);
    }
  }
  return best;
}

}  // namespace capstan::tools::machines
