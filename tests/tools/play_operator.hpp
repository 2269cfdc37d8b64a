// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <algorithm>

namespace capstan::tools::test {

/// A play operator of the tests' own, which begins at a share of its half width beside the motor, or in the middle.
inline auto play_of(const Eigen::VectorXd& q1, double half_width, double start = 0.0) -> Eigen::VectorXd {
  Eigen::VectorXd place = q1;
  place[0] += start * half_width;
  for (Eigen::Index i = 1; i < q1.size(); ++i) {
    place[i] = std::clamp(place[i - 1], q1[i] - half_width, q1[i] + half_width);
  }
  return place;
}

}  // namespace capstan::tools::test
