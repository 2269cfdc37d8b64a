// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/tools/diagnose/profile.hpp"
#include "capstan/tools/diagnose/sieve.hpp"

namespace capstan::tools {

/// Error rate that each decision is held to.
inline constexpr double kAlpha = 0.01;

/// What one candidate has to say for itself.
struct CandidateTrial {
  std::size_t candidate = 0;
  std::size_t variant = 0;   ///< best on the rows that fit
  bool possible = false;     ///< false: the data ask for a sign that physics forbids, or it waits for another effect
  double p_value = 1.0;      ///< candidate-wise: of the largest whitened statistic over all candidates and shapes
  double p_sieve = 1.0;      ///< candidate-wise: of the share explained across halves, by the sieve bootstrap
  double log_e_value = 0.0;  ///< logarithm of the e-value: cross-fitted split likelihood ratio, nats
  double log_likelihood =
      0.0;                 ///< on fit and choose together, with a noise model of its own, above that of the law alone
  double explained = 0.0;  ///< share of the residual's energy that it takes away out of fold, in the measured quantity
  double explained_t = 0.0;  ///< its t over blocks
  double absorbed = 0.0;     ///< share of its columns that the law takes up
  double detectable = 0.0;  ///< rms of the smallest contribution that these rows would have shown, in the target's unit
  Eigen::VectorXd energies;     ///< out of fold per learned block, in the measured quantity
  Eigen::VectorXd likelihoods;  ///< per learned block
};

/// Puts every candidate on trial. Detection: the largest gain over its shapes on the rows that fit, against the
/// null_maximum of all candidates when only noise is there. Confirmation: a split likelihood ratio, each half judging
/// what the other half taught. The noise's products with the columns are drawn from their normal limit under the
/// autoregressive noise model, that is the AR sieve bootstrap of the maximum in its limit of many rows; a draw then
/// costs no pass over the log.
auto try_candidates(const Preparation& p, const Evidence& evidence, const SieveResult& sieve)
    -> std::vector<CandidateTrial>;

/// Nats that the split likelihood ratio has to reach: ln(candidates / alpha).
auto evidence_needed(const Evidence& evidence) -> double;

/// Vuong's test over blocks, one-sided at 5 %: by their mean, or by their ranks where a few blocks with much motion
/// make the mean uncertain.
auto clearly_positive(const Eigen::VectorXd& margin) -> bool;

/// Detected and confirmed on other rows (of an effort by the energy explained there), by either of two ways with half
/// the error rate each: whitened gain and split likelihood, or prediction across halves against the sieve bootstrap.
/// And of use in the measured quantity.
auto passes(const CandidateTrial& trial, const Evidence& evidence) -> bool;

/// Indices of the candidates that these rows can not tell from `best`, which itself is left out. A candidate is ruled
/// out when its coefficients would need an impossible sign; or when its likelihood is lower by as much as any
/// confirmation needs, Vuong's test over blocks agrees, and it falls behind by more than what even the best leaves
/// unexplained
/// (`floor_energy`: of the flexible model): a margin smaller than that may be owed to something that neither has.
/// Or when it leaves twice the energy in the measured quantity.
/// Neither a candidate with more parameters than the best nor one that is overwhelmingly less likely is given that
/// benefit, unless it is listed and predicts rows that it was not fitted to better for certain.
auto confusable_with(const Evidence& evidence, const std::vector<CandidateTrial>& trials, std::size_t best,
                     double floor_energy) -> std::vector<std::size_t>;

}  // namespace capstan::tools
