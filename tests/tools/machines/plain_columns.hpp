// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace capstan::tools::machines {

/// Columns of a plain fit, all rows of a log.
using Columns = std::vector<Eigen::VectorXd>;

/// From `low` to `high` in equal ratios.
auto geometric(double low, double high, int count) -> std::vector<double>;
auto side_by_side(const Columns& columns) -> Eigen::MatrixXd;

/// rms of the first rows.
auto rms_of(const Eigen::VectorXd& error, Eigen::Index rows) -> double;
/// All rows by least squares on the first ones.
auto fitted(const Columns& columns, const Eigen::VectorXd& y, Eigen::Index rows) -> Eigen::VectorXd;
/// By those of several sets of columns that leave least of the first rows.
auto best_of(const std::vector<Columns>& all, const Eigen::VectorXd& y, Eigen::Index rows) -> Eigen::VectorXd;

}  // namespace capstan::tools::machines
