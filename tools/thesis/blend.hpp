// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <functional>

#include "capstan/hal/sim/parameters.hpp"

/// The blend (2.27) of chapter 2's two models of the joint's torque.
namespace capstan::tools {

/// A locked tip under a torque of the motor, every 10 ms.
struct TorqueRun {
  Eigen::VectorXd time_s, in_nm, out_nm;
};
auto torque_run(const sim::PlantParameters& plant, double seconds, const std::function<double(double)>& torque_nm)
    -> TorqueRun;
/// That of figures 2.7 and 2.9: to and fro by 0.155 N m.
auto triangle_of_chapter_2(const sim::PlantParameters& plant) -> TorqueRun;

struct ForceModels {
  Eigen::VectorXd pull, pull_push;
};
/// (2.17) to (2.21) with the numbers of chapter 2, each holding its last value as the thesis says.
auto force_models(const TorqueRun& run) -> ForceModels;

/// Of both models in (2.27), by least squares.
struct BlendWeights {
  double pull, pull_push;
};
auto blend_weights(const TorqueRun& run, const ForceModels& models) -> BlendWeights;

}  // namespace capstan::tools
