// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capstan/tools/response/response.hpp"

namespace capstan::tools {

/// What the board's control does with an angle: control.*, and what bounds it.
struct LoopGains {
  double kp = 0.2, ki_per_s = 4.0, kd_s = 0.0;
  double stiffness = 1.0;               ///< Nm/rad
  double damping = 0.006;               ///< Nms/rad
  double rate_time_constant_s = 0.002;  ///< filter of the rate that the damping acts on
  /// Torque of a steady motion backward and forward, N m, where the log tells it.
  std::optional<std::pair<double, double>> friction_nm = {};
  double counts_per_turn = 40960.0;
  double continuous_nm = 0.15;  ///< limits.continuous_current times the torque per current
  double rate_nm = 0.05;        ///< largest change of the torque in a cycle: limits.current_rate, or the observer's
};

/// From the lines of the shell's `dump`; what it does not have stays the firmware's default. Throws BadInput.
auto read_gains(const std::string& dump, int axis) -> LoopGains;

/// How far a loop is from -1. The worst of what the circles allow, at the frequencies where it is worst.
struct Margins {
  double phase_deg = 180.0, phase_hz = 0.0;  ///< at the highest crossover
  double gain_db = 60.0, gain_hz = 0.0;      ///< towards more gain or less
  double modulus = 1.0, modulus_hz = 0.0;    ///< least |1 + L|
  double crossover_hz = 0.0;                 ///< the highest; 0: the gain stays below 1
};

/// What is asked of a loop.
struct Wanted {
  double phase_deg = 45.0, gain_db = 6.0, modulus = 0.5;
  double onset = 2.0;  ///< times the gains until a moving joint begins to swing
  std::optional<double>
      bandwidth_hz;  ///< of the motor servo: its highest crossover; nothing: as much as the margins allow
};

/// The plant as motor and delay: exp(-s T) / (J s2 + b s + k) / (1 + s l), by least squares over the lines; with a
/// torque that is held for h, sin(x) / x with x = w h / 2, and with a joint on its tendons, which adds m (2 z w
/// s + w2) (s2 + 2 d w s) / (s2 + 2 (z + d) w s + w2) below the line.
struct MotorModel {
  double inertia_kgm2 = 0.0, viscous_nms = 0.0, stiffness_nm = 0.0, delay_s = 0.0;
  double lag_s = 0.0;                          ///< l: of the amplifier
  double joint_inertia_kgm2 = 0.0;             ///< m, at the motor; 0: no joint of its own is seen
  double joint_hz = 0.0, joint_damping = 0.0;  ///< w: the joint swings there while the motor is held; z
  double joint_drag = 0.0;                     ///< d: what brakes the joint itself, not its swing on the tendons
  double hold_s = 0.0;                         ///< h; 0: its roll-off is in the lag, or is left out
  double resonance_hz = 0.0;  ///< where the response is furthest above the model, by 6 dB at least; 0: nowhere
  double share_left = 0.0;    ///< rms of what it does not explain, relative
  [[nodiscard]] auto at(double hz) const -> Complex;
};
/// @param with_lag  the amplifier's is looked for: its lines have to go far beyond 100 Hz
auto fit_motor(const Response& response, bool with_lag = false) -> MotorModel;
/// With the amplifier's lag, and the joint where that explains a good part of what the motor alone leaves.
auto fit_motor_and_joint(const Response& response) -> MotorModel;

/// The loop that these gains would have, broken at the torque, between the first and the last line: value and circle.
struct LoopPoint {
  double hz = 0.0;
  Complex value;
  double radius95 = 0.0;
};
auto predicted_loop(const Response& response, const LoopGains& gains) -> std::vector<LoopPoint>;
/// As it was measured, between the lines too.
auto measured_loop(const Response& response) -> std::vector<LoopPoint>;
/// @param with_circle  false: of the values alone
auto margins_of(const std::vector<LoopPoint>& loop, bool with_circle = true) -> Margins;
/// Of the measured loop; the worse of backward and forward where they differ.
auto measured_margins(const Response& response, bool with_circle) -> Margins;
/// Whether `loop` is as stable as `known`, which is: neither 1 + L turns round zero against the other.
auto as_stable_as(const std::vector<LoopPoint>& loop, const std::vector<LoopPoint>& known) -> bool;

struct Tuning {
  LoopGains gains;
  MotorModel motor;
  Margins servo, whole;             ///< the motor servo alone, and with the joint loop; circles included
  Margins whole_nominal;            ///< of the values alone, to compare a measurement with
  double joint_bandwidth_hz = 0.0;  ///< where the joint loop's gain is 1
  std::string limited_by;           ///< a sentence
  std::string swings;               ///< at which multiple of the gains the joint would swing, a sentence; or nothing
  std::string ways;                 ///< that the joint answers otherwise backward than forward, a sentence; or nothing
  std::string warning;              ///< of a log that makes that come too late; or nothing
  std::vector<LoopPoint> loop;      ///< of the way that has the lower modulus, as is `motor`
};

/// Gains for the wanted margins over the circles, of each view of the response. Throws Refusal where the response is
/// not smooth between its lines, no gains keep the margins, none as fast as asked, or the joint would begin to swing at
/// less than twice the gains.
/// @param present  those the log was made with: their kd, filter and bounds are kept
auto tune(const Response& response, const LoopGains& present, const Wanted& wanted) -> Tuning;

/// `begin`, `set ...`, `commit`.
auto tuning_lines(const LoopGains& gains, int axis) -> std::vector<std::string>;

}  // namespace capstan::tools
