// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/bounded_search.hpp"

#include <ceres/ceres.h>

#include <cmath>
#include <limits>

namespace capstan::tools {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The residual as Ceres asks for it: scaled to one at the start, because some of Ceres' limits are absolute, and kept
/// for the last parameters, because it asks for those of an accepted step twice.
class Cost final : public ceres::CostFunction {
 public:
  Cost(const SearchBounds& bounds, const Eigen::VectorXd& start, NonlinearResidual& residual)
      : bounds_(bounds), residual_(residual), at_(start), left_(residual.at(start)), scale_(1.0 / left_.norm()) {
    set_num_residuals(static_cast<int>(left_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(start.size()));
  }
  [[nodiscard]] auto scale() const -> double { return scale_; }
  [[nodiscard]] auto squares() const -> double { return left_.squaredNorm(); }

  auto Evaluate(double const* const* parameters, double* residuals, double** jacobians) const -> bool override {
    const Eigen::VectorXd here = Eigen::Map<const Eigen::VectorXd>(parameters[0], at_.size());
    if (here != at_) {
      at_ = here;
      left_ = residual_.at(here);
    }
    Eigen::Map<Eigen::VectorXd>(residuals, left_.size()) = scale_ * left_;
    bool finite = left_.allFinite();
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<RowMajor> jacobian(jacobians[0], left_.size(), at_.size());
      jacobian = scale_ * free_jacobian();
      finite = finite && jacobian.allFinite();
    }
    return finite;
  }

 private:
  /// Parameters that a bound holds back have no part in the next step: cut off after it, they would have misled the
  /// others (Bertsekas 1982).
  auto free_jacobian() const -> Eigen::MatrixXd {
    Eigen::MatrixXd jacobian = residual_.jacobian();
    const Eigen::VectorXd slope = jacobian.transpose() * left_;
    for (Eigen::Index i = 0; i < at_.size(); ++i) {
      if ((at_[i] <= bounds_.lower[i] && slope[i] > 0.0) || (at_[i] >= bounds_.upper[i] && slope[i] < 0.0)) {
        jacobian.col(i).setZero();
      }
    }
    return jacobian;
  }

  const SearchBounds& bounds_;
  NonlinearResidual& residual_;
  mutable Eigen::VectorXd at_, left_;
  double scale_;
};

auto settings() -> ceres::Solver::Options {
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 40;
  options.max_num_line_search_step_size_iterations = 0;  // a step that a bound cuts off is made shorter until it helps
  options.function_tolerance = 1e-9;
  return options;
}

}  // namespace

auto least_squares_within(const SearchBounds& bounds, const Eigen::VectorXd& start, NonlinearResidual& residual)
    -> SearchResult {
  const Eigen::VectorXd inside = start.cwiseMax(bounds.lower).cwiseMin(bounds.upper);
  Cost cost(bounds, inside, residual);
  if (!std::isfinite(cost.scale())) {  // nothing is left, or it is no number
    return {inside, cost.squares()};
  }
  Eigen::VectorXd parameters = inside;
  ceres::Problem::Options ours;
  ours.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ours);
  problem.AddResidualBlock(&cost, nullptr, parameters.data());
  for (int i = 0; i < static_cast<int>(parameters.size()); ++i) {
    problem.SetParameterLowerBound(parameters.data(), i, bounds.lower[i]);
    problem.SetParameterUpperBound(parameters.data(), i, bounds.upper[i]);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(settings(), &problem, &summary);
  return {parameters, 2.0 * summary.final_cost / (cost.scale() * cost.scale())};
}

}  // namespace capstan::tools
