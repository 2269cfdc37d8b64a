// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

/// A third simulated joint, which shares no code and no formulation with hal/sim, the laws or the independent plant:
/// tendons without mass over points that stick or slide by Coulomb's law exactly, no bristle and no speed in it; a
/// joint whose drag makes it late. Nothing here includes anything of Capstan.
namespace capstan::coulomb {

/// What may be wrong with the joint. All off.
struct Effects {
  double play_rad = 0.0;           ///< half of the gap between output pulley and joint
  double camera_delay_s = 0.0;     ///< beside the camera's own
  double pretension_n = 0.0;       ///< of each tendon, beside its own
  double weight_nm = 0.0;          ///< at the joint, times sin q2
  double load_inertia_kgm2 = 0.0;  ///< on the joint
  double drag_nms = 0.0;           ///< at the joint, beside its own
  double growth_rad = 0.0;         ///< both tendons move the joint, growth (1 - exp(-t / 20 s)) times the radii's ratio
  double dial_error_rad = 0.0;     ///< what measures the joint errs by error sin(7 q1 + 0.7)
  double hardening = 0.0;          ///< stiffness grows by this share from pretension to twice of it
  double presliding_nm = 0.0;      ///< at the joint, Dahl's friction beside its own, 0.05 rad to bend
  double creep_per_n = 0.0;        ///< m; each tendon lengthens by creep times its tension, after 3 s
  double wear = 0.0;               ///< friction numbers grow by this share over the log
  double sticky = 0.0;             ///< friction numbers are larger by this share, a bell of 0.15 rad about q2 = 0.2
  double detent_nm = 0.0;          ///< at the joint, 12 per turn
  double slip_rad = 0.0;           ///< the motor's pulley slips on its shaft once, halfway
  double tremor_nm = 0.0;          ///< from outside on the tip, 9 Hz
};

struct Parameters {
  double motor_radius_m = 0.01, joint_radius_m = 0.01;
  double stiffness_n_per_m = 2e4;  ///< of each tendon
  double tension_n = 10.0;         ///< of each tendon at rest
  double eta_top = 0.8, eta_bottom = 0.8;
  double motor_inertia_kgm2 = 2e-5, motor_viscous_nms = 1e-4, motor_friction_nm = 2e-3;
  double joint_inertia_kgm2 = 1e-5, joint_viscous_nms = 1e-3, joint_friction_nm = 1e-3;
  double counts_per_turn = 20000.0;
  double camera_noise_rad = 5e-4, camera_late_s = 0.0;
  double torque_noise_nm = 5e-4;
  Effects effects;
};

/// One row of the log that a laboratory would write.
struct Row {
  double time_s, q1_rad, tau_nm, q2_rad;
};

/// Moves the joint; the motor follows exactly, 10 ms behind.
/// @param motor_angle  rad that the motor is asked for, by time in s
/// @param rate_hz      rows per second; divides 10,000
auto moved(const Parameters& parameters, const std::function<double(double)>& motor_angle, double duration_s,
           double rate_hz, std::uint64_t seed) -> std::vector<Row>;

}  // namespace capstan::coulomb
