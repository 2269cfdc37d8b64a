// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/tools/diagnose/cross_validation.hpp"

namespace capstan::tools {

struct SieveResult {
  std::vector<double> candidate_p;  ///< candidate-wise
  double flexible_p = 1.0;          ///< of the flexible model
};

/// p-values by the AR sieve bootstrap, in the measured quantity. A candidate's statistic is the share of the residual's
/// energy that its best shape takes away across two halves of the learned rows, each half predicted from the other;
/// residuals with the same autocorrelation but no effect in them, made from resampled innovations, show what share luck
/// alone brings the null_maximum candidate. Whitened statistics are the sharper where noise is strong; this one where
/// noise is weak and smooth, because there an autoregression mistakes the effect itself for noise.
auto sieve(const Preparation& p, const Evidence& evidence) -> SieveResult;

}  // namespace capstan::tools
