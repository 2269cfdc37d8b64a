// SPDX-License-Identifier: Apache-2.0
// What an axis is asked for, and the torque that it wants to answer with.
#include "firmware/axis.hpp"

namespace capstan {
namespace {

constexpr SamplePeriod<Q24> kPeriod{kCycleRateHz};

}  // namespace

auto Axis::rt_command(const AxisCommand& command) -> bool {
  if (!fitted()) {
    return false;
  }
  switch (command.kind) {
    case AxisCommand::Kind::kNone:
      return true;
    case AxisCommand::Kind::kZero:
      return false;
    case AxisCommand::Kind::kStop:
      if (in_torque()) {
        rt_hold_here(Start::kKeepsTorque);
      }
      trajectory_.rt_stop(rt_acceleration());
      following_ = false;
      braking_ = true;
      return true;
    case AxisCommand::Kind::kMove:
      return rt_take_move(command);
    case AxisCommand::Kind::kMoveMotor:
      return rt_take_motor(command);
    case AxisCommand::Kind::kFollow:
      return rt_take_stream(command);
    case AxisCommand::Kind::kTorque:
      return rt_take_torque(command);
    case AxisCommand::Kind::kForce:
    case AxisCommand::Kind::kFollowForce:
      return rt_take_force(command);
  }
  return false;
}

auto Axis::rt_take_move(const AxisCommand& command) -> bool {
  const LimitConfig& limits = config_.limits;
  if (command.position_rad < limits.joint_min_rad || command.position_rad > limits.joint_max_rad ||
      command.speed_rad_s <= Q24{} || rt_motor_moves()) {
    return false;
  }
  if (mode_ != ControlMode::kPosition) {
    rt_hold_here(Start::kKeepsTorque);
  }
  following_ = braking_ = false;
  trajectory_.rt_start(command.position_rad, std::min(command.speed_rad_s, limits.joint_speed_rad_s));
  return true;
}

auto Axis::rt_take_stream(const AxisCommand& command) -> bool {
  const LimitConfig& limits = config_.limits;
  if (rt_motor_moves()) {
    return false;
  }
  if (mode_ != ControlMode::kPosition) {
    rt_hold_here(Start::kKeepsTorque);
  }
  follow_target_ = clamp(command.position_rad, limits.joint_min_rad, limits.joint_max_rad);
  const bool inside = follow_target_ == command.position_rad;
  if (!inside) {
    rt_flag(Limit::kReference);
  }
  following_ = true;
  braking_ = false;
  cycles_since_reference_ = 0;
  return inside;
}

/// In position control the motor goes on from where its servo holds it; from torque, from where a servo would have to
/// hold it for that torque.
auto Axis::rt_take_motor(const AxisCommand& command) -> bool {
  const LimitConfig& limits = config_.limits;
  if (command.position_rad < limits.motor_min_rad || command.position_rad > limits.motor_max_rad ||
      command.speed_rad_s <= Q24{} || (!in_motor() && in_motion())) {
    return false;
  }
  if (!in_motor()) {
    if (in_torque()) {
      rt_hold_here(Start::kKeepsTorque);
    }
    if (start_ != Start::kNone) {
      static_cast<void>(rt_take_over());
    }
    controller_.rt_start_motor();
    trajectory_.rt_reset(controller_.motor_reference());
    mode_ = ControlMode::kMotor;
    still_cycles_ = 0;  // the reference is another one
  }
  braking_ = false;
  trajectory_.rt_start(command.position_rad,
                       abs(law_.per_beta(std::min(command.speed_rad_s, limits.joint_speed_rad_s))));
  return true;
}

auto Axis::rt_take_torque(const AxisCommand& command) -> bool {
  torque_target_nm_ = command.torque_nm;
  trailing_q2_ = in_torque() ? trailing_q2_ : telemetry_.q2_rad;
  mode_ = ControlMode::kTorque;
  following_ = true;
  braking_ = false;
  cycles_since_reference_ = 0;
  return true;
}

auto Axis::rt_take_force(const AxisCommand& command) -> bool {
  if (!force_.has_law() || command.torque_rate_nm_s <= Q24{} || (!in_force() && in_motion())) {
    return false;
  }
  const Q24 most = config_.limits.joint_torque_nm;
  const bool inside = abs(command.joint_torque_nm) <= most;
  const bool streamed = command.kind == AxisCommand::Kind::kFollowForce;
  if (!inside && !streamed) {
    return false;
  }
  if (!inside) {
    rt_flag(Limit::kJointTorque);
  }
  if (!in_force()) {
    trailing_q2_ = telemetry_.q2_rad;
    mode_ = ControlMode::kForce;
    force_.rt_start(telemetry_.drive_a * config_.motor.torque_per_current_nm_per_a);
  }
  force_.rt_aim(clamp(command.joint_torque_nm, -most, most), command.torque_rate_nm_s);
  following_ = streamed;
  braking_ = false;
  cycles_since_reference_ = 0;
  return inside;
}

void Axis::rt_hold_here(Start start) {
  trajectory_.rt_reset(telemetry_.q2_rad);
  telemetry_.q2_reference_rad = telemetry_.q2_rad;
  telemetry_.joint_torque_reference_nm = Q24{};
  following_ = false;
  mode_ = ControlMode::kPosition;
  start_ = start;
  still_cycles_ = 0;
}

auto Axis::rt_take_over() -> Q24 {
  const std::optional<Q24> kept_nm = start_ == Start::kKeepsTorque
                                         ? std::optional(telemetry_.drive_a * config_.motor.torque_per_current_nm_per_a)
                                         : std::nullopt;
  start_ = Start::kNone;
  return controller_.rt_start(config_.control, law_, telemetry_.q2_rad, kept_nm);
}

void Axis::rt_arm() {
  rt_hold_here(Start::kSteady);
  last_drive_a_ = Q24{};
}

auto Axis::rt_out_of_range() const -> bool {
  return telemetry_.q2_rad > config_.limits.joint_max_rad || telemetry_.q2_rad < config_.limits.joint_min_rad;
}

/// Too far, or faster than moves may be. By how far a low-pass lags, because a rate from counts is mostly noise.
auto Axis::rt_runs_away() -> bool {
  constexpr Q24 kTrailS = Q24::from_double(0.02);
  constexpr Q30 kTrailGain = kPeriod.filter_gain(kTrailS);
  trailing_q2_ += (telemetry_.q2_rad - trailing_q2_) * kTrailGain;
  return rt_out_of_range() || abs(telemetry_.q2_rad - trailing_q2_) > config_.limits.joint_speed_rad_s * kTrailS;
}

auto Axis::rt_reference() -> Q24 {
  if (!following_) {
    return trajectory_.rt_step(config_.limits.joint_acceleration_rad_s2);
  }
  // A streamed reference may not run faster than moves may, so a wrong first value can not throw the joint.
  const Q24 step = per_cycle(config_.limits.joint_speed_rad_s);
  const Q24 last = telemetry_.q2_reference_rad;
  const Q24 next = clamp(follow_target_, last - step, last + step);
  if (next != follow_target_) {
    rt_flag(Limit::kReference);
  }
  trajectory_.rt_track(next);
  return next;
}

auto Axis::rt_control() -> Q24 {
  if (in_torque() ? rt_runs_away() : in_motor() && rt_out_of_range()) {
    rt_flag(Limit::kReference);
    rt_hold_here(Start::kSteady);
  }
  if (in_torque()) {
    telemetry_.q2_reference_rad = telemetry_.q2_rad;  // nothing is asked of the position
    return in_force() ? rt_force() : torque_target_nm_;
  }
  if (start_ != Start::kNone) {
    return rt_take_over();
  }
  if (in_motor()) {
    telemetry_.q2_reference_rad = telemetry_.q2_rad;
    telemetry_.q1_reference_rad = trajectory_.rt_step(rt_acceleration());
    return controller_.rt_update_motor(config_.control, law_, telemetry_.q1_reference_rad);
  }
  telemetry_.q2_reference_rad = rt_reference();
  return controller_.rt_update(config_, law_, telemetry_.q2_reference_rad, telemetry_.q2_rad);
}

/// Of the trajectory, rad/s2: what is left to the joint is the motor's over beta.
auto Axis::rt_acceleration() const -> Q24 {
  const Q24 joint = config_.limits.joint_acceleration_rad_s2;
  return in_motor() ? abs(law_.per_beta(joint)) : joint;
}

auto Axis::rt_force() -> Q24 {
  const Q24 torque = force_.rt_update(config_.force);
  telemetry_.joint_torque_reference_nm = force_.wanted();
  if (force_.out_of_reach()) {
    rt_flag(Limit::kJointTorque);
  }
  return torque;
}

}  // namespace capstan
