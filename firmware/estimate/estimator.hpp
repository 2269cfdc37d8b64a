// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/estimate/error_bar.hpp"
#include "capstan/firmware/estimate/law_monitor.hpp"
#include "capstan/firmware/estimate/motor_sensing.hpp"

namespace capstan {

/// What the law of one joint is given in this cycle.
struct LawInput {
  Measured<Q24> measured;
  FaultSet faults = 0;  ///< of the sensors of its motor and of those that pull at the joint beside it
};

/// What the law makes of one joint in this cycle.
struct JointEstimate {
  Q24 q2_rad;                              ///< joint angle
  Q24 q2_reported_rad;                     ///< what a joint sensor with the law's sensor effects would say
  Q24 error_bar_rad = ErrorBar::kUnknown;  ///< 95 of 100 times q2_reported_rad is no further from the joint
  ForceEstimate<Q24> joint_torque;         ///< by the law's tendons, if it has them
  bool valid = false;                      ///< all are of this cycle
  FaultSet faults = 0;                     ///< of the law itself
};

/// The law of one joint, and the monitor that says whether it still fits.
class Estimator {
 public:
  explicit Estimator(const AxisConfig& config);
  /// The law anew, and its memory. It is made in place: too large to be made and then copied within a cycle.
  void rt_make_law(const LawParameters<Q24>& parameters);
  /// The monitor anew; a warning goes away.
  void rt_make_monitor(const MonitorConfig& config) { monitor_.rt_configure(config); }
  void rt_forget() {
    law_.restart();
    monitor_.rt_unsettle();
    error_bar_.rt_forget();
  }
  /// In place of rt_step where there is no joint.
  auto rt_absent() -> const JointEstimate& { return estimate_ = {}; }
  /// @returns invalid with the last angles where a sensor failed: an estimate from an old value would be a guess
  auto rt_step(const AxisConfig& config, const MotorState& motor, const LawInput& input) -> const JointEstimate&;
  /// Judges whether the law still fits, when enough has been seen since the last time. One joint in a cycle is enough.
  void rt_judge_law(const AxisConfig& config) { monitor_.rt_judge(config); }

  [[nodiscard]] auto law() const -> const MotionLaw<Q24>& { return law_; }
  [[nodiscard]] auto monitor() const -> const LawMonitor& { return monitor_; }

 private:
  void rt_monitor(const AxisConfig& config, const MotorState& motor);

  MotionLaw<Q24> law_;
  LawMonitor monitor_;
  ErrorBar error_bar_;
  JointEstimate estimate_;
};

}  // namespace capstan
