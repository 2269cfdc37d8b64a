// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/firmware/control/modes.hpp"

namespace capstan {

/// What is watched of one joint in every cycle, beside what its sensors and its law say of themselves.
class Monitors {
 public:
  /// Motor's current and supply, with torque or without. @param drive_a  current that was wanted in the last cycle
  auto rt_watch_power(const LimitConfig& limits, const MotorState& motor, Q24 drive_a) -> FaultSet;
  /// Whether the joint does what was asked of it. Only while energised.
  /// @param begins  the reference has nothing to do with the last one
  auto rt_watch_motion(const LimitConfig& limits, const MotorState& motor, const JointEstimate& estimate,
                       const JointReference& reference, bool begins) -> FaultSet;
  /// Whether the motor runs away, whatever it was asked for: a loop that its gains make unstable is at full speed
  /// before the joint is far from its reference for long. Only while energised.
  /// @param beta  ratio of the law, joint over motor   @param own  the servo alone moves the motor
  auto rt_watch_speed(const LimitConfig& limits, Q24 q1_rad, Q24 beta, bool own) -> FaultSet;
  /// Without torque nothing is asked of the joint.
  void rt_rest();

 private:
  auto rt_supply_fault(bool low) -> FaultSet;

  static constexpr std::size_t kPaceCycles = 8;
  std::array<Q24, kPaceCycles> way_{};  // of the motor, a ring ...
  std::size_t paces_ = 0;               // ... from here on
  /// Stretched tendons let a motor spring back when what held it goes.
  static constexpr std::int32_t kSettleCycles = 64;
  std::int32_t cycles_of_own_ = 0;  // in which the servo alone moved the motor; at rest what leaves a ring to fill

  std::int32_t cycles_off_reference_ = 0;
  std::int32_t cycles_over_current_ = 0;
  std::int32_t cycles_mismatched_ = 0;
  std::int32_t undervoltage_cycles_ = 0;
  bool undervoltage_ = false;
  std::int64_t still_counts_ = 0;  // where the encoder stands since ...
  std::int32_t still_cycles_ = 0;
  Q24 still_reference_;  // ... the reference was here
};

}  // namespace capstan
