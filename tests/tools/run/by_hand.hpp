// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "capstan/hal/sim/plant.hpp"
#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools::test {

/// The bare instrument, its motor pulley turned by hand.
template <typename Angle>
auto turn_by_hand(const sim::PlantParameters& parameters, double seconds, Angle&& angle,
                  Eigen::VectorXd* joint_angle = nullptr) -> AxisLog {
  sim::Plant plant(parameters, 5);
  const auto samples = static_cast<Eigen::Index>(seconds * 1000.0);
  AxisLog log;
  log.name = "by hand";
  for (auto* values : {&log.time_s, &log.q1_rad, &log.tau_nm, &log.effort}) {
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
    log.effort[i] = plant.truth().tau_out_nm + 2e-4 * random.normal();
  }
  return log;
}
inline auto triangle(double amplitude, double frequency_hz) {
  return [=](double t) {
    return amplitude * 2.0 / std::numbers::pi * std::asin(std::sin(2.0 * std::numbers::pi * frequency_hz * t));
  };
}

/// A log as it is recorded, of axis 0.
inline auto csv_of(const AxisLog& log) -> std::string {
  std::string text = "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/tau_out_Nm\n";
  std::array<char, 120> row{};
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    std::snprintf(row.data(), row.size(), "%.3f,%.8f,%.8f,%.8f\n", log.time_s[i], log.q1_rad[i], log.tau_nm[i],
                  log.effort[i]);
    text += row.data();
  }
  return text;
}

/// Values that no sensor has measured, in three rows.
inline constexpr std::array<Eigen::Index, 3> kWildRows = {9000, 17000, 26000};
inline void make_wild(Eigen::VectorXd& signal) {
  for (const Eigen::Index row : kWildRows) {
    signal[row] = 5.0;
  }
}
/// Of a channel that is read at a tenth of the log's rate.
inline void hold(Eigen::VectorXd& signal) {
  for (Eigen::Index i = 0; i < signal.size(); ++i) {
    signal[i] = signal[i - i % 10];
  }
}

}  // namespace capstan::tools::test
