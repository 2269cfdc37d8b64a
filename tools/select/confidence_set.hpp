// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace capstan::tools {

/// What the model confidence set says of each of several models.
struct ConfidenceSet {
  std::vector<bool> in_set;
  std::vector<double> p_values;  ///< a model is in the set at every level below its own
};

/// The models that may be the best of all at a confidence of 1 - level, whatever luck the log brought (Hansen, Lunde,
/// Nason 2011, T_max): as long as the models left differ more than resampled losses do, the worst goes. `losses`: a row
/// per piece of the log in order, a column per model; runs of `run` pieces are resampled together.
/// @pre at least one model, no loss is infinite
auto confidence_set(const Eigen::MatrixXd& losses, double level, int resamplings, Eigen::Index run) -> ConfidenceSet;

}  // namespace capstan::tools
