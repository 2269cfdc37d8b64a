// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "capstan/tools/identify/law_fit.hpp"

namespace capstan::tools {

/// White noise of a logged torque, N m, by the median of its third differences: where a torque jumps at reversals
/// there is none of it.
auto torque_noise_level(const Eigen::VectorXd& tau_nm) -> double;

/// What a least-squares fit to noisy regressors has to be corrected by (errors in variables; Fuller, Measurement Error
/// Models, 1987, 2.2): noise in the columns makes their coefficients too small, and others take their place.
struct NoiseCorrection {
  Eigen::VectorXd shift;   ///< to be added to the coefficients; 0 where the noise does nothing
  Eigen::MatrixXd spread;  ///< covariance of the corrected coefficients from that of the fit: spread C spread'
  /// Per coefficient: false where its column is made of the torque, and in some direction the columns are hardly more
  /// than noise, so that the log does not tell it.
  std::vector<bool> told;
};

/// Of columns of which the first are the form's and the others its sensitivities to shapes, fitted to the rows of the
/// blocks. @param fit  of these columns
auto noise_correction(const LawDesign& design, const LawForm& form, const Eigen::MatrixXd& columns,
                      const Blocks& blocks, const LinearFit& fit) -> NoiseCorrection;

/// 95 % intervals of a fit that hold what least squares give and, of an angle's law, what they would give without the
/// noise of the torque. An effort's law has the torque as its target.
class FittedIntervals {
 public:
  FittedIntervals(const LawDesign& design, const LawForm& form, const Eigen::MatrixXd& columns, const Blocks& blocks,
                  const LinearFit& fit);
  /// @param value  of coefficient i of the fit, as the law has it. Nothing: the log does not tell it
  [[nodiscard]] auto around(double value, Eigen::Index i) const -> std::optional<Interval>;

 private:
  LinearFit fit_, clean_;  ///< the second corrected
  std::optional<NoiseCorrection> noise_;
};

}  // namespace capstan::tools
