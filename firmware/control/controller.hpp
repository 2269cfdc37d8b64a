// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "capstan/firmware/parameters/config.hpp"
#include "capstan/model/reciprocal.hpp"

namespace capstan {

/// Joint position control through the estimated joint angle.
///   q1* = invert(q2*) + PID(q2* - q2)      the inverse law is the feedforward, the PID corrects what it leaves; it
///   changes sign
///                                          with beta, so that it pulls the joint back on a crossed transmission too
///   tau = tau* + stiffness (q1* - q1) + damping (q1*' - q1')
/// tau* is the effort law's torque for the reference's motion where the joint has one, else that of a steady motion in
/// its direction. At a reversal of the reference the feedforward passes from one branch of the law to the other within
/// reversal_time, so it crosses the hysteresis at once but does not kick, and no faster than by 1 - exp(-way /
/// reversal_angle) of the motor's reference, as tendons bring friction that bend before they slide. Where another axis
/// pulls at the joint, the motor turns round with what that asks of it, reference or no reference: then the direction
/// is that of the inverse itself.
class Controller {
 public:
  explicit Controller(const ControlConfig& gains);
  /// New gains or another law. The torque that they ask for comes in within a second, without a jump.
  void rt_configure(const ControlConfig& gains);
  /// @param lost_rad  way that the motor goes without the joint, by the law
  void rt_expect_lost_motion(Q24 lost_rad);
  /// Takes over without a jump, in place of rt_update in that cycle: the reference is the present estimate, and the
  /// motor is asked to stay where it is. What an update would turn the law round for is what the start does, so a cycle
  /// in which control changes hands costs no more than another.
  /// @param kept_nm  torque to begin with, which the motor has, N m; none: that of the feedforward, whichever way
  /// @param effort   law of the feedforward; nullptr: the torque of a steady motion
  /// @returns motor-side torque, N m
  auto rt_start(const ControlConfig& gains, const MotionLaw<Q24>& law, Q24 q2_rad, std::optional<Q24> kept_nm = {},
                const TorqueLaw<Q24>* effort = nullptr) -> Q24;
  /// @param q2_reference  wanted joint angle, rad   @param q2  estimated joint angle, rad   @returns motor-side torque,
  /// N m
  auto rt_update(const AxisConfig& config, const MotionLaw<Q24>& law, Q24 q2_reference, Q24 q2,
                 const TorqueLaw<Q24>* effort = nullptr) -> Q24;
  /// From now on rt_update_motor is called instead; the torque stays if its first reference is motor_reference().
  void rt_start_motor() {
    reference_.restart();
    integral_ = Q24{};
  }
  /// The servo, its feedforward and the integral, here of the motor's error: the motor follows q1_reference, rad,
  /// whatever the joint makes of it.
  auto rt_update_motor(const ControlConfig& gains, const MotionLaw<Q24>& law, Q24 q1_reference,
                       const TorqueLaw<Q24>* effort = nullptr) -> Q24;
  /// Where the servo holds the motor, rad.
  [[nodiscard]] auto motor_reference() const -> Q24 { return motor_reference_; }

 private:
  /// The motor angle at which the law puts the joint at q2, on the branch that the feedforward is on; branches_apart_
  /// goes with it. `motion`: the motor's angle, rate and acceleration there, the rest as the law last saw it; its
  /// direction and torque are changed, as a copy of a sample costs as much as a term. Inlined, for every cycle calls
  /// it once.
  [[nodiscard, gnu::always_inline]] inline auto rt_inverse(const ControlConfig& gains, const MotionLaw<Q24>& law,
                                                           Q24 q2, Sample<Q24>& motion) -> Q24;
  /// Before the law is turned round, if gains or law may be others.
  void rt_settle(const ControlConfig& gains, const MotionLaw<Q24>& law);
  /// The torque that a motion takes, on the branch that the feedforward is on. `motion`: its q2 is changed.
  [[nodiscard]] auto rt_feedforward(const ControlConfig& gains, const TorqueLaw<Q24>* effort, Sample<Q24>& motion) const
      -> Q24;
  /// Each cycle once: where the motor is, rad, and by that its rate.
  void rt_follow_motor(Q24 q1);
  /// The motor servo: the torque that takes the motor to motor_reference_, which runs at `rate`, rad/s, beside that of
  /// the feedforward.
  [[nodiscard]] auto rt_servo(const ControlConfig& gains, Q24 rate, Q24 feedforward) const -> Q24;
  /// The servo's torque, and what is left of the one before new gains.
  auto rt_answer(const ControlConfig& gains, Q24 rate, Q24 feedforward) -> Q24;
  /// What the last torque under the gains before is above the one that these ask for, and ever less of it.
  auto rt_blend(Q24 asked) -> Q24;
  void rt_cross_over(bool forward);
  /// @param rate  of the motor's reference, rad/s
  void rt_cross_over(const ControlConfig& gains, bool forward, Q24 rate);
  /// `asked`: what the inverse asks of the motor now, half way between the branches: what crossing to the other one
  /// asks would turn the motor back where the hysteresis has the other sign.
  void rt_follow_pull(Q24 asked);
  /// Asked once in every cycle in which the reference stands.
  auto rt_pull_stands() -> bool;
  /// Both arguments in the motor's direction.
  [[gnu::always_inline]] inline auto rt_pid(const AxisConfig& config, Q24 error, Q24 movement, bool stands) -> Q24;
  /// What the integral takes of its step while the reference stands; the branch may take the step in its place.
  auto rt_step_at_rest(const AxisConfig& config, Q24 error, Q24 step) -> Q24;

  SampleConditioner<Q24> reference_;
  Q30 reversal_gain_;
  Q30 rate_gain_;
  Reciprocal<Q24> per_reversal_angle_;
  Reciprocal<Q24> per_stiffness_;
  Q24 integral_;
  Q24 last_q2_;
  Q24 motor_reference_;                // of the last cycle
  Q24 h_;                              // of that, behind the input terms: the ratio's curve is turned round from there
  Q24 last_q1_;                        // of the motor
  Q24 motor_rate_;                     // filtered, rad/s
  Q24 pull_extreme_;                   // of the inverse half way between the branches, in the present direction
  Q24 branches_apart_;                 // of the joint, the motor being where it is
  Q24 ways_apart_;                     // of the motor, by what lies in front of the ratio
  WeightedSum<Q24> settled_backward_;  // of the law's rest what only other gains or another law change
  WeightedSum<Q24> settled_forward_;
  Q24 lost_motion_;  // the law's, between the branches, rad of the motor
  Reciprocal<Q24> per_lost_motion_;
  bool settled_ = false;
  bool changed_ = false;  // gains or law, since the last torque
  Q24 torque_;            // of the last cycle
  Q24 blend_;             // from the torque under the gains before to that under these
  Q24 pull_stands_at_;    // and where that stands for ...
  std::int32_t pull_stands_cycles_ = 0;
  bool pull_known_ = false;
  bool pull_forward_ = true;
  Q24 branch_;  // of the motor; 0: backward, 1: forward, between: passing over, or direction not known yet
};

}  // namespace capstan
