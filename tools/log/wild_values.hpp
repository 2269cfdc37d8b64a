// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace capstan::tools {

/// Rows of a wild value; what stands out for longer is none.
inline constexpr Eigen::Index kLongestSpike = 3;

/// The signal with a straight line through these rows, from the row before to the row after; as it is where that is
/// beyond an end. @param rows  in order
auto without(Eigen::VectorXd x, const std::vector<Eigen::Index>& rows) -> Eigen::VectorXd;

/// Rows of single wild values: up to three rows that stand out from the rows on both sides. One row in a hundred at
/// most; three in twenty, if they lie far from all others, with hardly any between.
/// @param has_pulses  as a torque may have where the motion turns round: then one in a hundred at most
auto spike_rows(const Eigen::VectorXd& values, bool has_pulses) -> std::vector<Eigen::Index>;

}  // namespace capstan::tools
