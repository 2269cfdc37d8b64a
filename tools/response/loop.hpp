// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/response/tuning.hpp"

namespace capstan::tools {

/// What control makes of an angle at one frequency.
struct Law {
  Complex servo;  // Nm per rad of the motor
  Complex joint;  // motor rad per joint rad
};
auto law_of(const LoopGains& gains, double hz) -> Law;

/// The response between its lines: over the model, magnitude and phase run straight over the logarithm of the
/// frequency.
struct Dense {
  MotorModel model;
  std::vector<double> hz;
  std::vector<Complex> motor, joint, loop;                    // joint: per motor angle
  std::vector<double> motor_share, joint_share, loop_radius;  // radii; the first two relative
};

/// Of the lines that rise clearly above noise. Throws Refusal where they are too few.
auto dense(const Response& response) -> Dense;
/// The loop that was measured.
auto measured_loop(const Dense& all) -> std::vector<LoopPoint>;
/// Those lines.
auto clear_points(const Response& response) -> std::vector<ResponsePoint>;
/// -1 where the joint turns against the motor: the transmission is crossed, and the firmware corrects that way round.
auto sense_of(const Dense& all) -> double;
/// Torque per motor angle by way of the joint loop, Nm/rad. @param joint  joint angle per motor angle
auto through_joint(const LoopGains& gains, const Law& law, double sense, Complex joint) -> Complex;
/// The loop of these gains, broken at the torque.
auto loop_of(const Dense& all, const LoopGains& gains) -> std::vector<LoopPoint>;
/// Of the joint loop alone, broken where it corrects the motor's reference.
auto outer_loop(const Dense& all, const LoopGains& gains) -> std::vector<LoopPoint>;

}  // namespace capstan::tools
