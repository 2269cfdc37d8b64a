// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "hal/sim/drivetrain.hpp"
#include "hal/sim/parameters.hpp"
#include "hal/sim/random.hpp"
#include "hal/sim/sensors.hpp"

namespace capstan::sim {

/// The true state after a step. For logs and tests only: nothing of it may reach the firmware.
struct Truth {
  double time_s = 0.0;
  double q1_rad = 0.0;
  double q2_rad = 0.0;
  double q1_rate_rad_per_s = 0.0;
  double q2_rate_rad_per_s = 0.0;
  double tau_in_nm = 0.0;        ///< (Ttl - Tbl) r1: what the tendons take from the motor
  double tau_out_nm = 0.0;       ///< (Ttr - Tbr) r2: what they give to the output pulley
  double motor_torque_nm = 0.0;  ///< torque constant times current, before the motor's own friction
  double current_a = 0.0;
  double q2_camera_rad = 0.0;  ///< the joint camera: noisy, possibly held and late
};

/// One motor, two tendons with distributed friction, one joint. Advances in steps of 1 ms.
/// Two plants with equal parameters, seed and input sequence agree bit for bit, on any machine with IEEE doubles.
class Plant {
 public:
  static constexpr double kStepS = 0.001;

  /// Starts at rest, q1 = q2 = 0, tendons evenly tensioned. Throws std::invalid_argument on impossible parameters.
  Plant(const PlantParameters& parameters, std::uint64_t seed);

  /// One millisecond. `enabled` false: the amplifier is open, no current flows.
  /// Throws std::runtime_error with a sentence if the command is not a number or the state diverges.
  void step(double current_command_a, bool enabled);

  /// One millisecond with the input pulley moved to `q1_rad` by hand, as on a test bench; the motor takes no part.
  void step_kinematic(double q1_rad);

  /// What the board sees now, sensor faults included.
  [[nodiscard]] Readings readings() const { return readings_; }
  [[nodiscard]] const Truth& truth() const { return truth_; }

  /// Adds a fault to the schedule.
  void schedule(const Fault& fault) { faults_.add(fault); }

  [[nodiscard]] const PlantParameters& parameters() const { return parameters_; }
  [[nodiscard]] const Drivetrain& drivetrain() const { return drivetrain_; }

 private:
  void apply_slow_effects();
  void advance_current(double command_a, bool enabled);
  [[nodiscard]] Loads loads(double time_s) const;
  void observe();

  PlantParameters parameters_;
  Drivetrain drivetrain_;
  FaultSchedule faults_;
  Encoder encoder_;
  CurrentSensor current_sensor_;
  Camera camera_;
  Readings readings_;
  Truth truth_;
  std::uint64_t step_count_ = 0;
  double current_a_ = 0.0;
  double current_decay_ = 0.0;
  double applied_growth_m_ = 0.0;
  double applied_pretension_n_ = 0.0;
  double travelled_rad_ = 0.0;
};

}  // namespace capstan::sim
