// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/search.hpp"

namespace capstan::tools {

/// The loop between motor and joint that tendons draw under a free tip: half its width, at the motor, and the torque
/// that it takes, half the distance between both directions. Both tendons slide then before the joint moves, so its
/// angle is exactly play(q1), and the two numbers say what its shape can not: a gap widens the loop and takes no
/// torque, stiffer tendons narrow it, more pretension does both, and a torque that the tendons do not carry changes the
/// torque alone.
struct Loop {
  double half_width_rad = 0.0;
  double torque_nm = 0.0;
};

/// Of a healthy joint's law with tendons; nothing where its file has no steady torque or another law.
auto loop_of(const JointFile& joint) -> std::optional<Loop>;

/// What has come to a joint whose healthy law has tendons, if its tip is free: the effects found behind a loop of any
/// width, and what the change of width and torque says. Nothing where the joint does not move as a loop, or not better
/// than its tendons say.
/// @param tendons  the healthy law, stiffness and all
auto by_loop(const Preparation& p, const JointFile& healthy, const LawForm& tendons,
             const std::function<void(const std::string&)>& progress) -> std::optional<Search>;

}  // namespace capstan::tools
