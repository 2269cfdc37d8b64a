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

/// Apparent stiffness at the input end with the slip zone reaching to `front` in (0, 1], N/m: (3.8) pulled, (3.9)
/// pushed, (3.7) for a front inside. It is the inverse of elongation per tension of the moving part, (2.10) with
/// T = T_in e^(-eta phi s).
/// @param s  +1 where the input end pulls, -1 where it yields
inline auto apparent_stiffness(const Tendon& tendon, double s, double front = 1.0) -> double {
  return tendon.stiffness / (front * mean_decay(tendon.eta * s * front));
}

/// The constant I of (2.16), N, from the motor torque at which the pushed tendon goes slack.
inline auto pretension_from_slack_torque(double eta, double torque_nm, double r1) -> double {
  return std::fabs(torque_nm) / r1 * mean_decay(eta);
}

}  // namespace capstan
