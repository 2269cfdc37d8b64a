// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/scalar.hpp"

namespace capstan {

/// What every term sees: one instant of one axis, with what many terms need worked out once.
template <typename Scalar>
struct Sample {
  Scalar q1{};             ///< motor angle at the input pulley, rad
  Scalar dq1{};            ///< its filtered rate, rad/s
  Scalar tau{};            ///< motor-side torque, N m
  bool forward = true;     ///< J of (5.20): the top tendon is the pulled one; keeps its value at rest
  bool saturated = false;  ///< this sample's angle, torque or rate met the end of its range
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
      : dt_(dt), threshold_(shape.direction_threshold_rad), gain_(dt.filter_gain(shape.rate_time_constant_s)) {}

  /// @param q1  motor angle, rad   @param tau  motor-side torque, N m
  constexpr auto update(Scalar q1, Scalar tau) -> Sample<Scalar> {
    if (!started_) {
      started_ = true;
      extreme_ = q1;
      sample_.q1 = q1;
    }
    const Scalar rate = dt_.rate_of(q1 - sample_.q1);
    const Scalar rate_error = rate - sample_.dq1;
    sample_.dq1 += rate_error * gain_;
    sample_.saturated = Traits::is_saturated(q1) || Traits::is_saturated(tau) || Traits::is_saturated(rate) ||
                        Traits::is_saturated(rate_error);
    sample_.q1 = q1;
    sample_.tau = tau;
    update_direction(q1);
    return sample_;
  }

 private:
  using Traits = ScalarTraits<Scalar>;

  /// A play operator on q1: the switch changes only after a return of more than the threshold from the last extreme, so
  /// noise smaller than that can not make it chatter, however long the joint rests.
  constexpr void update_direction(Scalar q1) {
    const Scalar beyond = sample_.forward ? q1 - extreme_ : extreme_ - q1;
    if (beyond > Scalar{}) {
      extreme_ = q1;
    } else if (-beyond > threshold_) {
      sample_.forward = !sample_.forward;
      extreme_ = q1;
    }
  }

  SamplePeriod<Scalar> dt_;
  Scalar threshold_;
  typename ScalarTraits<Scalar>::Gain gain_;
  Scalar extreme_{};
  Sample<Scalar> sample_{};
  bool started_ = false;
};

}  // namespace capstan
