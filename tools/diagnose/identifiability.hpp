// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <string>
#include <vector>

#include "capstan/tools/select/effort_law.hpp"

namespace capstan::tools {

/// How well a log excites one parameter of a law.
struct ParameterExcitation {
  std::string name;          ///< term.parameter
  double value = 0.0;        ///< in the law's units
  double half_width = -1.0;  ///< of the 95 % interval; negative if there is none
  double share = 0.0;        ///< rms of what it contributes, over the target's rms about its mean
  double own = 0.0;          ///< of its regressor's energy, what the others can not make up: 1 - R^2
  std::string most_alike;    ///< the parameter it is most correlated with; empty if it is alone
  double correlation = 0.0;  ///< with that one
  [[nodiscard]] auto holds_zero() const -> bool { return half_width > (value < 0.0 ? -value : value); }
};

/// Two parameters of which the log knows a combination far better than either.
struct ConfusedPair {
  std::string first, second;  ///< parameters
  std::array<std::string, 2> terms;
  double correlation = 0.0;
  std::string sentence;  ///< what is known, and the motion that would tell them apart
};

/// What a log can and can not tell of a law's parameters. Correlations are those of the inverse of the regressors'
/// scalar products: they depend on the motion, not on the noise.
struct Identifiability {
  std::vector<ParameterExcitation> parameters;
  Eigen::MatrixXd correlation;  ///< of the estimates, in the order of the parameters
  std::vector<ConfusedPair> confused;
};

/// Of a law that was fitted to these logs; the shapes that a fit searches for are parameters as well. Empty for a table
/// of relays, and where a law has more than forty parameters. @pre the logs have the law's target
auto identifiability_of(const std::vector<AxisLog>& logs, const JointFile& law) -> Identifiability;
/// Of a grown law of an effort; the shapes of its parts were chosen from a grid and are taken as given.
auto identifiability_of(const std::vector<AxisLog>& logs, const EffortLaw& law) -> Identifiability;

}  // namespace capstan::tools
