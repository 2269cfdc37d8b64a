// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

#include "capstan/tools/identify/least_squares.hpp"

namespace capstan::tools {

inline constexpr Eigen::Index kLoadBlocks = 24;  ///< that rows of torque are resampled by

auto fitted(const Eigen::MatrixXd& columns, const Eigen::VectorXd& torque) -> LinearFit;
/// A constant torque beside it counts for nothing: sensors of current have one.
auto with_offset(const Eigen::MatrixXd& columns) -> Eigen::MatrixXd;

/// What a load is told by.
struct LoadRows {
  Eigen::VectorXd regressor, sense, change;
  bool other_friction = false;  ///< the friction may have changed, too
  /// What the load may hang on beside its regressor, by a share that is not known: of a weight, which need not hang
  /// straight where the joint is at 0, the cosine. Empty: nothing.
  Eigen::VectorXd lean = {};
};

/// A load and the half width of its interval, per regressor, at the motor.
struct LoadAnswer {
  double load = 0.0, half_95 = 0.0;
};

/// The load that explains a change of torque as tendons carry it.
/// @param friction  of the healthy joint, Nm   @param start  the load, were all of it to come through one to one
auto told_load(LoadRows of, double friction, double start) -> LoadAnswer;

}  // namespace capstan::tools
