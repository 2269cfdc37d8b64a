// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/control/modes.hpp"

namespace capstan {

/// Looks for a joint that swings by its own control: the motor goes to and fro about where the servo wants it, faster
/// than its inertia would on the servo's stiffness and without being asked, and the motor's torque feeds the swing.
/// What shakes a joint from outside is damped by its control and feeds nothing.
class LimitCycleWatch {
 public:
  explicit LimitCycleWatch(const AxisConfig& config) { rt_configure(config); }
  void rt_configure(const AxisConfig& config);
  /// Once a cycle under torque. @param asked  the joint is shaken, or torque is commanded
  /// @returns Fault::kLimitCycle after four seconds, of a joint that is commissioned
  auto rt_step(const MotorState& motor, const JointReference& reference, bool asked) -> FaultSet;
  /// Without torque nothing swings by control; the warning stays until then.
  void rt_rest();
  [[nodiscard]] auto warnings() const -> WarningSet { return warned_ ? bit(Warning::kLimitCycle) : WarningSet{0}; }

 private:
  /// Counts how often a value turns by more than a width.
  struct Turns {
    Q24 extreme;
    bool rising = false;
    std::int32_t count = 0;
    [[gnu::always_inline]] inline void rt_step(Q24 value, Q24 width);
  };
  auto rt_end_window() -> FaultSet;

  Q24 width_;
  Q24 stiffness_nm_per_rad_, inertia_gm2_;
  Turns error_, wanted_;
  std::int32_t cycles_ = 0;
  std::int32_t windows_ = 0;  // that swung, one after the other
  bool asked_ = false;
  bool warned_ = false;
  bool known_ = false;  // the last angle is
  Q24 last_q1_;
  std::int64_t mean_torque_ = 0, mean_step_ = 0;  // 2^-24 Nm and rad, times 2^kMeanShift
  std::int64_t fed_ = 0;                          // work of the torque about its mean, 2^-48 J
};

}  // namespace capstan
