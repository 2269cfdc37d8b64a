// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace capstan {

/// The range for which the fixed-point motion law is declared: inside it nothing saturates and the joint angle is
/// within 2e-5 rad of the law in double (tests/model/motion_law_accuracy_test.cpp). Magnitudes; all may be reached at
/// once.
struct DeclaredRange {
  static constexpr double kMotorAngleRad = 32.0;
  static constexpr double kMotorRateRadPerS =
      60.0;  ///< half the format's, since the filter forms rate minus filtered rate
  static constexpr double kTorqueNm = 8.0;
  static constexpr double kBeta = 2.0;
  static constexpr double kOffsetRad = 3.2;
  static constexpr double kElongationRadPerNm = 5.5;  ///< the largest in the thesis is 5.302 (RAVEN II elbow)
  static constexpr double kViscousS = 0.1;
  static constexpr double kContrastRad = 1.0;
  static constexpr double kPlayGain = 2.0;
  static constexpr double kPlayHalfWidthRad = 0.5;
  static constexpr double kSlipTorqueNm = 2.0;  ///< with a coefficient up to kElongationRadPerNm

  /// The largest sum these allow, rad. The slip term lags by half its torque at most.
  static constexpr double kJointAngleRad = kBeta * kMotorAngleRad + kOffsetRad +
                                           kElongationRadPerNm * (kTorqueNm + 0.5 * kSlipTorqueNm) +
                                           kViscousS * kMotorRateRadPerS + kContrastRad + kPlayGain * kPlayHalfWidthRad;
  static_assert(kJointAngleRad < 128.0, "the sum must fit the quantity format");
};

/// The range of the further effects: each is within 2e-5 rad of its double form there, whatever its motion in the range
/// above (tests/model/terms_accuracy_test.cpp). Not all may be reached at once beside the law above, whose sum has 3
/// rad left; a law that leaves the numbers' range says so (Estimate::saturated).
struct DeclaredEffectRange {
  static constexpr double kMemoryRadPerNm = 5.5;
  /// Of slip_propagation with a torque R of 1 N m and more, and in proportion below: the torque's own rounding shows as
  /// its slope, coefficient x torque / R.
  static constexpr double kFadingRadPerNm = 5.5;
  static constexpr double kPreslidingGain = 2.0;
  static constexpr double kPreslidingWidthRad = 0.5;
  static constexpr double kGravityRad = 0.5;  ///< of sine and cosine together: the estimate in them must settle
  static constexpr double kCouplingRatio = 2.0;
  static constexpr double kCouplingRadPerNm = 5.5;
  static constexpr double kCreepRadPerNm = 5.5;
  static constexpr double kWarmUpRad = 1.0;
  static constexpr double kWarmthK = 75.0;
  static constexpr double kWarmthRadPerK = 0.02;
  static constexpr double kPeriodicRad = 0.25;
  static constexpr double kPeriodicOrder = 50.0;  ///< the angle's own rounding shows N times
  static constexpr double kHardeningRadPerNm2 = 0.5;
  static constexpr double kInertia = 0.4;  ///< rad s2/krad, 4e-4 s2: second differences of an angle known to 3e-8 rad
};

}  // namespace capstan
