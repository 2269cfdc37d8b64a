// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

#include "capstan/tools/identify/least_squares.hpp"

namespace capstan::tools {

/// Autoregressive noise e_i = sum a_k e_(i-k) + u_i.
struct AutoregressiveNoise {
  Eigen::VectorXd coefficients;  ///< a_1 .. a_p
  double innovation_variance = 0.0;
  [[nodiscard]] auto order() const -> Eigen::Index { return coefficients.size(); }
};

/// The largest order that noise of residuals is asked for.
inline constexpr Eigen::Index kLargestNoiseOrder = 8;

/// Fits by Burg's method over pieces that do not touch each other; the order by BIC, up to the one asked for or what
/// the pieces are long enough for.
auto fit_noise(const Eigen::VectorXd& signal, const Blocks& pieces, Eigen::Index order_asked) -> AutoregressiveNoise;

/// x_i - sum a_k x_(i-k) column by column within each piece; the first `order` rows of a piece become 0.
auto whitened(const Eigen::MatrixXd& columns, const Blocks& pieces, const AutoregressiveNoise& noise)
    -> Eigen::MatrixXd;

}  // namespace capstan::tools
