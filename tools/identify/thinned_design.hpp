// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/identify/law_fit.hpp"

namespace capstan::tools {

/// A design of means over several samples, with its target and the rows that take part.
struct Thinned {
  LawDesign design;
  Eigen::VectorXd target;
  Blocks rows;
};

/// Means over so many samples that about `wanted` rows are left of those that take part; the tension along a tendon
/// hangs on the way of the torque and not on time. Each log by itself; a rest too short for a mean is left out. The
/// first mean of a block may begin up to a mean's length before it, in the gap between roles, and the one that its last
/// row is in takes no part. Where torque and acceleration are late, so are motor angle and target in the means: what
/// tendons are made of is then found as if nothing were late. Friction within them follows one time or another alike.
auto thinned(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, Eigen::Index wanted)
    -> Thinned;

}  // namespace capstan::tools
