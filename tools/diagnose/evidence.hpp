// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "capstan/tools/diagnose/candidate.hpp"
#include "capstan/tools/diagnose/noise_model.hpp"

namespace capstan::tools {

/// Columns of one round laid side by side: [law | error | variants of all candidates | flexible features].
struct Layout {
  Eigen::Index law = 0;       ///< number of the law's columns, from 0
  Eigen::Index flexible = 0;  ///< first flexible feature
  Eigen::Index total = 0;
  [[nodiscard]] auto error() const -> Eigen::Index { return law; }
  [[nodiscard]] auto first_variant() const -> Eigen::Index { return law + 1; }
};

/// Scalar products of all columns over some rows, the law's columns projected out (Frisch, Waugh, Lovell): whatever is
/// compared here has the law refitted beside it. Index 0 is the error, index i the column law + i of the layout.
struct Projected {
  Eigen::MatrixXd gram;
  double rows = 0.0;
  [[nodiscard]] auto error_energy() const -> double { return gram(0, 0); }
};

/// Scalar products of all columns, block by block: every fit, split, cross-validation and resampling below is sums of
/// these.
class BlockGrams {
 public:
  BlockGrams() = default;
  BlockGrams(const Eigen::MatrixXd& columns, const Layout& layout, const Blocks& blocks);

  [[nodiscard]] auto count() const -> std::size_t { return grams_.size(); }
  [[nodiscard]] auto rows(std::size_t block) const -> double { return rows_[block]; }
  [[nodiscard]] auto layout() const -> const Layout& { return layout_; }
  [[nodiscard]] auto sum(const std::vector<std::size_t>& blocks) const -> Eigen::MatrixXd;
  /// The same for some columns only, in the order given.
  [[nodiscard]] auto sum(const std::vector<std::size_t>& blocks, const std::vector<Eigen::Index>& columns) const
      -> Eigen::MatrixXd;
  [[nodiscard]] auto projected(const std::vector<std::size_t>& blocks) const -> Projected;
  /// Residual energy in one block of error - columns . theta.
  [[nodiscard]] auto energy(std::size_t block, const std::vector<Eigen::Index>& columns,
                            const Eigen::VectorXd& theta) const -> double;

 private:
  Layout layout_;
  std::vector<Eigen::MatrixXd> grams_;
  std::vector<double> rows_;
};

/// A candidate's best variant on some rows, by the projected products alone.
struct CandidateFit {
  std::size_t variant = 0;
  Eigen::VectorXd theta;
  double gain = 0.0;  ///< residual energy taken away; 0 if physics forbids the sign that the data ask for
};

/// Best coefficients of one variant under its candidate's signs.
auto fit_variant(const Projected& projected, const Layout& layout, const Candidate& candidate, std::size_t variant)
    -> CandidateFit;
auto fit_candidate(const Projected& projected, const Layout& layout, const Candidate& candidate) -> CandidateFit;

/// One round's evidence. `raw` is in the measured quantity, `white` is whitened by the noise model.
struct Evidence {
  std::vector<Candidate> candidates;
  Layout layout;
  AutoregressiveNoise noise;
  bool noise_from_repeats = false;
  /// Confirmation and choice go by the energy explained out of fold, not by likelihoods. What an effort law leaves is
  /// least like noise where the motion is jerked; whitened, that little outweighs all friction.
  bool by_energy = false;
  double innovation_variance = 0.0;               ///< per whitened row: pure error, or the law's own residual
  std::vector<std::size_t> fit, choose, learned;  ///< blocks by role
  std::vector<BlockGrams> raw_white;              ///< [0] raw, [1] white
  Eigen::MatrixXd columns;                        ///< all of the layout, coarse rows, in the measured quantity
  Eigen::VectorXd error, white_error;             ///< coarse rows
  Eigen::MatrixXd sensing, white_sensing;         ///< coarse rows; what resolution and torque noise bring into the law
  [[nodiscard]] auto raw() const -> const BlockGrams& { return raw_white[0]; }
  [[nodiscard]] auto white() const -> const BlockGrams& { return raw_white[1]; }
};

auto gather_evidence(const Preparation& p, const LawForm& law, const LawResidual& residual) -> Evidence;

}  // namespace capstan::tools
