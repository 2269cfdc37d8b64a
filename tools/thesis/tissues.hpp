// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "capstan/hal/sim/plant.hpp"
#include "capstan/tools/identify/palpation.hpp"
#include "capstan/tools/support/random.hpp"

/// Drawn tissues, and what an instrument records of them: for surveys of palpation, here and in tests.
namespace capstan::tools {

/// What a driven plant shows of itself, at 1 kHz. @param drive  the current, A, at a time and a motor angle
template <typename Drive>
auto recorded_force(const sim::PlantParameters& p, const char* name, double seconds, std::uint64_t seed, Drive&& drive)
    -> AxisLog {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  sim::Plant plant(p, seed);
  const auto rows = static_cast<Eigen::Index>(seconds * 1000.0);
  AxisLog log;
  log.name = name;
  for (auto* values : {&log.time_s, &log.q1_rad, &log.tau_nm, &log.effort}) {
    values->resize(rows);
  }
  for (Eigen::Index i = 0; i < rows; ++i) {
    log.time_s[i] = 0.001 * static_cast<double>(i);
    log.q1_rad[i] = kTurn / p.encoder_counts_per_turn * plant.readings().encoder_counts;
    log.tau_nm[i] = p.torque_constant_nm_per_a * plant.readings().current_a;
    log.effort[i] = plant.truth().tip_torque_nm;
    plant.step(drive(log.time_s[i], log.q1_rad[i]), true);
  }
  return log;
}

/// A triangle from -1 to 1.
inline auto unit_triangle(double frequency_hz, double t) -> double {
  return 2.0 / std::numbers::pi * std::asin(std::sin(2.0 * std::numbers::pi * frequency_hz * t));
}

/// What a stiff servo on the motor angle records with real sensors: a triangle about an offset.
inline auto servo_force_log(const sim::PlantParameters& p, double seconds, double amplitude_rad, double offset_rad,
                            double frequency_hz, std::uint64_t seed) -> AxisLog {
  double integral = 0.0;
  double last = 0.0;
  return recorded_force(p, "servo", seconds, seed, [&](double t, double q1) {
    const double wanted = offset_rad * std::min(1.0, 2.0 * t) + amplitude_rad * unit_triangle(frequency_hz, t);
    const double error = wanted - q1;
    integral += 0.001 * error;
    const double rate = (error - last) / 0.001;
    last = error;
    return 20.0 * error + 0.05 * rate + 40.0 * integral;
  });
}

/// The law of the instrument, fitted to a run of it with its tip locked.
inline auto calibrated_law(std::uint64_t seed) -> TensionStateParameters<double> {
  sim::PlantParameters p;
  p.environment.kind = sim::EnvironmentKind::kLocked;
  return tension_state_of(fit_pull_push({servo_force_log(p, 60.0, 0.25, 0.0, 0.05, seed)}));
}

inline auto drawn_between(Random& random, double low, double high) -> double {
  return low + (high - low) * 0.5 * (1.0 + std::erf(random.normal() / std::numbers::sqrt2));
}

/// Soft over stiffer tissue that resists speed; the deep layer is what is asked for.
inline auto drawn_tissue(std::uint64_t seed) -> sim::Environment {
  Random random(static_cast<std::uint32_t>(seed));
  sim::Environment e;
  e.kind = sim::EnvironmentKind::kLayered;
  e.angle_rad = 0.05;
  e.stiffness = drawn_between(random, 0.02, 0.05);
  e.deep_stiffness = drawn_between(random, 0.04, 0.2);
  e.layer_depth_rad = drawn_between(random, 0.05, 0.09);
  e.damping = drawn_between(random, 0.0, 0.2);
  return e;
}

}  // namespace capstan::tools
