// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools::machines {

/// A plain least-squares fit of a log's target: fitted to the first rows, it estimates all.
struct PlainFit {
  std::string name;
  std::function<Eigen::VectorXd(Eigen::Index fitted_rows)> estimate;
};

/// Affine; with one play operator of the best of 49 widths, alone, beside q1, and as a cubic; Prandtl-Ishlinskii with
/// 14 plays, whose weights are not negative, and free with a cubic of q1; each kind with torque or other joints where
/// there are any. What anybody would try first. The log outlives them.
auto plain_angle_fits(const AxisLog& log) -> std::vector<PlainFit>;

/// Of an effort, seen through a cubic of 0.12 s as its motion is: inertia and drag; Coulomb friction and offset beside
/// them, alone and with asymmetry, gravity, a spring, a power of the speed, gravity and a power, or a play's friction.
auto plain_effort_fits(const AxisLog& log) -> std::vector<PlainFit>;

/// Of a torque behind a gear: gain and offset; the motor's torque up to three samples late or early; Coulomb friction,
/// friction with the load and saturation beside that.
auto plain_gear_fits(const AxisLog& log) -> std::vector<PlainFit>;

}  // namespace capstan::tools::machines
