// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/trials.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/side_by_side.hpp"

namespace capstan::tools {
namespace {

constexpr int kTrialDraws = 499;
/// One-sided 5 % point of the normal: the worse of two laws is called worse no sooner.
constexpr double kVuong = 1.645;
/// Student's t, over some 40 blocks at a half of kAlpha, of what is explained out of fold.
constexpr double kConfirmed = 2.7;
/// Times the evidence that any confirmation needs: beyond this no doubt about what neither law explains is left.
constexpr double kOverwhelming = 3.0;

/// Scale products to correlations: columns without any energy have none with others.
auto correlations(const Eigen::MatrixXd& products) -> Eigen::MatrixXd {
  const Eigen::VectorXd sizes = products.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd per_size = (sizes.array() > 0.0).select(sizes.cwiseInverse(), 0.0);
  Eigen::MatrixXd scaled = per_size.asDiagonal() * products * per_size.asDiagonal();
  scaled.diagonal().setOnes();
  return scaled;
}

/// Gives each candidate's column some energy that no other column has, so much that their products have a square root
/// whatever rounding leaves of columns that others reproduce. Without it draws of noise gained a hundred times what
/// noise does, and how much turned with the last decimal of a log.
auto told_apart(Projected rows, Eigen::Index variants) -> Projected {
  auto own = rows.gram.block(1, 1, variants, variants);
  const Eigen::MatrixXd shared = correlations(own);
  for (double share = 1e-9; share < 1.0; share *= 10.0) {
    Eigen::MatrixXd apart = shared;
    apart.diagonal().array() += share;
    if (apart.llt().info() == Eigen::Success) {
      own.diagonal() *= 1.0 + share;
      break;
    }
  }
  return rows;
}

/// A matrix R with R R' = covariance: R times independent normals has that covariance. Without pivots, whose order
/// turns with the last decimal of a log and takes the draws with it.
auto square_root(const Eigen::MatrixXd& covariance) -> Eigen::MatrixXd {
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         Eigen::MatrixXd(correlations(covariance).llt().matrixL());
}

/// Gain, in noise variances, of the null_maximum candidate in draws of noise alone; sorted.
auto null_maxima(const Evidence& evidence, const Projected& rows) -> std::vector<double> {
  const Eigen::Index variants = evidence.layout.flexible - evidence.layout.first_variant();
  Projected drawn = rows;
  drawn.gram /= evidence.innovation_variance;
  const Eigen::MatrixXd root = square_root(drawn.gram.block(1, 1, variants, variants));
  Random random(0xCA95);
  Eigen::MatrixXd normals(variants, kTrialDraws);
  for (double& value : normals.reshaped()) {
    value = random.normal();
  }
  const Eigen::MatrixXd products = root * normals;
  std::vector<double> largest(kTrialDraws);
  two_at_a_time(2, [&](std::size_t half) {
    Projected own = drawn;
    for (std::size_t draw = half; draw < largest.size(); draw += 2) {
      own.gram.col(0).segment(1, variants) = products.col(static_cast<Eigen::Index>(draw));
      double gain = 0.0;
      for (const auto& candidate : evidence.candidates) {
        gain = std::max(gain, fit_candidate(own, evidence.layout, candidate).gain);
      }
      largest[draw] = gain;
    }
  });
  std::sort(largest.begin(), largest.end());
  return largest;
}

auto p_value_of(double statistic, const std::vector<double>& sorted) -> double {
  const auto above = sorted.end() - std::lower_bound(sorted.begin(), sorted.end(), statistic);
  return (static_cast<double>(above) + 1.0) / (static_cast<double>(sorted.size()) + 1.0);
}

/// Every other of the blocks.
auto half_of(const Blocks& blocks, std::size_t which) -> Blocks {
  Blocks half;
  for (std::size_t i = which; i < blocks.size(); i += 2) {
    half.push_back(blocks[i]);
  }
  return half;
}

/// Tries candidates one after the other on the same evidence.
class TrialJudge {
 public:
  TrialJudge(const Preparation& p, const Evidence& evidence)
      : evidence_(evidence),
        known_(evidence.noise_from_repeats ? &evidence.noise : nullptr),
        learned_rows_(p.split.learned()),
        fit_products_(told_apart(evidence.white().projected(evidence.fit),
                                 evidence.layout.flexible - evidence.layout.first_variant())),
        learned_products_(evidence.white().projected(evidence.learned)),
        null_maxima_(null_maxima(evidence, fit_products_)),
        law_(law_model(evidence.layout)) {
    law_energies_ = cross_validated(evidence.raw(), evidence.learned, law_);
    law_likelihood_ = likelihoods(law_).sum();
    for (std::size_t half = 0; half < 2; ++half) {
      const Blocks rows = half_of(learned_rows_, half);
      law_halves_[half] = judged(law_, profile(law_, rows), rows).sum();
    }
  }

  auto try_candidate(std::size_t index) const -> CandidateTrial {
    const Candidate& candidate = evidence_.candidates[index];
    CandidateTrial trial;
    trial.candidate = index;
    const CandidateFit linear = fit_candidate(fit_products_, evidence_.layout, candidate);
    trial.variant = candidate.acts_on_output ? 0 : linear.variant;
    const ColumnModel model = model_of(evidence_.layout, candidate, trial.variant);
    const double gain = candidate.acts_on_output ? exact_gain(model) : linear.gain;
    trial.possible = gain > 0.0 && !candidate.waits;
    trial.p_value = p_value_of(gain / evidence_.innovation_variance, null_maxima_);
    judge_visibility(model, trial);
    if (trial.possible) {
      trial.energies = cross_validated(evidence_.raw(), evidence_.learned, model);
      trial.explained = 1.0 - trial.energies.sum() / law_energies_.sum();
      trial.explained_t = t_statistic(law_energies_ - trial.energies);
      if (evidence_.by_energy) {  // an effort's few jerks hold most of its energy, and make the mean uncertain
        trial.explained_t = std::max(trial.explained_t, signed_rank_score(law_energies_ - trial.energies));
      }
      trial.likelihoods = likelihoods(model);
      trial.log_likelihood = trial.likelihoods.sum() - law_likelihood_;
      trial.log_e_value = cross_fitted_evidence(model);
    }
    return trial;
  }

 private:
  auto profile(const ColumnModel& model, const Blocks& rows) const -> Profile {
    return fit_profile(evidence_.columns, evidence_.layout, model, rows, known_);
  }
  auto judged(const ColumnModel& model, const Profile& fitted, const Blocks& rows) const -> Eigen::VectorXd {
    return log_likelihood(evidence_.columns, evidence_.layout, model, fitted, rows);
  }
  auto likelihoods(const ColumnModel& model) const -> Eigen::VectorXd {
    const Profile fitted = fit_profile(evidence_.columns, evidence_.layout, model, learned_rows_, nullptr);
    return judged(model, fitted, learned_rows_);
  }

  /// Wasserman, Ramdas and Balakrishnan: each half judges the model as the other half taught it, against the best that
  /// the law alone can do noncausally. The mean of the two ratios is again a valid one.
  auto cross_fitted_evidence(const ColumnModel& model) const -> double {
    double log_ratio[2];
    for (std::size_t half = 0; half < 2; ++half) {
      const Profile taught = profile(model, half_of(learned_rows_, 1 - half));
      log_ratio[half] = judged(model, taught, half_of(learned_rows_, half)).sum() - law_halves_[half];
    }
    const double larger = std::max(log_ratio[0], log_ratio[1]);
    const double smaller = std::min(log_ratio[0], log_ratio[1]);
    return larger + std::log(0.5 * (1.0 + std::exp(smaller - larger)));
  }

  auto exact_gain(const ColumnModel& model) const -> double {
    const auto& white = evidence_.white();
    const double with_effect = block_energies(white, evidence_.fit, fit_model(white, evidence_.fit, model)).sum();
    return std::max(0.0, fit_products_.error_energy() - with_effect);
  }

  /// Share of a variant's columns that the law takes up, and the smallest contribution that would still have been
  /// confirmed.
  void judge_visibility(const ColumnModel& model, CandidateTrial& trial) const {
    ColumnList own = model.fixed >= 0 ? ColumnList{model.fixed} : model.free;
    own.erase(own.begin(), model.fixed >= 0 ? own.begin() : own.begin() + evidence_.layout.law);
    const double white = evidence_.white().sum(evidence_.learned, own).trace();
    const double raw = evidence_.raw().sum(evidence_.learned, own).trace();
    double seen = 0.0;
    for (const Eigen::Index column : own) {
      seen += learned_products_.gram(column - evidence_.layout.law, column - evidence_.layout.law);
    }
    trial.absorbed = white > 0.0 ? std::clamp(1.0 - seen / white, 0.0, 1.0) : 1.0;
    const double lambda = 4.0 * evidence_needed(evidence_);  // half of the rows judge
    trial.detectable = seen > 0.0
                           ? std::sqrt(lambda * evidence_.innovation_variance / seen * raw / learned_products_.rows)
                           : std::numeric_limits<double>::infinity();
  }

  const Evidence& evidence_;
  const AutoregressiveNoise* known_;
  Blocks learned_rows_;
  Projected fit_products_, learned_products_;
  std::vector<double> null_maxima_;
  ColumnModel law_;
  Eigen::VectorXd law_energies_;
  double law_likelihood_ = 0.0;
  double law_halves_[2] = {};
};

}  // namespace

auto clearly_positive(const Eigen::VectorXd& margin) -> bool {
  return margin.sum() > 0.0 && std::max(t_statistic(margin), signed_rank_score(margin)) > kVuong;
}

auto evidence_needed(const Evidence& evidence) -> double {
  return std::log(static_cast<double>(evidence.candidates.size()) / kAlpha);
}

auto try_candidates(const Preparation& p, const Evidence& evidence, const SieveResult& sieve)
    -> std::vector<CandidateTrial> {
  const TrialJudge judge(p, evidence);
  std::vector<CandidateTrial> trials(evidence.candidates.size());
  two_at_a_time(trials.size(), [&](std::size_t i) {
    trials[i] = judge.try_candidate(i);
    trials[i].p_sieve = sieve.candidate_p[i];
  });
  return trials;
}

auto passes(const CandidateTrial& trial, const Evidence& evidence) -> bool {
  const bool whitened = trial.p_value <= 0.5 * kAlpha && trial.log_e_value >= evidence_needed(evidence);
  const bool across_halves = trial.p_sieve <= 0.5 * kAlpha;
  if (evidence.by_energy) {
    const bool detected = std::min(trial.p_value, trial.p_sieve) <= 0.5 * kAlpha;
    return trial.possible && trial.explained > 0.0 && detected && trial.explained_t > kConfirmed;
  }
  return trial.possible && trial.explained > 0.0 && (whitened || across_halves);
}

auto confusable_with(const Evidence& evidence, const std::vector<CandidateTrial>& trials, std::size_t best,
                     double floor_energy) -> std::vector<std::size_t> {
  const CandidateTrial& own = trials[best];
  const double left_by_best = std::max(0.0, own.energies.sum() - floor_energy);
  std::vector<std::size_t> confusable;
  for (const auto& other : trials) {
    if (other.candidate == best || !other.possible) {
      continue;
    }
    const Eigen::VectorXd margin = own.likelihoods - other.likelihoods;
    const Eigen::VectorXd raw_margin = other.energies - own.energies;
    const bool worse =
        margin.sum() > evidence_needed(evidence) && (clearly_positive(margin) || clearly_positive(raw_margin));
    // A noise model may swallow a smooth misfit; energy does not. Twice what the best leaves is no tie.
    const bool leaves_far_more = clearly_positive(raw_margin) && raw_margin.sum() > own.energies.sum();
    const bool simpler =
        parameter_count(evidence.candidates[other.candidate]) <= parameter_count(evidence.candidates[best]);
    // Evidence that contradicts itself rules out no name: rows that were not fitted are predicted better for certain.
    const bool predicts_better =
        evidence.candidates[other.candidate].in_catalogue && clearly_positive(own.energies - other.energies);
    const bool beyond_doubt =
        !simpler || margin.sum() > kOverwhelming * evidence_needed(evidence) || raw_margin.sum() > left_by_best;
    if (!leaves_far_more && (!worse || !beyond_doubt || predicts_better)) {
      confusable.push_back(other.candidate);
    }
  }
  return confusable;
}

}  // namespace capstan::tools
