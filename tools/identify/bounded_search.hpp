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

/// The same with derivatives by small steps.
class SteppedResidual : public NonlinearResidual {
 public:
  auto at(const Eigen::VectorXd& parameters) -> Eigen::VectorXd override {
    here_ = parameters;
    left_ = left_of(parameters);
    return left_;
  }
  auto jacobian() -> Eigen::MatrixXd override {
    constexpr double kStep = 1e-4;  // of parameters of order one
    Eigen::MatrixXd slopes(left_.size(), here_.size());
    for (Eigen::Index i = 0; i < here_.size(); ++i) {
      Eigen::VectorXd moved = here_;
      moved[i] += kStep;
      slopes.col(i) = (left_of(moved) - left_) / kStep;
    }
    return slopes;
  }

 private:
  virtual auto left_of(const Eigen::VectorXd& parameters) -> Eigen::VectorXd = 0;

  Eigen::VectorXd here_, left_;
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
