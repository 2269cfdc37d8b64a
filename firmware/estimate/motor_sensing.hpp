// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/estimate/encoder_scale.hpp"
#include "capstan/firmware/parameters/config.hpp"
#include "capstan/firmware/safety/faults.hpp"
#include "capstan/hal/joint_io.hpp"

namespace capstan {

/// What the sensors of one joint say in this cycle, in the law's units.
struct MotorState {
  Q24 q1_rad;               ///< the motor's angle; without a sound encoder value the last one
  Q24 tau_nm;               ///< its torque by its current; likewise
  Q24 current_a;            ///< measured; likewise
  Q24 joint_rad;            ///< by the joint's own sensor, if it has_joint
  std::int64_t counts = 0;  ///< of the encoder, unwrapped
  FaultSet faults = 0;      ///< of the sensors, now
  bool has_joint = false;   ///< a joint sensor gave a value in this cycle
  bool follows = true;      ///< the amplifier follows its set value, once enabled
  bool supply_low = false;  ///< below limits.supply_min in this cycle, or not measured though it is watched
};

/// Counts and currents to angles and torques.
class MotorSensing {
 public:
  explicit MotorSensing(const MotorConfig& motor) : scale_(motor), farthest_rad_(per_cycle(motor.speed_limit_rad_s)) {}
  void rt_configure(const MotorConfig& motor) {
    scale_ = EncoderScale(motor);
    farthest_rad_ = per_cycle(motor.speed_limit_rad_s);
  }
  /// From now on the motor stands at this angle, rad, which clears an encoder jump; without a count to hold on to in
  /// the next step it is one again.
  void rt_zero(Q24 q1_rad);
  /// In place of rt_step where there is no joint: nothing is remembered but the counts, which a motor that turns
  /// meanwhile leaves behind.
  auto rt_absent() -> const MotorState&;
  auto rt_step(const AxisConfig& config, const AxisSensed& sensed) -> const MotorState&;

 private:
  void rt_count(std::int32_t counts);
  void rt_miss();

  EncoderScale scale_;
  Q24 farthest_rad_;  // that the motor gets in a cycle
  MotorState state_;
  std::int32_t last_counts_ = 0;
  bool counting_ = false;
  bool zeroed_ = false;  // the counts are the operator's, not the encoder's first ones
  bool lost_ = false;    // the encoder jumped or was not read, so the counts may be anything until rt_zero
};

}  // namespace capstan
