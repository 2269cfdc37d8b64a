// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "capstan/model/scalar.hpp"

namespace capstan {

/// Joints of a machine that may pull at one of its joints, beside its own motor.
inline constexpr std::size_t kMostOthers = 3;

/// Another joint's motor, whose tendons pass this joint.
template <typename Scalar>
struct OtherMotor {
  Scalar q1{};          ///< motor angle, rad
  Scalar tau{};         ///< torque, N m
  bool forward = true;  ///< its direction switch
};

/// What a law is given: one instant as it was measured. Whoever has only motor angle and torque leaves the rest as it
/// is.
template <typename Scalar>
struct Measured {
  Scalar q1{};   ///< motor angle at the input pulley, rad
  Scalar tau{};  ///< motor-side torque, N m
  /// Joint angle of the last cycle, rad. A running law puts its own last estimate here, a fit the joint's measured
  /// angle. Missing: q1 stands for it.
  Scalar q2 = ScalarTraits<Scalar>::missing();
  std::array<OtherMotor<Scalar>, kMostOthers> others{};  ///< by the slots of the law's coupling
  Scalar temperature = ScalarTraits<Scalar>::missing();  ///< of the transmission, degrees Celsius
};

/// What every term sees: one instant of one axis, with what many terms need worked out once.
template <typename Scalar>
struct Sample {
  Scalar q1{};          ///< motor angle at the input pulley, rad
  Scalar dq1{};         ///< its filtered rate, rad/s
  Scalar tau{};         ///< motor-side torque, N m
  bool forward = true;  ///< J of (5.20): the top tendon is the pulled one; keeps its value at rest
  /// By how much the motor is further in that direction than ever since it turned, rad, below 0 backward: unless 0, it
  /// moves for certain.
  Scalar advance{};
  bool saturated = false;  ///< this sample's angle, torque or rate met the end of its range
  /// The motor angle behind the input terms, rad: what is left of it after hysteresis in front of the ratio. q1 where
  /// there is none.
  Scalar h{};
  Scalar dh{};            ///< its rate, filtered as dq1 is, rad/s
  Scalar ddq1{};          ///< filtered acceleration, krad/s2: a jerk of the motor passes 128 rad/s2 easily
  Scalar tau_late{};      ///< torque through the acceleration's filters, N m: as late as `ddq1`. By delay_torque()
  Scalar course_late{};   ///< the direction switch, 1 forward and -1 backward, through the same. By delay_torque()
  Scalar advance_late{};  ///< `advance` through the same. By delay_torque()
  Scalar q1_reversal{};   ///< motor angle where the present direction began (at first: where it all began), rad
  Scalar tau_reversal{};  ///< torque there, N m
  Scalar q2{};            ///< joint angle of the last cycle, rad
  std::array<OtherMotor<Scalar>, kMostOthers> others{};  ///< motors that this joint is coupled to
  Scalar warmth{};  ///< temperature above 25 degrees Celsius, K; 0 where nobody measures it
  /// Share of the dry friction that still acts, 0 to 1: 1 while the motor moves; at rest it may let go
  /// (RestingFriction).
  Scalar grip = kWhole;
  /// Gain of the acceleration's filter, for whoever makes up for how late `tau_late` is; 0: it is not late.
  typename ScalarTraits<Scalar>::Gain late_gain{};
  Scalar direction_threshold{};  ///< how far back the direction switch turns over, rad

  static constexpr Scalar kWhole = ScalarTraits<Scalar>::from(1.0);  // the target converts no double at run time
  /// Direction of the dry friction, -1 to 1.
  [[nodiscard]] constexpr auto slide() const -> Scalar { return forward ? grip : -grip; }
};

/// Shapes of the conditioner, part of every law.
template <typename Scalar>
struct ConditionerShape {
  /// How far q1 must come back from its extreme before the direction switches, rad. Above the encoder's noise, below
  /// any motion that matters.
  Scalar direction_threshold_rad = ScalarTraits<Scalar>::from(0.001);
  /// Time constant of the rate filter, s.
  Scalar rate_time_constant_s = ScalarTraits<Scalar>::from(0.002);
};

/// Turns raw motor angle and torque into samples: causal, the same on the target and in every fit.
template <typename Scalar>
class SampleConditioner {
 public:
  constexpr SampleConditioner(SamplePeriod<Scalar> dt, const ConditionerShape<Scalar>& shape)
      : dt_(dt),
        threshold_(shape.direction_threshold_rad),
        gain_(dt.filter_gain(shape.rate_time_constant_s)),
        acceleration_gain_(dt.filter_gain(shape.rate_time_constant_s * kAccelerationFilter)) {
    begin();
  }

  /// As newly made: the next sample is the first.
  constexpr void restart() {
    sample_ = {};
    begin();
    started_ = false;
  }

  /// Who has no more than these: no other motor, no warmth, and q1 for the joint angle.
  /// @param q1  motor angle, rad   @param tau  motor-side torque, N m
  constexpr auto update(Scalar q1, Scalar tau) -> const Sample<Scalar>& {
    follow(q1, tau);
    sample_.q2 = q1;
    return sample_;
  }

  /// The sample is the conditioner's own and good until the next update.
  constexpr auto update(const Measured<Scalar>& now) -> const Sample<Scalar>& {
    return update(now, Traits::is_missing(now.q2) ? now.q1 : now.q2);
  }

  /// The same with another joint angle of the last cycle than `now` has.
  [[gnu::always_inline]] constexpr auto update(const Measured<Scalar>& now, Scalar q2) -> const Sample<Scalar>& {
    follow(now.q1, now.tau);
    sample_.q2 = q2;
    sample_.others = now.others;
    sample_.warmth = Traits::is_missing(now.temperature) ? Scalar{} : now.temperature - kReferenceTemperature;
    return sample_;
  }

  /// Brings the last sample's `tau_late`, `course_late` and `advance_late` up to date, once after each update; only
  /// tendons ask for them.
  [[gnu::always_inline]] constexpr void delay_torque() {
    filtered_torque_ = Traits::between(filtered_torque_, sample_.tau, gain_);
    sample_.tau_late = Traits::between(sample_.tau_late, filtered_torque_, acceleration_gain_);
    filtered_course_ = Traits::between(filtered_course_, sample_.forward ? kWhole : -kWhole, gain_);
    sample_.course_late = Traits::between(sample_.course_late, filtered_course_, acceleration_gain_);
    // The place is filtered, not its steps: these would be rounded each, and a motor at rest would creep on.
    filtered_extreme_ = Traits::between(filtered_extreme_, extreme_, gain_);
    const Scalar extreme_late = Traits::between(extreme_late_, filtered_extreme_, acceleration_gain_);
    sample_.advance_late = extreme_late - extreme_late_;
    extreme_late_ = extreme_late;
  }

  /// Lets what lies between the motor and the ratio act on the last sample.
  template <typename Stage>
  [[gnu::always_inline]] constexpr void pass_through(Stage& stage) {
    stage.update(sample_);
  }

  /// The last sample.
  [[nodiscard]] constexpr auto sample() const -> const Sample<Scalar>& { return sample_; }

 private:
  using Traits = ScalarTraits<Scalar>;
  /// The acceleration's filter has this many times the time constant of the rate's. One count of a 40960-count encoder
  /// then shows as 6 rad/s2 with the default 2 ms, and 8 ms more of delay are 3 degrees of phase at 1 Hz.
  static constexpr Scalar kAccelerationFilter = Traits::from(4.0);
  static constexpr Scalar kWhole = Sample<Scalar>::kWhole;
  static constexpr Scalar kReferenceTemperature = Traits::from(25.0);

  constexpr void begin() {
    sample_.late_gain = acceleration_gain_;
    sample_.direction_threshold = threshold_;
  }

  /// What motor angle and torque make of a sample.
  [[gnu::always_inline]] constexpr void follow(Scalar q1, Scalar tau) {
    if (!started_) {
      started_ = true;
      extreme_ = filtered_extreme_ = extreme_late_ = sample_.q1 = sample_.q1_reversal = q1;
      torque_at_extreme_ = sample_.tau_reversal = tau;
      filtered_torque_ = sample_.tau_late = tau;
      filtered_course_ = sample_.course_late = kWhole;
    }
    const Scalar rate = dt_.rate_of(q1 - sample_.q1);
    const Scalar rate_error = rate - sample_.dq1;
    const Scalar step = Traits::part(rate_error, gain_);
    sample_.dq1 += step;
    sample_.ddq1 = Traits::between(sample_.ddq1, dt_.per_millisecond(step), acceleration_gain_);
    sample_.saturated = Traits::is_saturated(q1) || Traits::is_saturated(tau) || Traits::is_saturated(rate) ||
                        Traits::is_saturated(rate_error);
    sample_.q1 = sample_.h = q1;
    sample_.dh = sample_.dq1;
    sample_.tau = tau;
    update_direction(q1, tau);
  }

  /// A play operator on q1: the switch changes only after a return of more than the threshold from the last extreme, so
  /// noise smaller than that can not make it chatter, however long the joint rests.
  /// The switch is late by the threshold; what it remembers is of the extreme itself, where the motor turned.
  constexpr void update_direction(Scalar q1, Scalar tau) {
    const Scalar beyond = sample_.forward ? q1 - extreme_ : extreme_ - q1;
    const bool turned = -beyond > threshold_;
    if (turned) {
      sample_.forward = !sample_.forward;
      sample_.q1_reversal = extreme_;
      sample_.tau_reversal = torque_at_extreme_;
    }
    const bool advances = turned || beyond > Scalar{};
    sample_.advance = advances ? q1 - extreme_ : Scalar{};
    if (advances) {
      extreme_ = q1;
      torque_at_extreme_ = tau;
    }
  }

  SamplePeriod<Scalar> dt_;
  Scalar threshold_;
  typename ScalarTraits<Scalar>::Gain gain_;
  typename ScalarTraits<Scalar>::Gain acceleration_gain_;
  Scalar extreme_{};
  Scalar torque_at_extreme_{};
  Scalar filtered_torque_{};  ///< by the rate's filter alone
  Scalar filtered_course_{};
  Scalar filtered_extreme_{};
  Scalar extreme_late_{};
  Sample<Scalar> sample_{};
  bool started_ = false;
};

}  // namespace capstan
