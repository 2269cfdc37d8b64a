// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/torque_noise.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// The design with as much noise again on its torque, and whether there is any.
auto with_noise_again(LawDesign design, bool& noisy) -> LawDesign {
  std::mt19937_64 random(1);
  std::vector<Samples> samples = design.samples();
  for (Samples& log : samples) {
    Eigen::VectorXd tau(static_cast<Eigen::Index>(log.size()));
    std::transform(log.begin(), log.end(), tau.begin(), [](const auto& s) { return s.tau; });
    const double level = torque_noise_level(tau);
    noisy |= level > 0.0;
    for (auto& sample : log) {
      sample.tau += (random() & 1U) != 0 ? level : -level;
    }
  }
  return design.with(std::move(samples));
}

/// Sums of products over the rows of the blocks.
auto gram_of(const Eigen::MatrixXd& columns, const Blocks& blocks) -> Eigen::MatrixXd {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  for (const RowRange& block : blocks) {
    const auto rows = columns.middleRows(block.begin, block.size());
    gram.noalias() += rows.transpose() * rows;
  }
  return gram;
}

}  // namespace

auto torque_noise_level(const Eigen::VectorXd& tau_nm) -> double {
  constexpr Eigen::Index kOrder = 3;
  constexpr double kSumOfSquares = 20.0;       // 1, 3, 3, 1
  constexpr double kMedianOfNormal = 0.67449;  // of the size of a value, over its standard deviation
  const Eigen::Index n = tau_nm.size() - kOrder;
  if (n < 1) {
    return 0.0;
  }
  const Eigen::ArrayXd third = tau_nm.tail(n).array() - 3.0 * tau_nm.segment(2, n).array() +
                               3.0 * tau_nm.segment(1, n).array() - tau_nm.head(n).array();
  return median(third.abs()) / (kMedianOfNormal * std::sqrt(kSumOfSquares));
}

auto noise_correction(const LawDesign& design, const LawForm& form, const Eigen::MatrixXd& columns,
                      const Blocks& blocks, const LinearFit& fit) -> NoiseCorrection {
  const Eigen::Index n = columns.cols();
  NoiseCorrection correction{Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Identity(n, n),
                             std::vector<bool>(static_cast<std::size_t>(n), true)};
  bool noisy = false;
  const LawDesign noisier = with_noise_again(design, noisy);
  if (!noisy) {
    return correction;
  }
  const Eigen::MatrixXd gram = gram_of(columns, blocks);
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!fit.at_bound[static_cast<std::size_t>(i)] && gram(i, i) > 0.0) {
      free.push_back(i);
    }
  }
  Eigen::MatrixXd noise_columns = Eigen::MatrixXd::Zero(columns.rows(), n);
  const Eigen::MatrixXd law = law_columns(design, form);
  noise_columns.leftCols(law.cols()) = law_columns(noisier, form) - law;
  const Eigen::MatrixXd noise = gram_of(noise_columns, blocks);
  const Eigen::VectorXd scale = gram.diagonal()(free).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd measured = scale.asDiagonal() * gram(free, free) * scale.asDiagonal();
  const Eigen::MatrixXd clean = measured - scale.asDiagonal() * noise(free, free) * scale.asDiagonal();
  // Where more than nine tenths of what the columns have in some direction are noise, the correction is a guess.
  constexpr double kLeastOfSignal = 0.1;
  if (Eigen::LLT<Eigen::MatrixXd>(clean - kLeastOfSignal * measured).info() != Eigen::Success) {
    for (const Eigen::Index i : free) {
      correction.told[static_cast<std::size_t>(i)] = noise(i, i) == 0.0;
    }
    return correction;
  }
  const Eigen::MatrixXd spread = clean.llt().solve(measured);
  correction.spread(free, free) = scale.asDiagonal() * spread * scale.cwiseInverse().asDiagonal();
  const Eigen::VectorXd theta = fit.theta(free);
  correction.shift(free) = correction.spread(free, free) * theta - theta;
  return correction;
}

FittedIntervals::FittedIntervals(const LawDesign& design, const LawForm& form, const Eigen::MatrixXd& columns,
                                 const Blocks& blocks, const LinearFit& fit)
    : fit_(fit), clean_(fit) {
  if (form.catalogue->target() == TargetKind::kAngle) {
    noise_ = noise_correction(design, form, columns, blocks, fit);
    clean_.covariance = noise_->spread * fit.covariance * noise_->spread.transpose();
  }
}

auto FittedIntervals::around(double value, Eigen::Index i) const -> std::optional<Interval> {
  const double half = half_interval(fit_, i);
  if (!noise_) {
    return Interval{value - half, value + half};
  }
  if (!noise_->told[static_cast<std::size_t>(i)]) {
    return std::nullopt;
  }
  const double clean = value + noise_->shift[i];
  const double half_clean = half_interval(clean_, i);
  return Interval{std::min(value - half, clean - half_clean), std::max(value + half, clean + half_clean)};
}

}  // namespace capstan::tools
