// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <vector>

namespace capstan::tools {

/// Rows that a target may be shifted by to either side. Row by row near no shift, in longer steps farther away.
inline constexpr Eigen::Index kShortReach = 15;
inline constexpr Eigen::Index kLongReach = 240;

/// Parts of a log, alike in length, each with rows beside it that a window and the noise's memory reach into.
struct LogParts {
  static constexpr Eigen::Index kCount = 8;
  Eigen::Index window = 2;           ///< half width of the box that everything is seen through, twice; rows
  Eigen::Index reach = kShortReach;  ///< longest shift, rows
  Eigen::Index rows = 0;             ///< of each part; 0: the log is too short
  Eigen::Index beside = 0;           ///< rows to either side
  std::array<Eigen::Index, kCount> begin{};
};
/// Spread over the whole log; of a long one the parts leave rows out between them, so that the work is bounded.
auto parts_of_log(Eigen::Index rows, Eigen::Index window, Eigen::Index reach = kShortReach) -> LogParts;

/// The parts of a signal with the rows beside them, one column each. (rows + 2 beside) x kCount
auto cut(const Eigen::VectorXd& signal, const LogParts& parts) -> Eigen::MatrixXd;

/// How far a target is behind a law.
struct ShiftFit {
  double rows = 0.0;      ///< behind
  double half = 0.0;      ///< of the 95 % interval, by leaving out one part after the other; rows
  double gain = 0.0;      ///< by which the shift raises twice the log likelihood
  double expected = 0.0;  ///< gain of a delay of that size, the unshifted law being right
  double first = 0.0;     ///< share of the noise's squares that the law's first column takes away
};

/// Least squares of the target, shifted, on the law's columns. All is seen through one window, so that a rate's noise
/// does not dim its weight, and is whitened by an autoregressive model of the residual: what the law lacks is slow, and
/// unwhitened it would drown the reversals, at which alone a delay differs from drag. The residual without a shift
/// finds the best one; around that everything is repeated with the residual there, which a delay does not add to.
/// @param law, target  from cut(), with these parts
/// @return nothing if the parts are too short for so many columns, or the best shift is out of range in any of the fits
auto shift_behind(const std::vector<Eigen::MatrixXd>& law, const Eigen::MatrixXd& target, const LogParts& parts)
    -> std::optional<ShiftFit>;

}  // namespace capstan::tools
