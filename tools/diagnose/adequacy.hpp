// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/sieve.hpp"

namespace capstan::tools {

/// Whether a law leaves something that is not noise.
struct Adequacy {
  bool lacks_something = false;
  double lack_of_fit_p = 1.0;  ///< against the pure error of repeated cycles; 1 without repeats
  double flexible_p = 1.0;     ///< of what a flexible model gains, by the sieve bootstrap
  double flexible_t = 0.0;     ///< t over blocks of what a flexible model gains, whitened
  double reducible_share =
      0.0;  ///< share of the residual's energy that a flexible model, or repetition, shows to be no noise
  double hidden_energy = 0.0;  ///< of what sensors and a grid hide from the law, in the measured quantity
  Eigen::VectorXd law_energy;  ///< out of fold per learned block, in the measured quantity
  /// The same for the law with everything flexible added, and for what the sensors of motor angle and torque hide from
  /// any law; no more than the law's in all, and no more than what does not repeat.
  Eigen::VectorXd flexible_energy;
};

/// Share of the energy that something must be to matter: 4 % of the rms error.
inline constexpr double kMatters = 0.08;

/// Judges the law of this round. "Something" must be both certain and large enough to matter.
auto judge_adequacy(const Preparation& p, const Evidence& evidence, const SieveResult& sieve) -> Adequacy;

/// Share of what the flexible model explains beyond `before` that `after` explains too, with the lower 5 % bound over
/// resampled blocks.
struct ExplainedShare {
  double value = 0.0;
  double lower = 0.0;
};
auto explained_share(const Eigen::VectorXd& before, const Eigen::VectorXd& after, const Eigen::VectorXd& flexible)
    -> ExplainedShare;

/// rms of pure error over the cycles that take part in learning, in the measured quantity, where the direction is known
/// in all of them. `error` has every sample.
auto pure_error_level(const Preparation& p, const Eigen::VectorXd& error) -> double;

/// Mean square of what the means of the coarse grid leave out of an error, over the rows to learn from whose direction
/// is known: noise faster than a row. `error` has every sample.
auto averaged_out(const Preparation& p, const Eigen::VectorXd& error) -> double;

/// Cycles that take part in learning; those of the report stay untouched. @pre p.repeats
auto learned_cycles(const Preparation& p) -> Repeats;

}  // namespace capstan::tools
