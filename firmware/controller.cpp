// SPDX-License-Identifier: Apache-2.0
#include "firmware/controller.hpp"

namespace capstan {
namespace {

constexpr SamplePeriod<Q24> kPeriod{kCycleRateHz};
constexpr Q24 kOne = Q24::from_int(1);
constexpr Q24 kHalf = Q24::from_double(0.5);

// References are exact, so their direction needs only a threshold above the rounding of a slow stream.
constexpr ConditionerShape<Q24> kReferenceShape{.direction_threshold_rad = Q24::from_double(1e-5),
                                                .rate_time_constant_s = Q24::from_double(0.002)};

constexpr auto mix(Q24 backward, Q24 forward, Q24 branch) -> Q24 {
  return backward + (forward - backward) * branch;
}

}  // namespace

Controller::Controller() : reference_(kPeriod, kReferenceShape) {}

void Controller::rt_start(const ControlConfig& gains, const MotionLaw<Q24>& law, Q24 q2_rad) {
  reference_ = SampleConditioner<Q24>(kPeriod, kReferenceShape);
  branch_ = kHalf;
  last_q2_ = q2_rad;
  integral_ = law.sample().q1 - rt_inverse(gains, law, q2_rad, Q24{});
}

auto Controller::rt_inverse(const ControlConfig& gains, const MotionLaw<Q24>& law, Q24 q2, Q24 motor_speed) const
    -> Q24 {
  Sample<Q24> motion;
  motion.dq1 = motor_speed;
  motion.tau = gains.torque_backward_nm;
  motion.forward = false;
  const Q24 backward = law.invert(q2, motion);
  motion.tau = gains.torque_forward_nm;
  motion.forward = true;
  return mix(backward, law.invert(q2, motion), branch_);
}

auto Controller::rt_pid(const ControlConfig& gains, Q24 error, Q24 movement) -> Q24 {
  // The start value may lie outside the limit; the integral may then only shrink.
  const Q24 limit = abs(integral_) < gains.integral_limit_rad ? gains.integral_limit_rad : abs(integral_);
  integral_ = clamp(integral_ + per_cycle(gains.ki_per_s * error), -limit, limit);
  return gains.kp * error + integral_ - gains.kd_s * kPeriod.rate_of(movement);
}

auto Controller::rt_update(const AxisConfig& config, const MotionLaw<Q24>& law, Q24 q2_reference, Q24 q2) -> Q24 {
  const ControlConfig& gains = config.control;
  // Where the transmission is crossed (beta < 0) the motor runs against the joint, and so must every correction.
  const bool crossed = law.beta() < Q24{};
  const auto motor_side = [crossed](Q24 joint_side) { return crossed ? -joint_side : joint_side; };

  const Sample<Q24> reference = reference_.update(q2_reference, Q24{});
  if (reference.dq1 != Q24{}) {
    const Q24 target = reference.forward != crossed ? kOne : Q24{};
    branch_ += (target - branch_) * kPeriod.filter_gain(gains.reversal_time_s);
  }
  const Q24 motor_speed = reference.dq1 / law.beta();
  const Q24 correction = rt_pid(gains, motor_side(q2_reference - q2), motor_side(q2 - last_q2_));
  last_q2_ = q2;
  const Q24 motor_reference = rt_inverse(gains, law, q2_reference, motor_speed) + correction;
  const Q24 feedforward = mix(gains.torque_backward_nm, gains.torque_forward_nm, branch_);
  return feedforward + gains.stiffness_nm_per_rad * (motor_reference - law.sample().q1) +
         gains.damping_nms_per_rad * (motor_speed - law.sample().dq1);
}

}  // namespace capstan
