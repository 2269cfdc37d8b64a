// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/model/exponential.hpp"

namespace capstan {

/// One tendon on a curved surface, in closed form (thesis ch. 2, 3, 5). Host only: these are design values, from which
/// the coefficients of the motion law follow; the target sees nothing but the coefficients.
struct Tendon {
  double eta;        ///< friction-bending number mu L / R, 1, not negative
  double stiffness;  ///< free stiffness Kn = E A / L, N/m
};

/// Elongation per tension at the input end of a fully active tendon that was slack, m/N; (2.10) with T = T_in e^(-eta
/// phi s).
/// @param s  +1 where the input end pulls, -1 where it yields
inline auto elongation_per_tension(const Tendon& tendon, double s) -> double {
  return mean_decay(tendon.eta * s) / tendon.stiffness;
}

/// Apparent stiffness at the input end with the slip zone reaching to `front` in (0, 1], N/m: (3.8) pulled, (3.9)
/// pushed, (3.7) for a front inside. It is the inverse of elongation per tension of the moving part.
inline auto apparent_stiffness(const Tendon& tendon, double s, double front = 1.0) -> double {
  return tendon.stiffness / (front * mean_decay(tendon.eta * s * front));
}

/// Where the slip front stands, 0 to 1, after the tension at the input end went from `before` to `after` (both above
/// 0), the old profile having been left by motion in direction s_before (0: even). First meeting of the two
/// exponentials, (2.6).
inline auto slip_front(const Tendon& tendon, double before, double s_before, double after, double s_after) -> double {
  const double slope = tendon.eta * (s_after - s_before);
  const double meeting = std::log(after / before) / slope;
  return !(meeting < 1.0) ? 1.0 : (meeting > 0.0 ? meeting : 0.0);
}

/// Coefficient of the pulled tendon's torque in the motion law, rad/(N m): a = -(1 - e^-eta) / (r1 r2 eta Kn), (5.29)
/// with its sign and exponent put right. @param r1, r2  radii of the input and the output pulley, m
inline auto elongation_coefficient(const Tendon& pulled, double r1, double r2) -> double {
  return -elongation_per_tension(pulled, 1.0) / (r1 * r2);
}

/// Contrast of the two directions by pretension, rad: half of q2 forward minus q2 backward at no torque, from (5.36)
/// and (5.38) without the second division by Kn. @param lambda  the constant of (5.34), m
inline auto pretension_contrast(const Tendon& top, const Tendon& bottom, double r2, double lambda) -> double {
  auto share = [&](double s) {
    const double a = elongation_per_tension(top, s);
    const double b = elongation_per_tension(bottom, -s);
    return (a - b) / (a + b);
  };
  return -lambda * (share(1.0) - share(-1.0)) / (4.0 * r2);
}

/// The constant I of (2.16), N, from the motor torque at which the pushed tendon goes slack.
inline auto pretension_from_slack_torque(double eta, double torque_nm, double r1) -> double {
  return std::fabs(torque_nm) / r1 * mean_decay(eta);
}

}  // namespace capstan
