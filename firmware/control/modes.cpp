// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/control/modes.hpp"

namespace capstan {
namespace {

constexpr SamplePeriod<Q24> kPeriod{kCycleRateHz};
// A reference may have waited for one cycle before it was used, and torque goes within one: 100 ms in all.
constexpr std::int32_t kLinkTimeoutCycles = 98;
// The joint's speed in torque control: by how far a low-pass lags, because a rate from counts is mostly noise.
constexpr Q24 kTrailS = Q24::from_double(0.02);
// An edge of a corridor lets go where the joint presses by this share of limits.joint_torque more than wanted: beyond
// what the servo's own ripple shows of it.
constexpr Q24 kPressedBack = Q24::from_double(1.0 / 32.0);
// Of limits.joint_acceleration, what a servo brakes a joint with that force control set in motion: with the whole of it
// a free tip went 0.034 rad beyond its corridor (microforceps, 0.03 N m, 0.15 rad to either side; 24 November 2026).
constexpr Q24 kBrakes = Q24::from_double(0.25);

auto out_of_range(const JointView& joint) -> bool {
  return is_outside(joint.config.limits, joint.estimate.q2_rad);
}

/// Of a trajectory of the motor, rad/s2: what is left to the joint is the motor's over beta.
auto motor_acceleration(const JointView& joint) -> Q24 {
  return abs(joint.law.per_beta(joint.config.limits.joint_acceleration_rad_s2));
}

}  // namespace

Modes::Modes(const AxisConfig& config) : controller_(config.control), force_(config.force) {
  trajectory_.rt_configure(config.limits);
}

void Modes::rt_configure(const AxisConfig& config) {
  controller_.rt_configure(config.control);
  trajectory_.rt_configure(config.limits);
}

void Modes::rt_observe(Q24 drive_nm, bool estimate_valid) {
  reference_.limits = 0;
  if (estimate_valid && force_.has_law()) {
    force_.rt_observe(drive_nm);
  }
}

auto Modes::rt_command(const JointView& joint, const Request& request) -> bool {
  const bool taken = rt_take(joint, request);
  const bool of_force = request.kind == Request::Kind::kForce || request.kind == Request::Kind::kFollowForce;
  if ((taken || request.kind == Request::Kind::kFollow) && request.kind != Request::Kind::kNone && !of_force) {
    corridor_.rt_lift();
  }
  return taken;
}

auto Modes::rt_take(const JointView& joint, const Request& request) -> bool {
  switch (request.kind) {
    case Request::Kind::kNone:
      return true;
    case Request::Kind::kZero:
    case Request::Kind::kArm:
    case Request::Kind::kDisarm:
    case Request::Kind::kRest:
      return false;
    case Request::Kind::kStop:
      if (in_torque()) {
        rt_hold_here(joint.estimate, Start::kKeepsTorque);
      }
      trajectory_.rt_stop(in_motor() ? motor_acceleration(joint) : joint.config.limits.joint_acceleration_rad_s2);
      following_ = false;
      braking_ = true;
      return true;
    case Request::Kind::kMove:
      return rt_take_move(joint, request);
    case Request::Kind::kMoveMotor:
      return rt_take_motor(joint, request);
    case Request::Kind::kFollow:
      return rt_take_stream(joint, request);
    case Request::Kind::kTorque:
      return rt_take_torque(joint, request);
    case Request::Kind::kForce:
    case Request::Kind::kFollowForce:
      return rt_take_force(joint, request);
  }
  return false;
}

auto Modes::rt_take_move(const JointView& joint, const Request& request) -> bool {
  const LimitConfig& limits = joint.config.limits;
  if (request.position_rad < limits.joint_min_rad || request.position_rad > limits.joint_max_rad ||
      request.speed_rad_s <= Q24{} || rt_motor_moves() || is_lost(limits, joint.estimate.q2_rad)) {
    return false;
  }
  if (reference_.mode != ControlMode::kPosition) {
    rt_hold_here(joint.estimate, Start::kKeepsTorque);
  }
  following_ = braking_ = false;
  trajectory_.rt_start(request.position_rad, std::min(request.speed_rad_s, limits.joint_speed_rad_s));
  return true;
}

auto Modes::rt_take_stream(const JointView& joint, const Request& request) -> bool {
  const LimitConfig& limits = joint.config.limits;
  if (rt_motor_moves() || is_lost(limits, joint.estimate.q2_rad)) {
    return false;
  }
  if (reference_.mode != ControlMode::kPosition) {
    rt_hold_here(joint.estimate, Start::kKeepsTorque);
  }
  const Q24 target = clamp(request.position_rad, limits.joint_min_rad, limits.joint_max_rad);
  const bool inside = target == request.position_rad;
  trajectory_.rt_stream(target, following_ ? cycles_since_reference_ : 1, reference_.q2_rad);
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
auto Modes::rt_take_motor(const JointView& joint, const Request& request) -> bool {
  const LimitConfig& limits = joint.config.limits;
  if (request.position_rad < limits.motor_min_rad || request.position_rad > limits.motor_max_rad ||
      request.speed_rad_s <= Q24{} || (!in_motor() && in_motion()) || out_of_range(joint)) {
    return false;
  }
  if (!in_motor()) {
    if (in_torque()) {
      rt_hold_here(joint.estimate, Start::kKeepsTorque);
    }
    if (start_ != Start::kNone) {
      static_cast<void>(rt_take_over(joint));
    }
    controller_.rt_start_motor();
    trajectory_.rt_reset(controller_.motor_reference());
    reference_.mode = ControlMode::kMotor;
    reference_.begins = true;
  }
  braking_ = false;
  trajectory_.rt_start(request.position_rad,
                       abs(joint.law.per_beta(std::min(request.speed_rad_s, limits.joint_speed_rad_s))));
  return true;
}

auto Modes::rt_take_torque(const JointView& joint, const Request& request) -> bool {
  torque_target_nm_ = request.torque_nm;
  trailing_q2_ = in_torque() ? trailing_q2_ : joint.estimate.q2_rad;
  reference_.mode = ControlMode::kTorque;
  following_ = true;
  braking_ = false;
  cycles_since_reference_ = 0;
  return true;
}

auto Modes::rt_take_force(const JointView& joint, const Request& request) -> bool {
  if (!force_.has_law() || request.torque_rate_nm_s <= Q24{} || request.corridor_rad < Q24{} ||
      (!in_force() && !corridor_.holds() && in_motion())) {
    return false;
  }
  const Q24 most = joint.config.limits.joint_torque_nm;
  const bool inside = abs(request.joint_torque_nm) <= most;
  const bool streamed = request.kind == Request::Kind::kFollowForce;
  if (!inside && !streamed) {
    return false;
  }
  if (!inside) {
    rt_flag(Limit::kJointTorque);
  }
  if (request.corridor_rad == Q24{} || !corridor_.is_there()) {  // about where the joint is now
    corridor_.rt_lay(joint.estimate.q2_rad, request.corridor_rad);
  } else {
    corridor_.rt_resize(request.corridor_rad);
  }
  if (!in_force() && !corridor_.holds()) {
    rt_control_force(joint);
  }
  force_.rt_aim(clamp(request.joint_torque_nm, -most, most), request.torque_rate_nm_s);
  following_ = streamed;
  braking_ = false;
  cycles_since_reference_ = 0;
  return inside;
}

void Modes::rt_control_force(const JointView& joint) {
  trailing_q2_ = joint.estimate.q2_rad;
  reference_.mode = ControlMode::kForce;
  force_.rt_start(joint.drive_nm);
}

void Modes::rt_hold_here(const JointEstimate& estimate, Start start) {
  trajectory_.rt_reset(estimate.q2_rad);
  reference_.q2_rad = estimate.q2_rad;
  reference_.joint_torque_nm = Q24{};
  reference_.mode = ControlMode::kPosition;
  reference_.begins = true;
  following_ = false;
  start_ = start;
}

auto Modes::rt_take_over(const JointView& joint) -> Q24 {
  const std::optional<Q24> kept_nm = start_ == Start::kKeepsTorque ? std::optional(joint.drive_nm) : std::nullopt;
  start_ = Start::kNone;
  return controller_.rt_start(joint.config.control, joint.law, joint.estimate.q2_rad, kept_nm, joint.effort);
}

void Modes::rt_rest() {
  following_ = false;
  corridor_.rt_lift();
  reference_.mode = ControlMode::kPosition;
  reference_.begins = true;
}

auto Modes::rt_stream_lost() -> bool {
  return following_ && ++cycles_since_reference_ > kLinkTimeoutCycles;
}

/// Too far, or faster than moves may be.
auto Modes::rt_runs_away(const JointView& joint) -> bool {
  constexpr Q30 kTrailGain = kPeriod.filter_gain(kTrailS);
  const Q24 q2 = joint.estimate.q2_rad;
  trailing_q2_ += (q2 - trailing_q2_) * kTrailGain;
  return out_of_range(joint) || abs(q2 - trailing_q2_) > joint.config.limits.joint_speed_rad_s * kTrailS;
}

/// Torque that drives the joint outward is not kept, but that of a steady motion taken; torque that withstands is kept.
void Modes::rt_go_to_edge(const JointView& joint) {
  const LimitConfig& limits = joint.config.limits;
  const bool streamed = following_;
  const bool outward = (force_.wanted() > Q24{}) == corridor_.at_high();
  rt_hold_here(joint.estimate, outward ? Start::kSteady : Start::kKeepsTorque);
  trajectory_.rt_start(clamp(corridor_.edge_rad(), limits.joint_min_rad, limits.joint_max_rad),
                       limits.joint_speed_rad_s);
  following_ = streamed;
}

/// From force control to an edge of its corridor, and back.
void Modes::rt_guard_corridor(const JointView& joint) {
  constexpr Q24 kPerTrail = Q24::from_double(50.0);
  static_assert(kPerTrail * kTrailS - Q24::from_int(1) < Q24::from_double(1e-5));
  const LimitConfig& limits = joint.config.limits;
  const Q24 q2 = joint.estimate.q2_rad;
  if (in_force()) {
    if (corridor_.rt_met(q2, (q2 - trailing_q2_) * kPerTrail, limits.joint_acceleration_rad_s2 * kBrakes)) {
      rt_go_to_edge(joint);
    }
  } else if (corridor_.holds() && start_ == Start::kNone &&
             corridor_.pressed_back(force_.estimate().force, force_.goal(), limits.joint_torque_nm * kPressedBack)) {
    corridor_.rt_let_go(q2);
    rt_control_force(joint);
  }
  if (corridor_.holds()) {
    rt_flag(Limit::kCorridor);
  }
}

auto Modes::rt_next_position(const LimitConfig& limits) -> Q24 {
  if (!following_ || corridor_.holds()) {  // of a stream of torques nothing is asked of the position
    return trajectory_.rt_step(limits.joint_acceleration_rad_s2);
  }
  const Q24 next = trajectory_.rt_follow(limits);
  if (!trajectory_.on_stream()) {
    rt_flag(Limit::kReference);
  }
  return next;
}

auto Modes::rt_torque(const JointView& joint) -> Q24 {
  if (in_torque() ? rt_runs_away(joint) : in_motor() && out_of_range(joint)) {
    rt_flag(Limit::kReference);
    if (corridor_.is_there() && !out_of_range(joint)) {
      corridor_.rt_take(joint.estimate.q2_rad > trailing_q2_);
      rt_go_to_edge(joint);
    } else {
      rt_hold_here(joint.estimate, Start::kSteady);
      corridor_.rt_lift();
    }
  }
  rt_guard_corridor(joint);
  if (in_torque()) {
    reference_.q2_rad = joint.estimate.q2_rad;  // nothing is asked of the position
    return in_force() ? rt_force(joint.config.force) : torque_target_nm_;
  }
  if (start_ != Start::kNone) {
    return rt_take_over(joint);
  }
  if (in_motor()) {
    reference_.q2_rad = joint.estimate.q2_rad;
    reference_.q1_rad = trajectory_.rt_step(motor_acceleration(joint));
    return controller_.rt_update_motor(joint.config.control, joint.law, reference_.q1_rad, joint.effort);
  }
  reference_.q2_rad = rt_next_position(joint.config.limits);
  return controller_.rt_update(joint.config, joint.law, reference_.q2_rad, joint.estimate.q2_rad, joint.effort);
}

auto Modes::rt_step(const JointView& joint) -> const JointReference& {
  reference_.torque_nm = rt_torque(joint);
  if (in_torque()) {
    reference_.q1_rad = joint.motor.q1_rad;
  } else if (!in_motor()) {
    reference_.q1_rad = controller_.motor_reference();
  }
  reference_.moving = in_motion();
  return reference_;
}

auto Modes::rt_idle(const MotorState& motor) -> const JointReference& {
  reference_.torque_nm = Q24{};
  reference_.q1_rad = motor.q1_rad;
  reference_.moving = false;
  return reference_;
}

auto Modes::rt_force(const ForceConfig& config) -> Q24 {
  const Q24 torque = force_.rt_update(config);
  reference_.joint_torque_nm = force_.wanted();
  if (force_.out_of_reach()) {
    rt_flag(Limit::kJointTorque);
  }
  return torque;
}

}  // namespace capstan
