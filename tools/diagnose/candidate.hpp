// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tools/diagnose/preparation.hpp"

namespace capstan::tools {

/// One setting of an effect's shapes, and its columns.
struct Variant {
  Shapes shapes;
  Eigen::MatrixXd columns;  ///< coarse rows; moved into the evidence's matrix when that is built
  Eigen::Index first = 0;   ///< column there
};

/// One possible effect with the grid of its shapes.
struct Candidate {
  std::string name;
  bool in_catalogue = false;  ///< false: a probe, which can be recognised but not added to the law
  /// An output term: its column is the change of the fitted law itself, so its factor is 1. The first variant is exact
  /// and has, after that column, the law's columns passed through the term, which replace the law's own; the others are
  /// there for the null distribution only, where the law is right and need not be refitted through the term.
  bool acts_on_output = false;
  /// A difference from effects that the law does not have yet (those of `builds_on`): it can only come with one of
  /// them.
  bool waits = false;
  std::vector<std::string> builds_on;
  /// Effects that it has within itself: where these do as well, it gives way, and it is no rival of theirs.
  std::vector<std::string> special_cases;
  std::vector<Sign> signs;   ///< one per column of a variant that belongs to the effect
  std::size_t searched = 0;  ///< shapes that a fit searches for; the others are given
  bool wider = false;        ///< a form of an effect that has the usual one within itself
  std::vector<Variant> variants;
};

/// What the law so far leaves over.
struct LawResidual {
  Eigen::VectorXd fitted;     ///< the law's angle, every sample
  Eigen::MatrixXd full_base;  ///< columns of the law, every sample: coefficients, and sensitivities to its shapes
  Eigen::MatrixXd base;       ///< the same, coarse
  Eigen::VectorXd error;      ///< target less fitted, coarse
  Eigen::MatrixXd adapted;    ///< coarse columns that have taken up whatever they can and are not fitted again; or none
  /// What the encoder's resolution (and a Preisach grid's), and the torque's noise bring into the law, one draw each,
  /// coarse.
  Eigen::VectorXd resolution, torque_noise;
};

/// The effects of the catalogue that the law does not have yet. Shapes lie on a grid over their range, refined around
/// the one that fits the residual best on the rows that fit.
auto catalogue_candidates(const Preparation& p, const LawForm& law, const LawResidual& residual)
    -> std::vector<Candidate>;

/// A spring's rest may be anywhere, so a level comes with it where the law has none; it is no effect of its own.
auto brings_offset(const LawForm& law, const std::string& effect) -> bool;

/// Free parameters of an effect: coefficients and shapes.
auto parameter_count(const Candidate& candidate) -> std::size_t;

/// Effects that the catalogue lacks. They stand in the same line-up as the catalogue's, so that something foreign is
/// not given the nearest catalogue name. They never enter a law.
auto probe_candidates(const Preparation& p, const Catalogue& catalogue, const LawResidual& residual)
    -> std::vector<Candidate>;

/// Smooth bumps over (q1, dq1, tau; of an effort ddq1 and the way since the reversal instead of tau) and time: with all
/// candidates together, the flexible model that no law can be expected to beat.
auto flexible_features(const CoarseSignals& signals, TargetKind target) -> Eigen::MatrixXd;

}  // namespace capstan::tools
