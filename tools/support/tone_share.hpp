// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

namespace capstan::tools {

/// Largest share of a signal's energy about its mean that one pitch takes, 0.3 to 25 Hz, its phase and size anew every
/// 15 s: what keeps a pitch for seconds has nearly all, what begins and dies away again and again little.
/// @param time_s  of the values, rising; gaps are allowed   @pre as many values as times
auto tone_share(const Eigen::VectorXd& time_s, const Eigen::VectorXd& signal) -> double;

}  // namespace capstan::tools
