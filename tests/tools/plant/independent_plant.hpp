// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

/// A second simulated joint, which shares no code and no formulation with hal/sim or the laws: masses, springs and
/// bristles, integrated explicitly in steps of 1/64 ms. Nothing here includes anything of Capstan.
namespace capstan::independent {

/// One tendon over guides: springs between points that rub. Each point's friction is the share of the friction number
/// that falls to it times the tension there (dN = T dphi, dF = mu dN), carried by a bristle that yields.
struct TendonDrawing {
  double stiffness_n_per_m = 5e4;    ///< E A / L of the whole
  double eta = 1.0;                  ///< mu L / R of the whole
  std::vector<double> guide_shares;  ///< of eta, one per guide, together 1
};

/// What may be wrong with the joint. All off.
struct Effects {
  double play_rad = 0.0;           ///< half of the gap between output pulley and joint
  double camera_delay_s = 0.0;     ///< not rounded to steps of the log
  double pretension_n = 0.0;       ///< both tendons shortened: what comes to the sum of their mean tensions
  double weight_nm = 0.0;          ///< at the joint, times sin(q2 + weight_angle)
  double weight_angle_rad = 0.3;   //
  double load_inertia_kgm2 = 0.0;  ///< on the joint
  double growth_m = 0.0;           ///< of the top tendon, growth (1 - exp(-t / 300 s))
  double gear_error_rad = 0.0;     ///< the motor's pulley turns q1 + error sin(5 q1 + 0.7): an eccentric gear wheel
  double hardening_per_n = 0.0;    ///< tension (e^{2 h F} - 1) / (2 h), F that of the linear spring
  double drag_ns_per_m = 0.0;      ///< of the whole of each tendon
  double presliding_nm = 0.0;      ///< at the joint, Dahl's friction beside its own, 0.02 rad to bend
  double tremor_nm = 0.0;          ///< from outside on the tip, 3 Hz
  double wear_per_rad = 0.0;       ///< friction numbers grow with the motor's way
  double bend_per_rad = 0.0;       ///< friction numbers are eta (1 + bend |q2|)
  double sticky_nm = 0.0;          ///< bearing friction, a bell of 0.05 rad about q2 = 0.2
  double detent_nm = 0.0;          ///< motor's cogging, 35 per turn
  double slip_rad = 0.0;           ///< the motor's pulley slips on its shaft once, a sixth into the log
};

struct Parameters {
  TendonDrawing top, bottom;
  double pretension_n = 20.0;  ///< sum of both tendons' mean tensions
  double motor_radius_m = 2.6e-3, joint_radius_m = 2.4e-3;
  double motor_inertia_kgm2 = 2e-5, motor_viscous_nms = 2e-4, motor_friction_nm = 3e-3;
  double joint_inertia_kgm2 = 4e-7, joint_viscous_nms = 2e-4, joint_friction_nm = 2e-3;
  double counts_per_turn = 40960.0;
  double camera_noise_rad = 1.7e-3;
  double torque_noise_nm = 3e-4, torque_step_nm = 1.22e-4;
  double tip_torque_noise_nm = 2e-4;  ///< of the torque sensor at a held joint
  bool held = false;                  ///< the joint cannot move, and a sensor measures the torque on it
  Effects effects;
};

/// One row of the log that a laboratory would write.
struct Row {
  double time_s, q1_rad, tau_nm, q2_rad, tau_out_nm;
};

/// Moves the joint by a position servo of 1 kHz on the motor.
/// @param motor_angle  rad that the servo is asked for, by time in s; starts at 0
/// @param rate_hz      rows per second; divides 64,000
/// @return rows of `duration_s`. Throws std::runtime_error if the integration diverges.
auto moved(const Parameters& parameters, const std::function<double(double)>& motor_angle, double duration_s,
           double rate_hz, std::uint64_t seed) -> std::vector<Row>;

}  // namespace capstan::independent
