// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tools/diagnose/adequacy.hpp"
#include "capstan/tools/support/side_by_side.hpp"

namespace capstan::tools {
namespace {

/// Of a column's energy the law takes up all but this share: what is left is rounding, and no direction.
constexpr double kRounding = 1e-10;

/// Lays the columns of all parts side by side; the candidates' variants learn where theirs begin.
auto lay_out(const LawResidual& residual, const Eigen::MatrixXd& flexible, std::vector<Candidate>& candidates,
             Layout& layout) -> Eigen::MatrixXd {
  layout.law = residual.base.cols();
  layout.flexible = layout.first_variant();
  for (const auto& candidate : candidates) {
    for (const auto& variant : candidate.variants) {
      layout.flexible += variant.columns.cols();
    }
  }
  layout.total = layout.flexible + flexible.cols();
  Eigen::MatrixXd columns(residual.base.rows(), layout.total);
  columns.leftCols(layout.law) = residual.base;
  columns.col(layout.error()) = residual.error;
  Eigen::Index next = layout.first_variant();
  for (auto& candidate : candidates) {
    for (auto& variant : candidate.variants) {
      variant.first = next;
      columns.middleCols(next, variant.columns.cols()) = variant.columns;
      next += variant.columns.cols();
      variant.columns.resize(0, 0);
    }
  }
  columns.rightCols(flexible.cols()) = flexible;
  return columns;
}

/// What even a law with an offset that wanders and coefficients that change along the record leaves. Noise is looked
/// for in that: slow changes are effects, and a noise model that has learned them excuses them.
auto steadied(const Preparation& p, const LawResidual& residual) -> Eigen::VectorXd {
  constexpr Eigen::Index kOffsetWaves = 6;
  constexpr Eigen::Index kCoefficientWaves = 2;
  const Eigen::ArrayXd time = p.signals.time_s.array() / p.signals.time_s.maxCoeff();
  const auto wave = [&time](Eigen::Index k) -> Eigen::ArrayXd {
    return (std::numbers::pi * static_cast<double>(k) * time).cos();
  };
  const Eigen::Index law = residual.base.cols();
  Eigen::MatrixXd slow(residual.base.rows(), law * (1 + kCoefficientWaves) + 1 + kOffsetWaves);
  for (Eigen::Index k = 0; k <= kCoefficientWaves; ++k) {
    slow.middleCols(k * law, law) = residual.base.array().colwise() * wave(k);
  }
  for (Eigen::Index k = 0; k <= kOffsetWaves; ++k) {
    slow.col((1 + kCoefficientWaves) * law + k) = wave(k).matrix();
  }
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(slow.cols(), slow.cols());
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(slow.cols());
  for (const auto& block : p.split.learned()) {
    const auto x = slow.middleRows(block.begin, block.size());
    gram.noalias() += x.transpose() * x;
    rhs.noalias() += x.transpose() * residual.error.segment(block.begin, block.size());
  }
  return residual.error - slow * gram.completeOrthogonalDecomposition().solve(rhs);
}

void model_noise(const Preparation& p, const LawResidual& residual, Evidence& evidence) {
  evidence.noise_from_repeats = p.repeats.has_value();
  const Eigen::VectorXd rest = steadied(p, residual);
  if (!evidence.noise_from_repeats) {
    evidence.noise = fit_noise(rest, p.split.learned(), kLargestNoiseOrder);
    return;
  }
  const Repeats cycles = learned_cycles(p);
  Blocks pieces;
  for (Eigen::Index i = 0; i < cycles.count; ++i) {
    pieces.push_back(cycles.cycle(i));
  }
  // What the encoder hides repeats with the motion, and is noise all the same.
  evidence.noise = fit_noise(pure_error(rest, cycles) + residual.resolution, pieces, kLargestNoiseOrder);
}

/// Makes a gram whole of which only what stands on and below the diagonal was worked out, by squares that fit into the
/// processor's cache: along a row every value is far from its neighbour.
void copy_below_to_above(Eigen::MatrixXd& gram) {
  constexpr Eigen::Index kSide = 16;
  for (Eigen::Index col = 0; col < gram.cols(); col += kSide) {
    const Eigen::Index width = std::min(kSide, gram.cols() - col);
    for (Eigen::Index above = 0; above < col; above += kSide) {
      gram.block(above, col, kSide, width) = gram.block(col, above, width, kSide).transpose();
    }
    for (Eigen::Index i = 1; i < width; ++i) {
      gram.col(col + i).segment(col, i) = gram.row(col + i).segment(col, i).transpose();
    }
  }
}

void sort_blocks(const Split& split, Evidence& evidence) {
  std::size_t next = 0;
  for (const auto& block : split.blocks) {
    if (block.role != Role::kReport) {
      (block.role == Role::kFit ? evidence.fit : evidence.choose).push_back(next);
      evidence.learned.push_back(next++);
    }
  }
}

}  // namespace

BlockGrams::BlockGrams(const Eigen::MatrixXd& columns, const Layout& layout, const Blocks& blocks) : layout_(layout) {
  for (const auto& block : blocks) {
    const auto x = columns.middleRows(block.begin, block.size());
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(layout.total, layout.total);
    gram.selfadjointView<Eigen::Lower>().rankUpdate(x.transpose());
    copy_below_to_above(gram);
    grams_.push_back(std::move(gram));
    rows_.push_back(static_cast<double>(block.size()));
  }
}

auto BlockGrams::sum(const std::vector<std::size_t>& blocks) const -> Eigen::MatrixXd {
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(layout_.total, layout_.total);
  for (const std::size_t block : blocks) {
    total += grams_[block];
  }
  return total;
}

auto BlockGrams::sum(const std::vector<std::size_t>& blocks, const std::vector<Eigen::Index>& columns) const
    -> Eigen::MatrixXd {
  const auto n = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(n, n);
  for (const std::size_t block : blocks) {
    total += grams_[block](columns, columns);
  }
  return total;
}

auto BlockGrams::projected(const std::vector<std::size_t>& blocks) const -> Projected {
  const Eigen::MatrixXd all = sum(blocks);
  const Eigen::Index k = layout_.law;
  const Eigen::Index rest = layout_.total - k;
  const Eigen::VectorXd scale = all.diagonal().head(k).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd law = scale.asDiagonal() * all.topLeftCorner(k, k) * scale.asDiagonal();
  law.diagonal().array() += 1e-12;
  const Eigen::MatrixXd cross = scale.asDiagonal() * all.topRightCorner(k, rest);
  Projected result;
  result.gram = all.bottomRightCorner(rest, rest) - cross.transpose() * law.ldlt().solve(cross);
  for (Eigen::Index i = 1; i < rest; ++i) {
    if (result.gram(i, i) < kRounding * all(k + i, k + i)) {
      result.gram.row(i).setZero();
      result.gram.col(i).setZero();
    }
  }
  for (const std::size_t block : blocks) {
    result.rows += rows_[block];
  }
  return result;
}

auto BlockGrams::energy(std::size_t block, const std::vector<Eigen::Index>& columns, const Eigen::VectorXd& theta) const
    -> double {
  const auto& gram = grams_[block];
  if (static_cast<Eigen::Index>(columns.size()) > layout_.total / 4) {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(layout_.total);
    all[layout_.error()] = 1.0;
    all(columns) -= theta;
    return std::max(all.dot(gram * all), 0.0);
  }
  const Eigen::Index error = layout_.error();
  double energy = gram(error, error);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    double product = -2.0 * gram(error, columns[i]);
    for (std::size_t j = 0; j < columns.size(); ++j) {
      product += theta[static_cast<Eigen::Index>(j)] * gram(columns[i], columns[j]);
    }
    energy += theta[static_cast<Eigen::Index>(i)] * product;
  }
  return std::max(energy, 0.0);
}

auto fit_variant(const Projected& projected, const Layout& layout, const Candidate& candidate, std::size_t variant)
    -> CandidateFit {
  const auto& gram = projected.gram;
  const Eigen::Index first = candidate.variants[variant].first - layout.law;
  const auto n = static_cast<Eigen::Index>(candidate.signs.size());
  CandidateFit fit{variant, Eigen::VectorXd::Zero(n), 0.0};
  if (candidate.acts_on_output) {
    fit.theta[0] = 1.0;
    fit.gain = std::max(0.0, 2.0 * gram(first, 0) - gram(first, first));
    return fit;
  }
  if (n == 1) {
    const double theta = gram(first, first) > 0.0 ? gram(first, 0) / gram(first, first) : 0.0;
    if (has_sign(theta, candidate.signs[0])) {
      fit.theta[0] = theta;
      fit.gain = theta * gram(first, 0);
    }
    return fit;
  }
  const Eigen::VectorXd rhs = gram.col(0).segment(first, n);
  fit.theta = solve_signed(gram.block(first, first, n, n), rhs, candidate.signs);
  fit.gain = fit.theta.dot(rhs);
  return fit;
}

auto fit_candidate(const Projected& projected, const Layout& layout, const Candidate& candidate) -> CandidateFit {
  const std::size_t first = candidate.acts_on_output ? 1 : 0;  // the exact variant is no linear one
  CandidateFit best = fit_variant(projected, layout, candidate, first);
  for (std::size_t i = first + 1; i < candidate.variants.size(); ++i) {
    const CandidateFit fit = fit_variant(projected, layout, candidate, i);
    if (fit.gain > best.gain) {
      best = fit;
    }
  }
  return best;
}

auto gather_evidence(const Preparation& p, const LawForm& law, const LawResidual& residual) -> Evidence {
  Evidence evidence;
  evidence.error = residual.error;
  evidence.by_energy = law.catalogue->target() != TargetKind::kAngle;
  evidence.candidates = catalogue_candidates(p, law, residual);
  for (auto& candidate : probe_candidates(p, *law.catalogue, residual)) {
    if (!law.catalogue->has(candidate.name)) {
      evidence.candidates.push_back(std::move(candidate));
    }
  }
  evidence.columns = lay_out(residual, p.interpolated(flexible_features(p.signals, law.catalogue->target())),
                             evidence.candidates, evidence.layout);
  if (residual.adapted.cols() > 0) {
    project_out(residual.adapted, p.split.learned(),
                evidence.columns.rightCols(evidence.layout.total - evidence.layout.first_variant()));
  }
  model_noise(p, residual, evidence);
  sort_blocks(p.split, evidence);
  const Blocks blocks = p.split.learned();
  evidence.sensing.resize(residual.error.size(), 2);
  evidence.sensing << residual.resolution, residual.torque_noise;
  evidence.white_sensing = whitened(evidence.sensing, p.coarse_logs, evidence.noise);
  evidence.raw_white.resize(2);
  Eigen::MatrixXd white;
  two_at_a_time(2, [&](std::size_t i) {
    if (i == 1) {
      white = whitened(evidence.columns, p.coarse_logs, evidence.noise);
    }
    evidence.raw_white[i] = BlockGrams(i == 1 ? white : evidence.columns, evidence.layout, blocks);
  });
  evidence.white_error = white.col(evidence.layout.error());
  const Projected all = evidence.white().projected(evidence.learned);
  const double dof = std::max(1.0, all.rows - static_cast<double>(evidence.layout.law));
  evidence.innovation_variance =
      evidence.noise_from_repeats ? evidence.noise.innovation_variance : all.error_energy() / dof;
  return evidence;
}

}  // namespace capstan::tools
