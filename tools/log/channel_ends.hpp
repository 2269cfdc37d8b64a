// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

namespace capstan::tools {

/// Rows at an end of the range where the channel is cut off.
auto clipped_rows(const Eigen::VectorXd& values) -> std::vector<Eigen::Index>;

/// Rows before which the channel jumps, each time alike and far beyond all other changes. Noise takes an angle to and
/// fro where it starts anew, but it also stays there; what always comes back within a few rows is a wild value.
auto jump_rows(const Eigen::VectorXd& values) -> std::vector<Eigen::Index>;

/// The turn of a sensor that jumps by nearly this much: 2 pi, 360, 1, or a power of two of counts.
auto nearest_turn(double jump) -> std::optional<double>;

/// How much too high a channel is where it should be below zero: the whole range of its word, as of a number with a
/// sign that was read as one without. Nothing if it is not.
auto unsigned_range(const Eigen::VectorXd& values) -> std::optional<double>;

}  // namespace capstan::tools
