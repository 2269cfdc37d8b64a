// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/control/controller.hpp"

namespace capstan {
namespace {

constexpr SamplePeriod<Q24> kPeriod{kCycleRateHz};
constexpr Q24 kOne = Q24::from_int(1);
constexpr Q24 kHalf = Q24::from_double(0.5);

// New gains bring their torque within this time: at once it would throw a joint that holds.
constexpr Q30 kBlendGain = kPeriod.filter_gain(Q24::from_double(0.2));

// References are exact, so their direction needs only a threshold above the rounding of a slow stream.
constexpr ConditionerShape<Q24> kReferenceShape{.direction_threshold_rad = Q24::from_double(1e-5),
                                                .rate_time_constant_s = Q24::from_double(0.002)};

// Of what another axis' pull asks of the motor, rad: the other axis' encoder is in it. A pull stands when it has asked
// for no more as long as this.
constexpr Q24 kPullPlay = Q24::from_double(0.002);
constexpr std::int32_t kPullStandsCycles = 256;

// What rounding leaves of the reference's rate at rest.
constexpr Q24 kRateLeft = Q24::from_raw(1);

// Less than that, rad, is no motion that an encoder shows.
constexpr Q24 kLeastLostMotion = Q24::from_double(1e-4);

constexpr auto mix(Q24 backward, Q24 forward, Q24 branch) -> Q24 {
  return backward + ScalarTraits<Q24>::part(forward - backward, ScalarTraits<Q24>::share_of(branch));
}

}  // namespace

Controller::Controller(const ControlConfig& gains)
    : reference_(kPeriod, kReferenceShape),
      reversal_gain_(kPeriod.filter_gain(gains.reversal_time_s)),
      rate_gain_(kPeriod.filter_gain(gains.rate_time_constant_s)),
      per_reversal_angle_(gains.reversal_angle_rad),
      per_stiffness_(gains.stiffness_nm_per_rad) {}

void Controller::rt_configure(const ControlConfig& gains) {
  reversal_gain_ = kPeriod.filter_gain(gains.reversal_time_s);
  rate_gain_ = kPeriod.filter_gain(gains.rate_time_constant_s);
  per_reversal_angle_ = Reciprocal<Q24>(gains.reversal_angle_rad);
  per_stiffness_ = Reciprocal<Q24>(gains.stiffness_nm_per_rad);
  settled_ = false;
  changed_ = true;
}

void Controller::rt_expect_lost_motion(Q24 lost_rad) {
  lost_motion_ = lost_rad;
  per_lost_motion_ = Reciprocal<Q24>(lost_rad);
}

auto Controller::rt_start(const ControlConfig& gains, const MotionLaw<Q24>& law, Q24 q2_rad, std::optional<Q24> kept_nm,
                          const TorqueLaw<Q24>* effort) -> Q24 {
  reference_.restart();
  reference_.update(q2_rad, Q24{});
  branch_ = kHalf;
  last_q2_ = q2_rad;
  Sample<Q24> rest = law.sample();
  rest.dq1 = rest.ddq1 = Q24{};
  h_ = rest.q1;
  settled_ = false;
  pull_extreme_ = rt_inverse(gains, law, q2_rad, rest);  // half way, as branch_ says
  pull_known_ = false;
  pull_stands_cycles_ = 0;
  integral_ = rest.q1 - pull_extreme_;
  const Q24 feedforward = rt_feedforward(gains, effort, rest);
  if (kept_nm && gains.stiffness_nm_per_rad > Q24{}) {
    integral_ += (*kept_nm - feedforward) * per_stiffness_;
  }
  motor_reference_ = pull_extreme_ + integral_;
  last_q1_ = law.sample().q1;
  motor_rate_ = law.sample().dq1;
  changed_ = false;
  blend_ = Q24{};
  torque_ = rt_servo(gains, Q24{}, feedforward);
  return torque_;
}

auto Controller::rt_feedforward(const ControlConfig& gains, const TorqueLaw<Q24>* effort, Sample<Q24>& motion) const
    -> Q24 {
  if (effort == nullptr) {
    return mix(gains.torque_backward_nm, gains.torque_forward_nm, branch_);
  }
  motion.q2 = motion.q1;  // the effort law's weight turns with the motor
  const TorqueLaw<Q24>::EachWay one_way = effort->each_way(motion);
  return effort->either_way(motion) + mix(one_way.backward, one_way.forward, branch_);
}

/// The law's own rate is filtered as the logs were that it was identified on; the servo's as its gains allow.
void Controller::rt_follow_motor(Q24 q1) {
  motor_rate_ += ScalarTraits<Q24>::part(kPeriod.rate_of(q1 - last_q1_) - motor_rate_, rate_gain_);
  last_q1_ = q1;
}

auto Controller::rt_servo(const ControlConfig& gains, Q24 rate, Q24 feedforward) const -> Q24 {
  return feedforward + gains.stiffness_nm_per_rad * (motor_reference_ - last_q1_) +
         gains.damping_nms_per_rad * (rate - motor_rate_);
}

auto Controller::rt_blend(Q24 asked) -> Q24 {
  if (changed_) {
    changed_ = false;
    blend_ = torque_ - asked;
  }
  const Q24 step = blend_ * kBlendGain;
  blend_ = step == Q24{} ? Q24{} : blend_ - step;
  return blend_;
}

auto Controller::rt_answer(const ControlConfig& gains, Q24 rate, Q24 feedforward) -> Q24 {
  const Q24 asked = rt_servo(gains, rate, feedforward);
  torque_ = asked + (changed_ || blend_ != Q24{} ? rt_blend(asked) : Q24{});
  return torque_;
}

void Controller::rt_settle(const ControlConfig& gains, const MotionLaw<Q24>& law) {
  if (!settled_) {
    settled_ = true;
    settled_backward_ = law.settled(gains.torque_backward_nm, false);
    settled_forward_ = law.settled(gains.torque_forward_nm, true);
  }
}

auto Controller::rt_inverse(const ControlConfig& gains, const MotionLaw<Q24>& law, Q24 q2, Sample<Q24>& motion) -> Q24 {
  rt_settle(gains, law);
  const Q24 shared = law.rest_either_way(q2, motion);
  const bool went_forward = motion.forward;
  const Q24 turned_at = motion.tau_reversal;
  // The direction is a constant where it is called, so what the other direction's tendon adds falls away.
  const auto rest_on = [&](auto forward) __attribute__((always_inline)) {
    motion.forward = forward;
    motion.tau = forward ? gains.torque_forward_nm : gains.torque_backward_nm;
    // On the other branch it will have turned out of the other steady motion.
    const Q24 other_torque = forward ? gains.torque_backward_nm : gains.torque_forward_nm;
    motion.tau_reversal = forward == went_forward ? turned_at : other_torque;
    return law.rest_one_way(motion, forward ? settled_forward_ : settled_backward_);
  };
  const Q24 backward = rest_on(std::false_type{});
  const Q24 forward = rest_on(std::true_type{});
  // The ratio's curve is turned round once, half way between the branches or where they are mixed; what lies in front
  // of the ratio is a way of the motor.
  h_ = law.through_ratio(q2 - (shared + mix(backward, forward, branch_)), h_);
  const Q24 behind = law.undone(h_, false);
  const Q24 ahead = law.undone(h_, true);
  branches_apart_ = forward - backward;
  ways_apart_ = ahead - behind;
  return mix(behind, ahead, branch_);
}

void Controller::rt_cross_over(bool forward) {
  branch_ += ((forward ? kOne : Q24{}) - branch_) * reversal_gain_;
}

/// Tendons that bend before they slide bring the friction over a way, however long the motor takes for it.
void Controller::rt_cross_over(const ControlConfig& gains, bool forward, Q24 rate) {
  if (gains.reversal_angle_rad == Q24{}) {
    rt_cross_over(forward);
    return;
  }
  const Q24 left = (forward ? kOne : Q24{}) - branch_;
  const Q24 by_time = left * reversal_gain_;
  const Q24 by_way = per_cycle(left * (abs(rate) * per_reversal_angle_));
  branch_ += abs(by_way) < abs(by_time) ? by_way : by_time;
}

void Controller::rt_follow_pull(Q24 asked) {
  const Q24 moved = asked - pull_extreme_;
  const bool turns = abs(moved) > kPullPlay && (!pull_known_ || (moved > Q24{}) != pull_forward_);
  if (turns) {
    pull_known_ = true;
    pull_forward_ = moved > Q24{};
  }
  if (turns || (pull_known_ && (moved > Q24{}) == pull_forward_)) {
    pull_extreme_ = asked;
  }
}

auto Controller::rt_pull_stands() -> bool {
  const bool stands = abs(pull_extreme_ - pull_stands_at_) <= kPullPlay;
  pull_stands_at_ = stands ? pull_stands_at_ : pull_extreme_;
  pull_stands_cycles_ = stands ? std::min(pull_stands_cycles_ + 1, kPullStandsCycles) : 0;
  return pull_stands_cycles_ == kPullStandsCycles;
}

/// Friction and lost motion leave an error that the law can not tell from none: an integral that goes on with it takes
/// the motor to and fro through them for ever. What is more turns the motor round first, across the law's lost motion,
/// and that is the branch's part: in the integral it would be there once more when a motion that way begins, and throw
/// the joint.
auto Controller::rt_step_at_rest(const AxisConfig& config, Q24 error, Q24 step) -> Q24 {
  if (abs(error) <= std::max(config.error_bar.steady_rad, config.error_bar.turning_rad)) {
    return {};
  }
  if (lost_motion_ < kLeastLostMotion || is_pulled(config)) {
    return step;
  }
  const Q24 wanted = branch_ + step * per_lost_motion_;
  branch_ = clamp(wanted, Q24{}, kOne);
  return branch_ == wanted ? Q24{} : step;
}

auto Controller::rt_pid(const AxisConfig& config, Q24 error, Q24 movement, bool stands) -> Q24 {
  const ControlConfig& gains = config.control;
  const Q24 step = per_cycle(gains.ki_per_s * error);
  const Q24 next = integral_ + (stands ? rt_step_at_rest(config, error, step) : step);
  if (abs(next) > gains.integral_limit_rad) {
    // The start value may lie outside the limit; the integral may then only shrink.
    const Q24 limit = std::max(gains.integral_limit_rad, abs(integral_));
    integral_ = clamp(next, -limit, limit);
  } else {
    integral_ = next;
  }
  return gains.kp * error + integral_ - gains.kd_s * kPeriod.rate_of(movement);
}

auto Controller::rt_update_motor(const ControlConfig& gains, const MotionLaw<Q24>& law, Q24 q1_reference,
                                 const TorqueLaw<Q24>* effort) -> Q24 {
  Sample<Q24> motion = reference_.update(q1_reference, Q24{});
  motion.warmth = law.sample().warmth;
  if (motion.dq1 != Q24{}) {
    rt_cross_over(gains, motion.forward, motion.dq1);
  }
  // What friction leaves of the way; at the joint the outer loop does that.
  const Q24 limit = gains.integral_limit_rad;
  const Q24 error = q1_reference - law.sample().q1;
  integral_ = clamp(integral_ + per_cycle(gains.ki_per_s * error), -limit, limit);
  motor_reference_ = q1_reference + integral_;
  rt_follow_motor(law.sample().q1);
  return rt_answer(gains, motion.dq1, rt_feedforward(gains, effort, motion));
}

auto Controller::rt_update(const AxisConfig& config, const MotionLaw<Q24>& law, Q24 q2_reference, Q24 q2,
                           const TorqueLaw<Q24>* effort) -> Q24 {
  const ControlConfig& gains = config.control;
  // Where the transmission is crossed (beta < 0) the motor runs against the joint, and so must every correction.
  const bool crossed = law.beta() < Q24{};
  const auto motor_side = [crossed](Q24 joint_side) { return crossed ? -joint_side : joint_side; };

  const Sample<Q24>& reference = reference_.update(q2_reference, Q24{});
  Sample<Q24> motion = law.sample();
  motion.q1 = motor_reference_;  // not the measured angle: what is periodic in it would feed back
  motion.dq1 = law.per_beta(reference.dq1);
  motion.ddq1 = law.per_beta(reference.ddq1);
  const bool pulled = is_pulled(config);
  const bool rests = -kRateLeft <= reference.dq1 && reference.dq1 <= kRateLeft;
  const bool stands = rests && (!pulled || rt_pull_stands());
  if (pulled && pull_known_) {
    rt_cross_over(pull_forward_);
  } else if (!pulled && !rests) {
    rt_cross_over(gains, reference.forward != crossed, motion.dq1);
  }
  const Q24 correction = rt_pid(config, motor_side(q2_reference - q2), motor_side(q2 - last_q2_), stands);
  last_q2_ = q2;
  const Q24 asked = rt_inverse(gains, law, q2_reference, motion);
  if (pulled) {
    const Q24 off = branch_ - kHalf;
    rt_follow_pull(asked + law.per_beta(branches_apart_ * off) - ways_apart_ * off);
  }
  motor_reference_ = asked + correction;
  rt_follow_motor(law.sample().q1);
  return rt_answer(gains, motion.dq1, rt_feedforward(gains, effort, motion));
}

}  // namespace capstan
