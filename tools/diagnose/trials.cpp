// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnose/trials.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/support/random.hpp"

namespace capstan::tools {
namespace {

constexpr int kDraws = 499;
/// One-sided 5 % point of the normal: the worse of two laws is called worse no sooner.
constexpr double kVuong = 1.645;

/// Square root of a positive semidefinite matrix, for drawing normal vectors.
auto square_root(const Eigen::MatrixXd& covariance) -> Eigen::MatrixXd {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// Gain, in noise variances, of the luckiest family in draws of noise alone; sorted.
auto luckiest_gains(const Evidence& evidence, const Projected& rows) -> std::vector<double> {
  const Eigen::Index variants = evidence.layout.flexible - evidence.layout.first_variant();
  Projected drawn = rows;
  drawn.gram /= evidence.innovation_variance;
  const Eigen::MatrixXd root = square_root(drawn.gram.block(1, 1, variants, variants));
  Random random(0xCA95);
  std::vector<double> largest;
  Eigen::VectorXd normal(variants);
  for (int draw = 0; draw < kDraws; ++draw) {
    for (double& value : normal) {
      value = random.normal();
    }
    drawn.gram.col(0).segment(1, variants) = root * normal;
    double gain = 0.0;
    for (const auto& family : evidence.families) {
      gain = std::max(gain, fit_family(drawn, evidence.layout, family).gain);
    }
    largest.push_back(gain);
  }
  std::sort(largest.begin(), largest.end());
  return largest;
}

auto p_value_of(double statistic, const std::vector<double>& sorted) -> double {
  const auto above = sorted.end() - std::lower_bound(sorted.begin(), sorted.end(), statistic);
  return (static_cast<double>(above) + 1.0) / (static_cast<double>(sorted.size()) + 1.0);
}

/// log E of Wasserman, Ramdas and Balakrishnan: the law with the effect as fitted elsewhere, against the best that the law alone
/// can do with hindsight on the choosing rows.
auto split_likelihood(const Evidence& evidence, const Projected& choose, const Family& family, const FamilyFit& fit) -> double {
  const BlockGrams& white = evidence.white();
  const double with_effect = block_energies(white, evidence.choose, beside_law(white, evidence.fit, family, fit)).sum();
  const double law_alone = choose.error_energy();
  if (evidence.noise_from_repeats) {
    return (law_alone - with_effect) / (2.0 * evidence.innovation_variance);
  }
  return 0.5 * choose.rows * std::log(law_alone / with_effect);
}

auto likelihood_gain_of(const Evidence& evidence, const Projected& rows, double gain) -> double {
  if (evidence.noise_from_repeats) {
    return gain / evidence.innovation_variance;
  }
  const double left = std::max(rows.error_energy() - gain, 1e-12 * rows.error_energy());
  return rows.rows * std::log(rows.error_energy() / left);
}

/// Share of a variant's columns that the law takes up, and the smallest contribution that would still have been confirmed.
void judge_visibility(const Evidence& evidence, const Projected& learned, const Family& family, FamilyTrial& trial) {
  const ColumnList columns = columns_of(family, trial.learned.variant);
  const Eigen::MatrixXd white = evidence.white().sum(evidence.learned, columns);
  const Eigen::MatrixXd raw = evidence.raw().sum(evidence.learned, columns);
  double seen = 0.0;
  for (const Eigen::Index column : columns) {
    seen += learned.gram(column - evidence.layout.law, column - evidence.layout.law);
  }
  trial.absorbed = white.trace() > 0.0 ? std::clamp(1.0 - seen / white.trace(), 0.0, 1.0) : 1.0;
  double choosing = 0.0;
  for (const std::size_t block : evidence.choose) {
    choosing += evidence.white().rows(block);
  }
  const double share = std::max(choosing / learned.rows, 1e-3);
  const double lambda = 2.0 * evidence_needed(evidence) / share;
  trial.detectable = seen > 0.0 ? std::sqrt(lambda * evidence.innovation_variance / seen * raw.trace() / learned.rows) : std::numeric_limits<double>::infinity();
}

/// Largest share of the direction x (given by its products with all columns and its energy) that a family can copy.
auto copied_share(const Projected& rows, const Layout& layout, const Family& family, const Eigen::VectorXd& products, double energy)
    -> double {
  double largest = 0.0;
  const auto n = static_cast<Eigen::Index>(family.signs.size());
  const std::vector<Sign> any(family.signs.size(), Sign::kAny);
  for (const auto& variant : family.variants) {
    const Eigen::Index first = variant.first - layout.law;
    const Eigen::VectorXd rhs = products.segment(first, n);
    const Eigen::VectorXd theta = solve_signed(rows.gram.block(first, first, n, n), rhs, any);
    largest = std::max(largest, theta.dot(rhs) / energy);
  }
  return std::min(largest, 1.0);
}

}  // namespace

auto evidence_needed(const Evidence& evidence) -> double {
  return std::log(static_cast<double>(evidence.families.size()) / kAlpha);
}

auto try_families(const Evidence& evidence) -> std::vector<FamilyTrial> {
  const Projected fit_rows = evidence.white().projected(evidence.fit);
  const Projected choose_rows = evidence.white().projected(evidence.choose);
  const Projected learned_rows = evidence.white().projected(evidence.learned);
  const auto lucky = luckiest_gains(evidence, fit_rows);
  const Eigen::VectorXd alone = cross_validated(evidence.raw(), evidence.learned, {});
  std::vector<FamilyTrial> trials;
  for (std::size_t i = 0; i < evidence.families.size(); ++i) {
    const Family& family = evidence.families[i];
    FamilyTrial trial;
    trial.family = i;
    trial.fit = fit_family(fit_rows, evidence.layout, family);
    trial.learned = fit_family(learned_rows, evidence.layout, family);
    trial.p_value = p_value_of(trial.fit.gain / evidence.innovation_variance, lucky);
    if (trial.fit.gain > 0.0) {
      trial.log_evidence = split_likelihood(evidence, choose_rows, family, trial.fit);
      const auto with_effect = cross_validated(evidence.raw(), evidence.learned, columns_of(family, trial.fit.variant));
      trial.block_t = t_statistic(alone - with_effect);
      trial.raw_explained = 1.0 - with_effect.sum() / alone.sum();
    }
    trial.likelihood_gain = likelihood_gain_of(evidence, learned_rows, trial.learned.gain);
    judge_visibility(evidence, learned_rows, family, trial);
    trials.push_back(std::move(trial));
  }
  return trials;
}

auto passes(const FamilyTrial& trial, const Evidence& evidence) -> bool {
  return trial.p_value <= kAlpha && trial.log_evidence >= evidence_needed(evidence);
}

auto confusable_with(const Evidence& evidence, const std::vector<FamilyTrial>& trials, std::size_t best)
    -> std::vector<std::size_t> {
  const Projected rows = evidence.white().projected(evidence.learned);
  const Family& own = evidence.families[best];
  const FamilyFit& fit = trials[best].learned;
  const Eigen::Index first = own.variants[fit.variant].first - evidence.layout.law;
  const Eigen::VectorXd products = rows.gram.middleCols(first, fit.theta.size()) * fit.theta;
  const double energy = fit.theta.dot(products.segment(first, fit.theta.size()));
  const Eigen::VectorXd own_energies =
      block_energies(evidence.white(), evidence.learned, beside_law(evidence.white(), evidence.learned, own, fit));
  std::vector<std::size_t> confusable;
  for (const auto& other : trials) {
    const Family& family = evidence.families[other.family];
    if (other.family == best || other.learned.gain <= 0.0) {
      continue;
    }
    const double copied = copied_share(rows, evidence.layout, family, products, energy);
    const bool would_have_shown = trials[best].likelihood_gain * (1.0 - copied) >= 2.0 * evidence_needed(evidence);
    const auto other_energies = block_energies(evidence.white(), evidence.learned,
                                               beside_law(evidence.white(), evidence.learned, family, other.learned));
    const bool worse = t_statistic(other_energies - own_energies) > kVuong;
    if (!would_have_shown || !worse) {
      confusable.push_back(other.family);
    }
  }
  return confusable;
}

}  // namespace capstan::tools
