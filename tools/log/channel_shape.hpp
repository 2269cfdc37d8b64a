// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

namespace capstan::tools {

/// Rows that repeat the one before, as a share, in a channel with noise or fine steps: not more.
inline constexpr double kRarelyRepeats = 0.2;

/// Robust range: between the quantiles of 0.5 and 99.5 %, so that wild values do not count.
auto robust_range(const Eigen::VectorXd& values) -> double;

/// Sizes of the changes from row to row. @pre there is a row
auto changes_of(const Eigen::VectorXd& values) -> Eigen::VectorXd;

/// Whether a channel has more than one value.
auto varies(const Eigen::VectorXd& values) -> bool;

/// Rows per new value of a channel that is held by a clock; nothing if it is not.
auto rows_per_value(const Eigen::VectorXd& values) -> std::optional<double>;

/// Rows at which a held channel has a new value: where it changes, and while it rests, where one was due. Where it only
/// lacks a value or two, as of a camera that lost pictures, there is none.
/// @param beat  rows per new value, from rows_per_value()
auto frame_rows(const Eigen::VectorXd& values, double beat) -> std::vector<Eigen::Index>;

/// Rows of the stretches in which a channel has one value although the motion goes on.
auto stuck_rows(const Eigen::VectorXd& values, const Eigen::VectorXd& motion) -> std::vector<Eigen::Index>;

/// Whether a channel is turned up at zero, as the magnitude of a signal with both signs is.
/// @param effort  crosses zero on the way, noise and all; an angle may well start at zero and return to it
auto is_magnitude(const Eigen::VectorXd& values, bool effort) -> bool;

/// Row before which a joint's angle leaps once, without its motor and for good, several times as far as in any other
/// row.
auto leap_row(const Eigen::VectorXd& joint, const Eigen::VectorXd& motor) -> std::optional<Eigen::Index>;

/// Steps of its resolution over the robust range; nothing if no resolution is to be seen.
auto steps_over_range(const Eigen::VectorXd& values) -> std::optional<double>;

}  // namespace capstan::tools
