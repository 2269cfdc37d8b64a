// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/estimate/effort_stage.hpp"
#include "capstan/firmware/safety/gate.hpp"
#include "capstan/firmware/safety/limit_cycle.hpp"
#include "capstan/firmware/safety/monitors.hpp"
#include "capstan/firmware/safety/motor_observer.hpp"
#include "capstan/firmware/telemetry/axis_telemetry.hpp"

namespace capstan {

/// One joint: its parameters, and the stages that a cycle's values pass through. Each stage is handed what the ones
/// before it made; none reads what another keeps.
class Axis {
 public:
  explicit Axis(const AxisConfig& config);
  Axis(const Axis&) = delete;  // the force law refers to the parameters in here
  auto operator=(const Axis&) -> Axis& = delete;
  ~Axis() = default;

  /// New parameters. The law and its memory are made anew only if its parameters or the scale of its arguments changed;
  /// torque must be off then (needs_rest).
  void rt_configure(const AxisConfig& config);
  /// From the next rt_estimate on the motor stands at this angle, rad; the law's memory begins anew. Clears an encoder
  /// jump, after which the position is not known. Torque must be off.
  void rt_zero(Q24 q1_rad);
  /// Heat of the winding at the start, and now; see Gate.
  void begin_at_heat(Q24 heat) { gate_.begin_at_heat(heat); }
  [[nodiscard]] auto heat() const -> Q24 { return gate_.heat(); }
  /// Converts the sensors. What this and rt_estimate return is good until they are called again.
  auto rt_sense(const AxisSensed& sensed) -> const MotorState&;
  /// Runs the laws.
  auto rt_estimate(const MotorState& motor, const LawInput& input) -> const JointEstimate&;
  /// Judges whether the law still fits, when enough has been seen since the last time. One joint in a cycle is enough.
  void rt_judge_law() { estimator_.rt_judge_law(config_); }
  /// Takes a request, as Modes::rt_command; false too where there is no joint.
  auto rt_command(const MotorState& motor, const JointEstimate& estimate, const Request& request) -> bool;
  /// Faults this joint sees now. `energised` adds those that need torque to mean anything.
  auto rt_faults(const MotorState& motor, const JointEstimate& estimate, bool energised) -> FaultSet;
  /// Gets ready for torque: stand where the joint is. @param cautious  within cautious_limits() until the next time, if
  /// the motor observer is not commissioned
  void rt_arm(const JointEstimate& estimate, bool cautious = false);
  /// What is wanted of the motor.
  auto rt_reference(const MotorState& motor, const JointEstimate& estimate, bool energised) -> const JointReference&;
  /// The one gate every output passes.
  auto rt_drive(const MotorState& motor, Q24 torque_nm, bool energised) -> AxisDrive;
  /// The last call of a cycle. `pitch`: of the joint that this one turns on as a wrist's jaw; nullptr if it is none.
  void rt_report(const MotorState& motor, const JointEstimate& estimate, const JointEstimate* pitch, FaultSet faults);

  /// The motor's direction switch, by the law's last sample.
  [[nodiscard]] auto goes_forward() const -> bool { return estimator_.law().sample().forward; }
  [[nodiscard]] auto in_motion() const -> bool { return modes_.in_motion(); }
  [[nodiscard]] auto streamed() const -> bool { return modes_.streamed(); }
  [[nodiscard]] auto braking() const -> bool { return modes_.braking(); }
  [[nodiscard]] auto in_torque() const -> bool { return modes_.in_torque(); }
  [[nodiscard]] auto config() const -> const AxisConfig& { return config_; }
  [[nodiscard]] auto fitted() const -> bool { return config_.motor.fitted != 0; }
  [[nodiscard]] auto telemetry() const -> const AxisTelemetry& { return telemetry_; }

 private:
  [[nodiscard]] auto view(const MotorState& motor, const JointEstimate& estimate) const -> JointView {
    return {config_, estimator_.law(), motor, estimate, gate_.drive_nm(), effort_.feedforward(config_.effort)};
  }

  void rt_expect_lost_motion();
  void rt_limit();

  AxisConfig config_;
  LimitConfig given_limits_;  // of the parameters; those in force are in config_
  bool cautious_ = false;
  Q24 dither_nm_;
  bool looked_ = false;  // the observer's own torque was on in the last cycle
  MotorSensing sensing_;
  Estimator estimator_;
  EffortStage effort_;
  Modes modes_;
  Monitors monitors_;
  Gate gate_;
  MotorObserver observer_;
  LimitCycleWatch limit_cycle_;
  ForceErrorBar force_error_;
  AxisTelemetry telemetry_;
};

}  // namespace capstan
