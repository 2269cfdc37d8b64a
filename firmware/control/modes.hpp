// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <utility>

#include "capstan/firmware/control/controller.hpp"
#include "capstan/firmware/control/corridor.hpp"
#include "capstan/firmware/control/force_control.hpp"
#include "capstan/firmware/control/request.hpp"
#include "capstan/firmware/control/trajectory.hpp"
#include "capstan/firmware/estimate/estimator.hpp"

namespace capstan {

/// Normal, reported, and each names the setting behind it; not faults.
enum class Limit : std::uint8_t {
  kNone = 0,
  kCurrent = 1,
  kThermal = 2,
  kRate = 4,
  kMotorTravel = 8,
  kReference = 16,
  kJointTorque = 32,
  kCorridor = 64,  ///< the joint is held at its edge
};
using LimitSet = std::uint8_t;
constexpr auto bit(Limit limit) -> LimitSet {
  return static_cast<LimitSet>(limit);
}

struct LimitInfo {
  Limit limit;
  const char* name;
  const char* settings;  ///< the parameters behind it
};
/// One table for shell, signal, DBC file and documentation; in the order of the bits.
inline constexpr std::array<LimitInfo, 7> kLimitTable = {{
    {Limit::kCurrent, "current", "limits.current"},
    {Limit::kThermal, "continuous_current", "limits.continuous_current"},
    {Limit::kRate, "current_rate", "limits.current_rate"},
    {Limit::kMotorTravel, "motor_travel", "limits.motor_min/motor_max"},
    {Limit::kReference, "reference", "limits.joint_min/joint_max/joint_speed"},
    {Limit::kJointTorque, "joint_torque", "limits.joint_torque or the reach of the force law"},
    {Limit::kCorridor, "corridor", "the corridor of force control"},
}};
static_assert(bit(kLimitTable.back().limit) == 1U << (kLimitTable.size() - 1));

/// What a joint is controlled by.
enum class ControlMode : std::uint8_t {
  kPosition,  ///< through the estimated joint angle
  kTorque,    ///< of the motor
  kForce,     ///< the joint's torque, through the inverse force law
  kMotor,     ///< the motor's angle
};

/// By its law the joint is outside its limits, further than the margin.
constexpr auto is_outside(const LimitConfig& limits, Q24 q2_rad, Q24 margin_rad = {}) -> bool {
  return q2_rad > limits.joint_max_rad + margin_rad || q2_rad < limits.joint_min_rad - margin_rad;
}
/// Further than it may be from a reference: the law is another joint's, or its zero is wrong. A way back into the
/// limits would take the motor as far the other way.
constexpr auto is_lost(const LimitConfig& limits, Q24 q2_rad) -> bool {
  return is_outside(limits, q2_rad, limits.following_error_rad);
}

/// What is wanted of one joint in this cycle.
struct JointReference {
  Q24 q2_rad;
  Q24 q1_rad;           ///< where the servo holds the motor; its own angle while there is none
  Q24 joint_torque_nm;  ///< in force control
  Q24 torque_nm;        ///< of the motor, to answer with
  ControlMode mode = ControlMode::kPosition;
  bool moving = false;  ///< the reference is, or comes as a stream
  bool begins = false;  ///< it has nothing to do with the last cycle's: whoever compares the two begins anew
  LimitSet limits = 0;  ///< that the reference met
};

/// What a mode needs to know about its joint in this cycle.
struct JointView {
  const AxisConfig& config;
  const MotionLaw<Q24>& law;
  const MotorState& motor;
  const JointEstimate& estimate;
  Q24 drive_nm;                            ///< torque that the motor was told in the last cycle
  const TorqueLaw<Q24>* effort = nullptr;  ///< for feedforward; nullptr: that of a steady motion
};

/// Ways of control of one joint: takes commands, goes from one to the other without a jump of torque, and says what is
/// wanted of the motor.
class Modes {
 public:
  explicit Modes(const AxisConfig& config);
  void rt_configure(const AxisConfig& config);
  /// @param lost_rad  way that the motor goes without the joint, by the law
  void rt_expect_lost_motion(Q24 lost_rad) { controller_.rt_expect_lost_motion(lost_rad); }
  /// Anew, after rt_configure: the force law refers to its parameters. @param force  outlives this object
  void rt_make_force_law(const ForceConfig& force) { force_.rt_configure(force); }
  /// The first call of a cycle: the force law learns what the motor was told in the last one.
  void rt_observe(Q24 drive_nm, bool estimate_valid);
  /// Takes a request. Only while energised. A move outside the limits or without speed is refused, and so is force
  /// control without a law, without a rate, with a negative corridor or of a joint that moves: false, and nothing
  /// changes. A streamed reference
  /// outside the limits is cut to them: false, and followed.
  auto rt_command(const JointView& joint, const Request& request) -> bool;
  /// Without torque nothing is wanted.
  void rt_rest();
  /// Gets ready for torque: stand where the joint is.
  void rt_arm(const JointEstimate& estimate) { rt_hold_here(estimate, Start::kSteady); }
  /// The torque to answer with. Only while energised.
  auto rt_step(const JointView& joint) -> const JointReference&;
  /// What a joint without torque is said to want: to be where it is.
  auto rt_idle(const MotorState& motor) -> const JointReference&;
  /// No streamed reference has come for 100 ms. Once a cycle.
  auto rt_stream_lost() -> bool;
  /// Whether the reference has begun anew since this was asked last.
  auto rt_took_begin() -> bool { return std::exchange(reference_.begins, false); }

  [[nodiscard]] auto reference() const -> const JointReference& { return reference_; }
  [[nodiscard]] auto force() const -> const ForceControl& { return force_; }
  [[nodiscard]] auto in_motion() const -> bool {
    return following_ || !trajectory_.finished() || (in_force() && !force_.arrived());
  }
  /// References stream to it, or did until they were lost.
  [[nodiscard]] auto streamed() const -> bool { return following_; }
  /// It was told to stop, and to nothing else since.
  [[nodiscard]] auto braking() const -> bool { return braking_; }
  /// Torque is commanded, the motor's or the joint's, not a position.
  [[nodiscard]] auto in_torque() const -> bool { return reference_.mode == ControlMode::kTorque || in_force(); }
  /// The motor's angle is.
  [[nodiscard]] auto in_motor() const -> bool { return reference_.mode == ControlMode::kMotor; }
  /// The joint's torque is.
  [[nodiscard]] auto in_force() const -> bool { return reference_.mode == ControlMode::kForce; }

 private:
  /// How position control takes over in this cycle: where the joint is, with the torque of a steady motion or the one
  /// that the motor has. A move or a stream that makes it take over begins in the next cycle.
  enum class Start : std::uint8_t { kNone, kSteady, kKeepsTorque };
  void rt_hold_here(const JointEstimate& estimate, Start start);
  auto rt_take(const JointView& joint, const Request& request) -> bool;
  auto rt_take_over(const JointView& joint) -> Q24;
  auto rt_take_move(const JointView& joint, const Request& request) -> bool;
  auto rt_take_stream(const JointView& joint, const Request& request) -> bool;
  auto rt_take_motor(const JointView& joint, const Request& request) -> bool;
  auto rt_take_torque(const JointView& joint, const Request& request) -> bool;
  auto rt_take_force(const JointView& joint, const Request& request) -> bool;
  void rt_control_force(const JointView& joint);
  // Both are called once, in every cycle.
  [[gnu::always_inline]] inline auto rt_torque(const JointView& joint) -> Q24;
  [[gnu::always_inline]] inline void rt_guard_corridor(const JointView& joint);
  auto rt_force(const ForceConfig& config) -> Q24;
  auto rt_next_position(const LimitConfig& limits) -> Q24;
  auto rt_runs_away(const JointView& joint) -> bool;
  void rt_go_to_edge(const JointView& joint);
  [[nodiscard]] auto rt_motor_moves() const -> bool { return in_motor() && in_motion(); }
  void rt_flag(Limit limit) { reference_.limits = static_cast<LimitSet>(reference_.limits | bit(limit)); }

  Controller controller_;
  Trajectory trajectory_;
  ForceControl force_;
  Corridor corridor_;  // of force control, in force and where its edge holds the joint
  JointReference reference_;
  bool following_ = false;  // a stream, of positions or torques
  bool braking_ = false;
  Start start_ = Start::kNone;
  Q24 torque_target_nm_;
  Q24 trailing_q2_;  // in torque: the joint's angle, as long ago as kTrailS
  std::int32_t cycles_since_reference_ = 0;
};

}  // namespace capstan
