// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "capstan/hal/sim/drivetrain.hpp"
#include "capstan/hal/sim/faults.hpp"
#include "capstan/hal/sim/parameters.hpp"
#include "capstan/hal/sim/random.hpp"
#include "capstan/hal/sim/sensors.hpp"
#include "capstan/hal/sim/step.hpp"

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
  double tip_force_n = 0.0;    ///< the tip force sensor: what the environment or the lock pushes back with, noisy
  double tip_torque_nm = 0.0;  ///< the same about the joint
  double temperature_c = 0.0;  ///< of the instrument, by its thermometer
  double second_rad = 0.0;     ///< the joint that `axis_coupling` swings
};

/// Everything of an axis but its drivetrain: amplifier, sensors, faults, and what changes slowly.
class Periphery {
 public:
  Periphery(const PlantParameters& parameters, std::uint64_t seed);

  /// Begins a step of 1 ms: faults and slow effects.
  void begin(double current_command_a, bool enabled, Tendon& top, Tendon& bottom);

  /// The loads of one sub-step, number 1..substeps, amplifier included.
  [[nodiscard]] Loads powered(int substep, const DrivetrainState& before);
  /// The same with the amplifier taking no part.
  [[nodiscard]] Loads unpowered(int substep, const DrivetrainState& before) const;

  /// Ends the step, or describes the start.
  void observe(const DrivetrainState& state);

  void schedule(const Fault& fault) { faults_.add(fault); }
  [[nodiscard]] double site_m() const;
  void set_environment_angle(double angle_rad) { parameters_.environment.angle_rad = angle_rad; }
  [[nodiscard]] const PlantParameters& parameters() const { return parameters_; }
  [[nodiscard]] const Readings& readings() const { return readings_; }
  [[nodiscard]] const Truth& truth() const { return truth_; }

 private:
  void apply_slow_effects(Tendon& top, Tendon& bottom);
  void advance_current();
  void observe_tip(const DrivetrainState& state);
  [[nodiscard]] double warmth(double time_s) const;
  [[nodiscard]] double second_rad(double time_s) const;
  [[nodiscard]] Loads loads(double time_s, const DrivetrainState& state) const;

  PlantParameters parameters_;
  FaultSchedule faults_;
  Encoder encoder_;
  CurrentSensor current_sensor_;
  Late late_q1_, late_current_;
  Camera camera_;
  Random tip_noise_, thermometer_noise_;
  Readings readings_;
  Truth truth_;
  std::uint64_t step_count_ = 0;
  double command_a_ = 0.0;
  bool enabled_ = false;
  double current_a_ = 0.0;
  double current_decay_ = 0.0;
  double substep_s_ = 0.0;
  double applied_growth_m_ = 0.0;
  double applied_pretension_n_ = 0.0;
  bool frayed_ = false;
  double travelled_rad_ = 0.0;
};

/// Keeps the sentence of a plant that diverged: what comes after is refused.
class Divergence {
 public:
  /// Does `action`, unless one before failed. Throws std::runtime_error.
  template <class Action>
  void guard(Action&& action) {
    if (!sentence_.empty())
      throw std::runtime_error(sentence_);
    try {
      action();
    } catch (const std::runtime_error& failure) {
      sentence_ = failure.what();
      throw;
    }
  }

 private:
  std::string sentence_;
};

struct MotorCommand {
  double current_a = 0.0;
  bool enabled = false;
};

/// Throws std::runtime_error if it is not.
void require_number(double current_command_a);

/// One motor, two tendons with distributed friction, one joint. Advances in steps of 1 ms.
/// Two plants with equal parameters, seed and input sequence agree bit for bit, on any machine with IEEE doubles.
class Plant {
 public:
  static constexpr double kStepS = capstan::sim::kStepS;

  /// Starts at rest, q1 = q2 = 0, tendons evenly tensioned. Throws std::invalid_argument on impossible parameters.
  Plant(const PlantParameters& parameters, std::uint64_t seed);

  /// One millisecond. `enabled` false: the amplifier is open, no current flows.
  /// Throws std::runtime_error with a sentence if the command is not a number or the state diverges. A plant that has
  /// diverged stays where it was last sane and answers every further step with the same sentence.
  void step(double current_command_a, bool enabled);

  /// The same through the face that MultiPlant has too. Throws std::invalid_argument unless there is one command.
  void step(std::span<const MotorCommand> commands);

  /// One millisecond with the input pulley moved to `q1_rad` by hand, as on a test bench; the motor takes no part.
  void step_kinematic(double q1_rad);

  /// Moves what the tip touches from now on, its rest angle or where the contact begins, as another jaw does that holds
  /// the same thing.
  void move_environment(double angle_rad) {
    periphery_.set_environment_angle(angle_rad);
    drivetrain_.set_environment_angle(angle_rad);
  }

  /// What the board sees now, sensor faults included.
  [[nodiscard]] const Readings& readings(std::size_t = 0) const { return periphery_.readings(); }
  [[nodiscard]] const Truth& truth(std::size_t = 0) const { return periphery_.truth(); }

  /// Adds a fault to the schedule. Throws std::invalid_argument as FaultSchedule::add does.
  void schedule(const Fault& fault) { periphery_.schedule(fault); }

  [[nodiscard]] static constexpr std::size_t axis_count() { return 1; }
  [[nodiscard]] const PlantParameters& parameters(std::size_t = 0) const { return periphery_.parameters(); }
  [[nodiscard]] const Drivetrain& drivetrain() const { return drivetrain_; }

 private:
  Periphery periphery_;
  Drivetrain drivetrain_;
  Divergence divergence_;
};

}  // namespace capstan::sim
