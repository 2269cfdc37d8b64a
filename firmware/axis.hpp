// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "firmware/controller.hpp"
#include "firmware/encoder_scale.hpp"
#include "firmware/faults.hpp"
#include "firmware/force_control.hpp"
#include "firmware/law_monitor.hpp"
#include "firmware/trajectory.hpp"
#include "hal/joint_io.hpp"

namespace capstan {

/// What one joint is asked to do in a cycle.
struct AxisCommand {
  enum class Kind : std::uint8_t {
    kNone,    ///< go on with what it does
    kMove,    ///< to position_rad at no more than speed_rad_s
    kStop,    ///< brake and stand
    kFollow,  ///< a streamed reference: position_rad now, the next one within 100 ms
    kZero,    ///< the motor stands at position_rad, whatever its encoder says; only without torque
    kTorque,  ///< streamed too: motor-side torque_nm instead of a position. A joint that gets faster than its moves may
              ///< or leaves its range is held where it then is
    kForce,  ///< force control: the joint's torque to joint_torque_nm at torque_rate_nm_s, and there from then on; from
             ///< rest only. Watched as kTorque is
    kFollowForce,  ///< the same as a stream, the next one within 100 ms
    kMoveMotor,    ///< motor position control: the motor to position_rad, so that the joint gets no faster than
                   ///< speed_rad_s makes it and accelerates no more; from rest only. A joint that leaves its range is
                   ///< held there
  };
  Kind kind = Kind::kNone;
  Q24 position_rad{};
  Q24 speed_rad_s{};
  Q24 torque_nm{};
  Q24 joint_torque_nm{};
  Q24 torque_rate_nm_s{};
};

/// Normal, reported, and each names the setting behind it; not faults.
enum class Limit : std::uint8_t {
  kNone = 0,
  kCurrent = 1,       ///< limits.current
  kThermal = 2,       ///< limits.continuous_current
  kRate = 4,          ///< limits.current_rate
  kMotorTravel = 8,   ///< limits.motor_min, limits.motor_max
  kReference = 16,    ///< limits.joint_min, joint_max, joint_speed
  kJointTorque = 32,  ///< limits.joint_torque, or the end of what the force law reaches
};

/// What a joint is controlled by.
enum class ControlMode : std::uint8_t {
  kPosition,  ///< through the estimated joint angle
  kTorque,    ///< of the motor
  kForce,     ///< the joint's torque, through the inverse force law
  kMotor,     ///< the motor's angle
};

/// One joint's numbers of the last cycle, for shell, log and telemetry.
struct AxisTelemetry {
  Q24 q1_rad;
  Q24 tau_nm;
  Q24 q2_rad;           ///< estimated joint angle
  Q24 q2_reported_rad;  ///< what a joint sensor with the law's sensor effects would say
  Q24 q2_reference_rad;
  Q24 q1_reference_rad;           ///< where the servo holds the motor; its own angle while there is none
  Q24 current_a;                  ///< measured
  Q24 drive_a;                    ///< commanded
  Q24 joint_torque_nm;            ///< by the force law, 0 without one
  Q24 joint_torque_reference_nm;  ///< wanted, in force control
  Q24 misfit;                     ///< how near the monitor is to a warning, 0 to 1
  FaultSet faults = 0;            ///< present now
  std::uint8_t limits = 0;
  bool estimate_valid = false;
  bool joint_torque_known = false;  ///< the force law's past no longer matters
  ForcePhase joint_torque_phase = ForcePhase::kUnknown;
  WarningSet warnings = 0;
  ControlMode mode = ControlMode::kPosition;
  bool moving = false;  ///< its reference is, or comes as a stream
};

/// Estimator, monitors, controller and gate of one joint. The functions are called once a cycle in the order they stand
/// here.
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
  /// Converts the sensors.
  void rt_sense(const AxisSensed& sensed);
  /// Runs the law. `other`: the axis whose motor pulls at this one; nullptr if there is none. `temperature_c`: the last
  /// that was measured, or the mark of a missing value.
  void rt_estimate(const Axis* other, Q24 temperature_c = ScalarTraits<Q24>::missing());
  /// Judges whether the law still fits, when enough has been seen since the last time. One joint in a cycle is enough.
  void rt_judge_law() { monitor_.rt_judge(config_.monitor); }
  /// Faults this joint sees now. `energised` adds those that need torque to mean anything.
  [[nodiscard]] auto rt_faults(bool energised) -> FaultSet;
  /// Takes a command. Only while energised. A move outside the limits or without speed is refused, and so is force
  /// control without a law, without a rate or of a joint that moves: false, and nothing changes. A streamed reference
  /// outside the limits is cut to them: false, and followed.
  auto rt_command(const AxisCommand& command) -> bool;
  /// Gets ready for torque: stand where the joint is.
  void rt_arm();
  [[nodiscard]] auto in_motion() const -> bool {
    return following_ || !trajectory_.finished() || (in_force() && !force_.arrived());
  }
  /// It was told to stop, and to nothing else since.
  [[nodiscard]] auto braking() const -> bool { return braking_; }
  /// Torque is commanded, the motor's or the joint's, not a position.
  [[nodiscard]] auto in_torque() const -> bool { return mode_ == ControlMode::kTorque || mode_ == ControlMode::kForce; }
  /// The motor's angle is.
  [[nodiscard]] auto in_motor() const -> bool { return mode_ == ControlMode::kMotor; }
  /// The joint's torque is.
  [[nodiscard]] auto in_force() const -> bool { return mode_ == ControlMode::kForce; }
  /// Motor-side torque wanted, N m.
  auto rt_control() -> Q24;
  /// The one gate every output passes: state, thermal and peak current, tendon travel, rate.
  auto rt_limit(Q24 torque_nm, bool energised) -> AxisDrive;

  [[nodiscard]] auto config() const -> const AxisConfig& { return config_; }
  [[nodiscard]] auto fitted() const -> bool { return config_.motor.fitted != 0; }
  [[nodiscard]] auto telemetry() const -> const AxisTelemetry& { return telemetry_; }

 private:
  void rt_count(const AxisSensed& sensed);
  void rt_monitor();
  auto rt_take_move(const AxisCommand& command) -> bool;
  auto rt_take_stream(const AxisCommand& command) -> bool;
  auto rt_take_motor(const AxisCommand& command) -> bool;
  auto rt_take_torque(const AxisCommand& command) -> bool;
  auto rt_take_force(const AxisCommand& command) -> bool;
  auto rt_force() -> Q24;
  /// Monitors of the motor's current and heat.
  [[nodiscard]] auto rt_current_faults() -> FaultSet;
  [[nodiscard]] auto rt_supply_fault() -> FaultSet;
  /// Monitors of what the joint was asked to do.
  [[nodiscard]] auto rt_motion_faults() -> FaultSet;
  auto rt_reference() -> Q24;
  /// How position control takes over in this cycle: where the joint is, with the torque of a steady motion or the one
  /// that the motor has. A move or a stream that makes it take over begins in the next cycle.
  enum class Start : std::uint8_t { kNone, kSteady, kKeepsTorque };
  void rt_hold_here(Start start);
  auto rt_take_over() -> Q24;
  [[nodiscard]] auto rt_out_of_range() const -> bool;
  [[nodiscard]] auto rt_runs_away() -> bool;
  [[nodiscard]] auto rt_motor_moves() const -> bool { return in_motor() && in_motion(); }
  [[nodiscard]] auto rt_acceleration() const -> Q24;
  void rt_warm();
  /// True for a current that pulls further out where the tendon travel ends.
  [[nodiscard]] auto rt_outward(Q24 current_a) const -> bool;
  void rt_flag(Limit limit) { telemetry_.limits |= static_cast<std::uint8_t>(limit); }

  /// What follows from the parameters, so that the cycle divides nothing.
  struct Scales {
    explicit Scales(const AxisConfig& config);
    EncoderScale encoder;
    Reciprocal<Q24> per_torque_constant;
    Reciprocal<Q24> per_continuous_current;
    Q30 thermal_gain;
  };

  AxisConfig config_;
  Scales scales_;
  MotionLaw<Q24> law_;
  Controller controller_;
  Trajectory trajectory_;
  ForceControl force_;
  LawMonitor monitor_;
  AxisTelemetry telemetry_;

  std::int64_t counts_ = 0;  // unwrapped
  std::int32_t last_counts_ = 0;
  Q24 joint_rad_;           // by its sensor
  bool has_joint_ = false;  // in this cycle
  bool counting_ = false;
  bool zeroed_ = false;  // counts_ are the operator's, not the encoder's first ones
  bool lost_ = false;    // the encoder jumped, so counts_ may be anything until rt_zero
  FaultSet sensor_faults_ = 0;

  bool following_ = false;  // a stream, of positions or torques
  bool braking_ = false;
  ControlMode mode_ = ControlMode::kPosition;
  Start start_ = Start::kNone;
  Q24 follow_target_;
  Q24 torque_target_nm_;
  Q24 trailing_q2_;  // in torque: the joint's angle, as long ago as kTrailS
  std::int32_t cycles_since_reference_ = 0;
  std::int32_t cycles_off_reference_ = 0;
  std::int32_t cycles_over_current_ = 0;
  std::int32_t cycles_mismatched_ = 0;
  std::int32_t cycles_starved_ = 0;
  bool supply_low_ = false;  // in this cycle
  bool starved_ = false;
  std::int64_t still_counts_ = 0;  // where the encoder stands since ...
  std::int32_t still_cycles_ = 0;
  Q24 still_reference_;  // ... the reference was here
  Q24 heat_;             // of the winding, 1 = what the continuous current leads to
  bool hot_ = false;
  Q24 last_drive_a_;
};

}  // namespace capstan
