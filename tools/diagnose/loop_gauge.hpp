// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/search.hpp"

namespace capstan::tools {

/// What has come to a joint whose healthy law has tendons, if its tip is free: the effects found behind a Loop of any
/// width, and what the change of its width and torque says. Nothing where the joint does not move as a loop, or not
/// better than its tendons say.
/// @param tendons  the healthy law, stiffness and all
auto by_loop(const Preparation& p, const JointFile& healthy, const LawForm& tendons,
             const std::function<void(const std::string&)>& progress) -> std::optional<Search>;

}  // namespace capstan::tools
