// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include "capstan/firmware/control/palpation.hpp"
#include "capstan/hal/sim/plant.hpp"
#include "capstan/tools/identify/palpation.hpp"
#include "capstan/tools/thesis/tissues.hpp"

namespace capstan::tools::test {

inline constexpr double kTurn = 2.0 * std::numbers::pi;

inline auto servo_log(const sim::PlantParameters& p, double seconds, double amplitude_rad, double offset_rad,
                      double frequency_hz, std::uint64_t seed) -> AxisLog {
  return servo_force_log(p, seconds, amplitude_rad, offset_rad, frequency_hz, seed);
}
inline auto triangle(double frequency_hz, double t) -> double {
  return unit_triangle(frequency_hz, t);
}
template <typename Drive>
auto recorded(const sim::PlantParameters& p, const char* name, double seconds, std::uint64_t seed, Drive&& drive)
    -> AxisLog {
  return recorded_force(p, name, seconds, seed, std::forward<Drive>(drive));
}
inline auto between(Random& random, double low, double high) -> double {
  return drawn_between(random, low, high);
}
inline auto calibrated(std::uint64_t seed) -> TensionStateParameters<double> {
  return calibrated_law(seed);
}
inline auto tissue(std::uint64_t seed) -> sim::Environment {
  return drawn_tissue(seed);
}

/// What the board's own palpation records with real sensors: triangles of torque, to and fro.
inline auto torque_log(const sim::PlantParameters& p, double seconds, double amplitude_nm, double frequency_hz,
                       std::uint64_t seed) -> AxisLog {
  return recorded(p, "torque triangles", seconds, seed, [&](double t, double /*q1*/) {
    return amplitude_nm * triangle(frequency_hz, t) / p.torque_constant_nm_per_a;
  });
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
inline auto felt_by_board(const AxisLog& log, const TensionStateParameters<double>& parameters)
    -> std::optional<Stiffness> {
  Palpation palpation;
  palpation.begin(on_board(parameters), {.site = 1, .largest_nm = Q24::from_double(log.tau_nm.cwiseAbs().maxCoeff())});
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    palpation.add(Q24::from_double(log.q1_rad[i]), Q24::from_double(log.tau_nm[i]));
  }
  const auto site = palpation.end();
  return site ? std::optional(Stiffness{site->value_nm_per_rad.to_double(), site->half_interval.to_double()})
              : std::nullopt;
}

}  // namespace capstan::tools::test
