// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tools/diagnose/cross_validation.hpp"

namespace capstan::tools {

/// Error rate that each decision is held to.
inline constexpr double kAlpha = 0.01;

/// What one family has to say for itself.
struct FamilyTrial {
  std::size_t family = 0;
  FamilyFit fit;                 ///< on the rows that fit, whitened
  FamilyFit learned;             ///< on fit and choose together, whitened
  double p_value = 1.0;          ///< family-wise: of the largest statistic over all families and shapes
  double log_evidence = 0.0;     ///< split likelihood ratio on the rows that choose, nats
  double block_t = 0.0;          ///< t over blocks of the cross-validated gain in the measured quantity
  double raw_explained = 0.0;    ///< share of the residual's energy in the measured quantity that it takes away, out of fold
  double likelihood_gain = 0.0;  ///< 2 log likelihood ratio on fit and choose together (lambda)
  double absorbed = 0.0;         ///< share of its columns that the law takes up
  double detectable = 0.0;       ///< rms of the smallest contribution that these rows would have shown, in the target's unit
};

/// Puts every family on trial. Detection: the largest gain over its shapes on the rows that fit, against the luckiest of all
/// families when only noise is there. Confirmation: split likelihood ratio on the rows that choose.
/// The noise's products with the columns are drawn from their normal limit under the autoregressive noise model, that is the AR
/// sieve bootstrap of the maximum in its limit of many rows; a draw then costs no pass over the log.
auto try_families(const Evidence& evidence) -> std::vector<FamilyTrial>;

/// Nats that the split likelihood ratio has to reach: ln(families / alpha).
auto evidence_needed(const Evidence& evidence) -> double;

/// Detected, and confirmed on other rows.
auto passes(const FamilyTrial& trial, const Evidence& evidence) -> bool;

/// Indices of the families that these rows can not tell from `best`, which itself is left out. A family is ruled out when
/// lambda (1 - R^2) is large enough to have shown the difference and Vuong's test over blocks finds it worse, or when its
/// coefficients would need an impossible sign.
auto confusable_with(const Evidence& evidence, const std::vector<FamilyTrial>& trials, std::size_t best)
    -> std::vector<std::size_t>;

}  // namespace capstan::tools
