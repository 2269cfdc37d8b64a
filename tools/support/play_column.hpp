// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <algorithm>

namespace capstan::tools {

/// What a play (gap of twice the half width) makes of a signal, each row. It begins at that share of its half width
/// beside the signal: in the middle, unless told.
inline auto play_column(const Eigen::VectorXd& x, double half_width, double start = 0.0) -> Eigen::VectorXd {
  Eigen::VectorXd column(x.size());
  double place = x[0] + start * half_width;
  for (Eigen::Index row = 0; row < x.size(); ++row) {
    place = std::clamp(place, x[row] - half_width, x[row] + half_width);
    column[row] = place;
  }
  return column;
}

}  // namespace capstan::tools
