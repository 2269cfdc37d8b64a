// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "capstan/hal/sim/multi_plant.hpp"
#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools {

inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

/// PID on an angle, output a motor current; the derivative is of the error.
struct Gains {
  double kp_a_per_rad = 0.0;
  double kd_as_per_rad = 0.0;
  double ki_a_per_rads = 0.0;
  int every_ms = 1;  ///< period of the loop
};

/// The gains of the thesis, ch. 5: 0.05 A/deg, 0.0004 A s/deg, 0.01 A/(deg s), at 100 Hz.
auto thesis_gains() -> Gains;
/// A stiff servo on the motor angle at 1 kHz, where the thesis prints no gains (ch. 6, 7).
auto stiff_gains() -> Gains;

/// One axis, recorded at 100 Hz: motor angle from the encoder, torque from the measured current, joint angle from the
/// camera.
struct Experiment {
  AxisLog log;
  Eigen::VectorXd wanted_rad;
};

/// What a loop holds to its reference, out of motor angle and torque; called every 10 ms.
using Controlled = std::function<double(double q1_rad, double tau_nm)>;

/// A simulated instrument on a bench: one axis moves under a PID, the motors of the others are held.
/// @param controlled  the motor angle if empty
auto run_experiment(const std::vector<sim::InstrumentAxis>& instrument, std::size_t axis, const sim::Motion& motion,
                    const Gains& gains, std::uint64_t seed, const Controlled& controlled = {}) -> Experiment;

}  // namespace capstan::tools
