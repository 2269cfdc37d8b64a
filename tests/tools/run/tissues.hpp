// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include "capstan/firmware/control/palpation.hpp"
#include "capstan/hal/sim/plant.hpp"
#include "capstan/tools/identify/palpation.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools::test {

inline constexpr double kTurn = 2.0 * std::numbers::pi;

/// What a driven plant shows of itself, at 1 kHz. @param drive  the current, A, at a time and a motor angle
template <typename Drive>
auto recorded(const sim::PlantParameters& p, const char* name, double seconds, std::uint64_t seed, Drive&& drive)
    -> ForceLog {
  sim::Plant plant(p, seed);
  const auto rows = static_cast<Eigen::Index>(seconds * 1000.0);
  ForceLog log;
  log.name = name;
  for (auto* values : {&log.time_s, &log.q1_rad, &log.tau_nm, &log.tau_out_nm}) {
    values->resize(rows);
  }
  for (Eigen::Index i = 0; i < rows; ++i) {
    log.time_s[i] = 0.001 * static_cast<double>(i);
    log.q1_rad[i] = kTurn / p.encoder_counts_per_turn * plant.readings().encoder_counts;
    log.tau_nm[i] = p.torque_constant_nm_per_a * plant.readings().current_a;
    log.tau_out_nm[i] = plant.truth().tip_torque_nm;
    plant.step(drive(log.time_s[i], log.q1_rad[i]), true);
  }
  return log;
}

/// A triangle from -1 to 1.
inline auto triangle(double frequency_hz, double t) -> double {
  return 2.0 / std::numbers::pi * std::asin(std::sin(kTurn * frequency_hz * t));
}

/// What a stiff servo on the motor angle records with real sensors: a triangle about an offset.
inline auto servo_log(const sim::PlantParameters& p, double seconds, double amplitude_rad, double offset_rad,
                      double frequency_hz, std::uint64_t seed) -> ForceLog {
  double integral = 0.0;
  double last = 0.0;
  return recorded(p, "servo", seconds, seed, [&](double t, double q1) {
    const double wanted = offset_rad * std::min(1.0, 2.0 * t) + amplitude_rad * triangle(frequency_hz, t);
    const double error = wanted - q1;
    integral += 0.001 * error;
    const double rate = (error - last) / 0.001;
    last = error;
    return 20.0 * error + 0.05 * rate + 40.0 * integral;
  });
}

/// What the board's own palpation records with real sensors: triangles of torque, to and fro.
inline auto torque_log(const sim::PlantParameters& p, double seconds, double amplitude_nm, double frequency_hz,
                       std::uint64_t seed) -> ForceLog {
  return recorded(p, "torque triangles", seconds, seed, [&](double t, double /*q1*/) {
    return amplitude_nm * triangle(frequency_hz, t) / p.torque_constant_nm_per_a;
  });
}

inline auto calibrated(std::uint64_t seed) -> TensionStateParameters<double> {
  sim::PlantParameters p;
  p.environment.kind = sim::EnvironmentKind::kLocked;
  return tension_state_of(fit_pull_push({servo_log(p, 60.0, 0.25, 0.0, 0.05, seed)}));
}

inline auto between(Random& random, double low, double high) -> double {
  return low + (high - low) * 0.5 * (1.0 + std::erf(random.normal() / std::numbers::sqrt2));
}

/// Soft over stiffer tissue that resists speed; the deep layer is what is asked for.
inline auto tissue(std::uint64_t seed) -> sim::Environment {
  Random random(static_cast<std::uint32_t>(seed));
  sim::Environment e;
  e.kind = sim::EnvironmentKind::kLayered;
  e.angle_rad = 0.05;
  e.stiffness = between(random, 0.02, 0.05);
  e.deep_stiffness = between(random, 0.04, 0.2);
  e.layer_depth_rad = between(random, 0.05, 0.09);
  e.damping = between(random, 0.0, 0.2);
  return e;
}

/// The law as `capstan apply` gives it to a board.
inline auto on_board(const TensionStateParameters<double>& p) -> ForceConfig {
  const auto q = [](double x) { return Q24::from_double(x); };
  ForceConfig force;
  force.law = static_cast<std::int32_t>(ForceLawKind::kPullPush);
  force.eta_top = q(p.eta_top);
  force.eta_bottom = q(p.eta_bottom);
  force.pretension_nm = q(p.pretension_nm);
  force.ratio = q(1.0 / p.beta);
  force.friction_nm = q(p.friction_nm);
  force.stiffness_top_nm_per_rad = q(1.0 / p.compliance_top);
  force.stiffness_bottom_nm_per_rad = q(1.0 / p.compliance_bottom);
  return force;
}

/// What the firmware makes of the same rows, one a cycle.
inline auto felt_by_board(const ForceLog& log, const TensionStateParameters<double>& parameters)
    -> std::optional<Stiffness> {
  Palpation palpation;
  palpation.begin(on_board(parameters),
                  {.site = 1, .amplitude_nm = Q24::from_double(log.tau_nm.cwiseAbs().maxCoeff())});
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    palpation.add(Q24::from_double(log.q1_rad[i]), Q24::from_double(log.tau_nm[i]));
  }
  const auto site = palpation.end();
  return site ? std::optional(Stiffness{site->value_nm_per_rad.to_double(), site->half_interval.to_double()})
              : std::nullopt;
}

}  // namespace capstan::tools::test
