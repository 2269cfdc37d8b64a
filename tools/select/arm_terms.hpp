// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/identify/term_catalogue.hpp"

namespace capstan::tools {

/// What two joints of one arm make of each other's effort through mass that both of them move, beside what
/// effort::MotionCoupling holds, which is the same in every posture: Lagrange's equation,
///   tau = d/dt dT/dv - dT/dq + dV/dq,
///   T = J(q_o) v^2 / 2 + m(q_o) v v_o + n(q) v v_o + C(q) v_o^2 / 2,  V = V(q, q_o),
/// of this joint's motion q, v = q', and the other's, q_o, v_o. J is this joint's inertia, which the other's angle
/// changes; m and n pass acceleration on; C is the other's inertia, whose change with this angle is the centrifugal
/// torque; V is weight that both turn. Of a joint that turns they are sines and cosines of its angle (J and C of twice
/// the angle too, as a link is as heavy on either side of an axis), of one that slides powers of its way.
///
/// For a table of terms by tools that have the other joint's motion: no board runs terms of another joint's motion.

/// Another joint that turns. @param of_linear  this joint slides, else it turns
auto posture_coupling(bool of_linear) -> CatalogueTerm;
/// Another joint that slides, of a joint that turns.
auto reach_coupling() -> CatalogueTerm;

/// Coefficients of these terms that belong together: what is chosen as one.
auto posture_parts(bool of_linear) -> std::vector<std::vector<std::size_t>>;
auto reach_parts() -> std::vector<std::vector<std::size_t>>;

}  // namespace capstan::tools
