// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/blend.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/hal/sim/plant.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/thesis/thesis.hpp"

namespace capstan::tools {

auto torque_run(const sim::PlantParameters& plant_parameters, double seconds,
                const std::function<double(double)>& torque_nm) -> TorqueRun {
  sim::PlantParameters p = plant_parameters;
  p.environment.kind = sim::EnvironmentKind::kLocked;
  sim::Plant plant(p, 600);
  const auto rows = static_cast<Eigen::Index>(seconds * 100.0);
  TorqueRun run{Eigen::VectorXd(rows), Eigen::VectorXd(rows), Eigen::VectorXd(rows)};
  for (Eigen::Index i = 0; i < rows; ++i) {
    run.time_s[i] = 0.01 * static_cast<double>(i);
    run.in_nm[i] = run.out_nm[i] = 0.0;
    for (int k = 0; k < 10; ++k) {
      plant.step(torque_nm(run.time_s[i] + 0.001 * k) / p.torque_constant_nm_per_a, true);
      run.in_nm[i] += 0.1 * p.torque_constant_nm_per_a * plant.readings().current_a;
      run.out_nm[i] += 0.1 * plant.truth().tip_torque_nm;
    }
  }
  return run;
}

auto force_models(const TorqueRun& run) -> ForceModels {
  const sim::PlantParameters p;
  const double r1 = p.input_radius_m;
  const double r2 = p.output_radius_m;
  ForceModels m{Eigen::VectorXd::Zero(run.in_nm.size()), Eigen::VectorXd::Zero(run.in_nm.size())};
  double pull = 0.0;
  double both = 0.0;
  for (Eigen::Index i = 10; i < run.in_nm.size(); ++i) {
    // Direction by a tenth of a second: the noise of a current turns more often than the motion.
    const double s = run.in_nm[i] > run.in_nm[i - 10] ? 1.0 : -1.0;
    const double eta = s > 0.0 ? p.eta_top : p.eta_bottom;
    if (s * run.in_nm[i] > 0.0) {
      pull = run.in_nm[i] * r2 / r1 * std::exp(-eta);
    }
    // With the pulling end P and the pushed end Q = P - s tau / r1: P (1 - e^-eta) / eta + Q (e^eta - 1) / eta = I.
    const double a = (1.0 - std::exp(-eta)) / eta;
    const double b = (std::exp(eta) - 1.0) / eta;
    const double force = s * run.in_nm[i] / r1;
    const double pulling = (p.pretension_n + b * force) / (a + b);
    const double pushed = pulling - force;
    const double at_output = std::exp(-eta) * pulling - std::exp(eta) * std::max(pushed, 0.0);
    if (pushed > 0.0 && at_output > 0.0) {
      both = s * r2 * at_output;
    } else if (pushed <= 0.0) {
      both = pull;
    }
    m.pull[i] = pull;
    m.pull_push[i] = both;
  }
  return m;
}

auto blend_weights(const TorqueRun& run, const ForceModels& m) -> BlendWeights {
  Eigen::MatrixXd columns(run.out_nm.size(), 2);
  columns << m.pull, m.pull_push;
  const Eigen::Vector2d w = columns.colPivHouseholderQr().solve(run.out_nm);
  return {w[0], w[1]};
}

auto triangle_of_chapter_2(const sim::PlantParameters& plant) -> TorqueRun {
  return torque_run(plant, 95.0, [](double t) {
    return 0.155 * 2.0 / std::numbers::pi * std::asin(std::sin(2.0 * std::numbers::pi * t / 40.0));
  });
}

}  // namespace capstan::tools
