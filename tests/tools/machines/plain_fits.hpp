// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools::machines {

/// A plain least-squares fit of a joint angle: fitted to the first rows, it estimates all.
struct PlainFit {
  std::string name;
  std::function<Eigen::VectorXd(Eigen::Index fitted_rows)> estimate;
};

/// Affine; with one play operator of the best of 49 widths, alone, beside q1, and as a cubic; Prandtl-Ishlinskii with
/// 14 plays, whose weights are not negative, and free with a cubic of q1; each kind with torque or other joints where
/// there are any. What anybody would try first. The log outlives them.
auto plain_angle_fits(const AxisLog& log) -> std::vector<PlainFit>;

}  // namespace capstan::tools::machines
