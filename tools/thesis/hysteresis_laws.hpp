// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <string>

namespace capstan::tools {

/// A hysteresis law from the literature, to stand beside the Preisach model: linear in its coefficients once its shapes
/// are given. Inputs are shares of the saturating one, from -1 on.
class HysteresisLaw {
 public:
  enum class Kind {
    /// y = c0 + c1 u + c2 z, dz = du - (g abs(du) z / abs(z) + (1 - g) du) abs(z / z0)^n (Bouc 1967, Wen 1976).
    kBoucWen,
    /// dy = a abs(du) (f(u) - y) + g(u) du with f = b0 + b1 u + b2 tanh(k u) and g = b3 + b4 sech^2(k u) (Coleman and
    /// Hodgdon 1986).
    kColemanHodgdon,
  };
  /// Fitted by least squares: coefficients exactly for given shapes, shapes from a grid of starts on.
  HysteresisLaw(Kind kind, const Eigen::VectorXd& input, const Eigen::VectorXd& output);

  /// What it makes of an input that comes from -1.
  [[nodiscard]] auto estimate(const Eigen::VectorXd& input) const -> Eigen::VectorXd;

 private:
  Kind kind_;
  Eigen::VectorXd shapes_;
  Eigen::VectorXd coefficients_;
};

}  // namespace capstan::tools
