// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "capstan/tools/identify/least_squares.hpp"

namespace capstan::tools {

/// The same motion, several times in a row.
struct Repeats {
  Eigen::Index first = 0;   ///< row at which the first cycle begins
  Eigen::Index length = 0;  ///< rows per cycle
  Eigen::Index count = 0;   ///< whole cycles
  [[nodiscard]] auto cycle(Eigen::Index i) const -> RowRange { return {first + i * length, first + (i + 1) * length}; }
};

/// Looks for repeated cycles in a motion (motor angle, any sampling). Two stretches repeat each other when they differ
/// by less than 3 % of the motion's range in nine tenths of their samples. Nothing is found in a log with fewer than
/// two cycles, or where the last has come away from the first further than neighbours from each other.
auto find_repeats(const Eigen::VectorXd& motion, double noise_rad) -> std::optional<Repeats>;

/// Whether another signal, as long as the motion, comes again with these cycles as a motion has to.
auto comes_again(const Eigen::VectorXd& signal, const Repeats& repeats) -> bool;

/// Each cycle less the mean of all, scaled so that its variance is that of the noise: what is left is not the model's
/// doing. Rows outside the cycles are 0.
auto pure_error(const Eigen::VectorXd& signal, const Repeats& repeats) -> Eigen::VectorXd;

}  // namespace capstan::tools
