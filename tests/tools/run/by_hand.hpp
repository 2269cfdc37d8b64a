// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include "capstan/hal/sim/plant.hpp"
#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools::test {

/// The bare instrument, its motor pulley turned by hand.
template <typename Angle>
auto turn_by_hand(const sim::PlantParameters& parameters, double seconds, Angle&& angle,
                  Eigen::VectorXd* joint_angle = nullptr) -> ForceLog {
  sim::Plant plant(parameters, 5);
  const auto samples = static_cast<Eigen::Index>(seconds * 1000.0);
  ForceLog log;
  log.name = "by hand";
  for (auto* values : {&log.time_s, &log.q1_rad, &log.tau_nm, &log.tau_out_nm}) {
    values->resize(samples);
  }
  if (joint_angle != nullptr) {
    joint_angle->resize(samples);
  }
  Random random(6);
  for (Eigen::Index i = 0; i < samples; ++i) {
    log.time_s[i] = 0.001 * static_cast<double>(i);
    plant.step_kinematic(angle(log.time_s[i]));
    log.q1_rad[i] = plant.truth().q1_rad;
    if (joint_angle != nullptr) {
      (*joint_angle)[i] = plant.truth().q2_rad;
    }
    log.tau_nm[i] = plant.truth().tau_in_nm + 3e-4 * random.normal();
    log.tau_out_nm[i] = plant.truth().tau_out_nm + 2e-4 * random.normal();
  }
  return log;
}
inline auto triangle(double amplitude, double frequency_hz) {
  return [=](double t) {
    return amplitude * 2.0 / std::numbers::pi * std::asin(std::sin(2.0 * std::numbers::pi * frequency_hz * t));
  };
}

}  // namespace capstan::tools::test
