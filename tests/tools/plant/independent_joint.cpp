// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/independent_joint.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "capstan/tools/support/random.hpp"

namespace capstan::tools::plant {
namespace {

auto tendon(Random& random, double eta, double stiffness) -> independent::TendonDrawing {
  independent::TendonDrawing drawing;
  drawing.eta = eta * std::pow(1.18, 2.0 * random.uniform() - 1.0);
  drawing.stiffness_n_per_m = stiffness * std::pow(1.18, 2.0 * random.uniform() - 1.0);
  drawing.guide_shares.resize(8 + static_cast<std::size_t>(8.0 * random.uniform()));
  double sum = 0.0;
  for (double& share : drawing.guide_shares) {
    share = 0.8 + 0.4 * random.uniform();
    sum += share;
  }
  for (double& share : drawing.guide_shares) {
    share /= sum;
  }
  return drawing;
}

}  // namespace

auto independent_joint(std::uint64_t seed) -> independent::Parameters {
  Random random(seed);
  const auto drawn = [&](double least, double most) { return least * std::pow(most / least, random.uniform()); };
  independent::Parameters joint;
  const double eta = drawn(0.3, 1.5);
  const double stiffness = drawn(2.5e4, 1e5);
  joint.top = tendon(random, eta, stiffness);
  joint.bottom = tendon(random, eta, stiffness);
  joint.pretension_n = drawn(6.0, 30.0);
  joint.motor_radius_m *= drawn(0.8, 1.5);
  joint.joint_radius_m *= drawn(0.8, 1.5);
  joint.motor_inertia_kgm2 *= drawn(0.5, 1.5);
  joint.motor_friction_nm *= drawn(0.5, 2.0);
  joint.joint_friction_nm *= drawn(0.3, 1.5);
  joint.effects.weight_angle_rad = 1.2 * random.uniform() - 0.6;
  return joint;
}

auto log_of(const independent::Parameters& joint, const LabExperiment& experiment, const std::string& keep) -> AxisLog {
  const double stiffness = 0.5 * (joint.top.stiffness_n_per_m + joint.bottom.stiffness_n_per_m);
  constexpr double kPullNm = 0.15;
  const double pull = std::min(0.25, kPullNm / (1.5 * stiffness * joint.motor_radius_m * joint.motor_radius_m));
  const auto course = lab_course(experiment, pull);
  const double beta = joint.held ? 1.0 : joint.motor_radius_m / joint.joint_radius_m;
  const auto rows = independent::moved(
      joint, [&](double time) { return course(time) / beta; }, joint.held ? 20.0 : kLabDurationS, experiment.rate_hz,
      experiment.noise_seed);
  return lab_log(rows, joint.held, experiment, keep);
}

}  // namespace capstan::tools::plant
