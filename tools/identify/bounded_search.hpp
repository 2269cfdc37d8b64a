// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

namespace capstan::tools {

/// What a model that is not linear in its parameters leaves of a target.
class NonlinearResidual {
 public:
  NonlinearResidual() = default;
  NonlinearResidual(const NonlinearResidual&) = delete;
  auto operator=(const NonlinearResidual&) -> NonlinearResidual& = delete;
  virtual ~NonlinearResidual() = default;

  /// As many numbers for any parameters.
  virtual auto at(const Eigen::VectorXd& parameters) -> Eigen::VectorXd = 0;
  /// Derivatives, a column per parameter, where at() was last asked for.
  virtual auto jacobian() -> Eigen::MatrixXd = 0;
};

struct SearchBounds {
  Eigen::VectorXd lower, upper;
};

struct SearchResult {
  Eigen::VectorXd parameters;
  double squares = 0.0;  ///< sum of the squared residuals
};

/// The parameters within bounds that leave least, found from a start by Ceres' trust region after Levenberg and
/// Marquardt. Parameters are best of order one. A start at which the residual is no number is given back.
auto least_squares_within(const SearchBounds& bounds, const Eigen::VectorXd& start, NonlinearResidual& residual)
    -> SearchResult;

}  // namespace capstan::tools
