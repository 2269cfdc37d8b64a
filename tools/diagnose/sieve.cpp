// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/sieve.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/side_by_side.hpp"

namespace capstan::tools {
namespace {

constexpr Eigen::Index kNullDraws = 299;
constexpr Eigen::Index kEnoughToSieve = 2500;
constexpr Eigen::Index kBurnIn = 500;

/// Residuals of pure noise: resampled innovations through the autoregression. One column per draw.
auto noise_draws(const Evidence& evidence, Eigen::Index rows) -> Eigen::MatrixXd {
  Random random(0x51E7E);
  const Eigen::VectorXd pool = evidence.white_error.array() - evidence.white_error.mean();
  const Eigen::Index order = evidence.noise.order();
  Eigen::MatrixXd draws(rows, kNullDraws);
  Eigen::VectorXd series(rows + kBurnIn);
  for (Eigen::Index draw = 0; draw < kNullDraws; ++draw) {
    for (Eigen::Index i = 0; i < series.size(); ++i) {
      const auto at =
          std::min(pool.size() - 1, static_cast<Eigen::Index>(random.uniform() * static_cast<double>(pool.size())));
      double value = pool[at];
      for (Eigen::Index k = 1; k <= std::min(order, i); ++k) {
        value += evidence.noise.coefficients[k - 1] * series[i - k];
      }
      series[i] = value;
    }
    draws.col(draw) = series.tail(rows);
  }
  return draws;
}

/// Rows of every other learned block, thinned by taking means.
auto half_rows(const Eigen::MatrixXd& columns, const Blocks& blocks, std::size_t half, Eigen::Index step)
    -> Eigen::MatrixXd {
  Eigen::Index rows = 0;
  for (std::size_t i = half; i < blocks.size(); i += 2) {
    rows += blocks[i].size() / step;
  }
  Eigen::MatrixXd result(rows, columns.cols());
  Eigen::Index row = 0;
  for (std::size_t i = half; i < blocks.size(); i += 2) {
    const Eigen::Index count = blocks[i].size() / step;
    result.middleRows(row, count) = decimated(columns.middleRows(blocks[i].begin, count * step), step);
    row += count;
  }
  return result;
}

/// One half: products of law and variants with each other, and with every residual (the real one first, then the
/// draws).
struct Half {
  Eigen::MatrixXd gram, products;
  Eigen::VectorXd energies;
};

/// The law with one variant: fits on one half, predicts the other.
class CrossFit {
 public:
  CrossFit(const std::array<Half, 2>& halves, ColumnList columns, std::vector<Sign> own_signs, Eigen::Index fixed)
      : halves_(halves), columns_(std::move(columns)), signs_(std::move(own_signs)), fixed_(fixed) {
    for (std::size_t h = 0; h < 2; ++h) {
      gram_[h] = halves[h].gram(columns_, columns_);
      Eigen::MatrixXd regular = gram_[h];
      regular.diagonal() *= 1.0 + 1e-10;
      regular.diagonal().array() += 1e-300;
      inverse_[h] = regular.ldlt().solve(Eigen::MatrixXd::Identity(regular.rows(), regular.cols()));
    }
  }

  /// Energy left over both halves for one residual; negative if the signs forbid the fit.
  auto energy(Eigen::Index residual) const -> double {
    double total = 0.0;
    const Eigen::VectorXd products[2] = {wanted(0, residual), wanted(1, residual)};
    for (std::size_t h = 0; h < 2; ++h) {
      const Eigen::VectorXd theta = inverse_[h] * products[h];
      const auto law = theta.size() - static_cast<Eigen::Index>(signs_.size());
      for (std::size_t i = 0; i < signs_.size(); ++i) {
        if (!has_sign(theta[law + static_cast<Eigen::Index>(i)], signs_[i])) {
          return -1.0;
        }
      }
      const std::size_t other = 1 - h;
      double energy = halves_[other].energies[residual];
      if (fixed_ >= 0) {
        energy += halves_[other].gram(fixed_, fixed_) - 2.0 * halves_[other].products(fixed_, residual);
      }
      total += energy - 2.0 * theta.dot(products[other]) + theta.dot(gram_[other] * theta);
    }
    return std::max(total, 0.0);
  }

 private:
  auto wanted(std::size_t h, Eigen::Index residual) const -> Eigen::VectorXd {
    Eigen::VectorXd products = halves_[h].products.col(residual)(columns_);
    if (fixed_ >= 0) {
      products -= halves_[h].gram.col(fixed_)(columns_);
    }
    return products;
  }

  const std::array<Half, 2>& halves_;
  ColumnList columns_;
  std::vector<Sign> signs_;
  Eigen::Index fixed_;
  std::array<Eigen::MatrixXd, 2> gram_, inverse_;
};

auto make_halves(const Preparation& p, const Evidence& evidence) -> std::array<Half, 2> {
  const Blocks learned = p.split.learned();
  const Eigen::Index step = std::max<Eigen::Index>(1, rows_in(learned) / kEnoughToSieve);
  const Eigen::MatrixXd draws = noise_draws(evidence, evidence.columns.rows());
  std::array<Half, 2> halves;
  two_at_a_time(2, [&](std::size_t h) {
    const Eigen::MatrixXd x = half_rows(evidence.columns, learned, h, step);
    const Eigen::MatrixXd luck = half_rows(draws, learned, h, step);
    Eigen::MatrixXd residuals(x.rows(), 1 + kNullDraws);
    residuals << x.col(evidence.layout.error()), luck;
    halves[h].gram.noalias() = x.transpose() * x;
    halves[h].products.noalias() = x.transpose() * residuals;
    halves[h].energies = residuals.colwise().squaredNorm();
  });
  return halves;
}

/// -log of the energy left, relative to the law alone, of a candidate's best variant: the real residual first, then the
/// draws.
auto candidate_statistics(const std::array<Half, 2>& halves, const Layout& layout, const Candidate& candidate,
                          const Eigen::VectorXd& law) -> Eigen::VectorXd {
  Eigen::VectorXd best = Eigen::VectorXd::Zero(1 + kNullDraws);
  for (std::size_t v = 0; v < candidate.variants.size(); ++v) {
    ColumnModel model = model_of(layout, candidate, v);
    const bool exact = candidate.acts_on_output && v == 0;
    if (candidate.acts_on_output && !exact) {
      model.free = law_model(layout).free;  // the other variants stand beside the law: they are for the draws
    }
    const std::vector<Sign> own = candidate.acts_on_output ? std::vector<Sign>{} : candidate.signs;
    const CrossFit fit(halves, model.free, own, model.fixed);
    for (Eigen::Index i = exact ? 0 : (candidate.acts_on_output ? 1 : 0); i < (exact ? 1 : best.size()); ++i) {
      const double energy = fit.energy(i);
      if (energy >= 0.0) {
        best[i] = std::max(best[i], -std::log(std::max(energy, 1e-12 * law[i]) / law[i]));
      }
    }
  }
  return best;
}

/// The same statistic for the flexible model: everything at once, by ridge regression.
auto flexible_statistics(const std::array<Half, 2>& halves, const Layout& layout, const Eigen::VectorXd& law)
    -> Eigen::VectorXd {
  constexpr double kRidge = 1e-2;
  ColumnList columns = law_model(layout).free;
  for (Eigen::Index i = layout.first_variant(); i < layout.total; ++i) {
    columns.push_back(i);
  }
  Eigen::VectorXd left[2];
  two_at_a_time(2, [&](std::size_t h) {
    const Eigen::MatrixXd gram = halves[h].gram(columns, columns);
    const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd scaled = scale.asDiagonal() * gram * scale.asDiagonal();
    scaled.diagonal().array() += 1e-12;
    scaled.diagonal().tail(scaled.cols() - layout.law).array() += kRidge;
    const Eigen::MatrixXd theta =
        scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * halves[h].products(columns, Eigen::all));
    const Half& other = halves[1 - h];
    const Eigen::MatrixXd predicted = other.gram(columns, columns) * theta;
    left[h] = other.energies -
              2.0 * (theta.cwiseProduct(other.products(columns, Eigen::all))).colwise().sum().transpose() +
              theta.cwiseProduct(predicted).colwise().sum().transpose();
  });
  const Eigen::ArrayXd alone = law.array().max(1e-300);  // a residual of nothing is no luck
  return -((left[0] + left[1]).array().max(1e-12 * alone) / alone).log();
}

auto tail_p(const Eigen::VectorXd& draws, double observed) -> double {
  const auto above = static_cast<double>((draws.array() >= observed).count());
  return (above + 1.0) / (static_cast<double>(draws.size()) + 1.0);
}

}  // namespace

auto sieve(const Preparation& p, const Evidence& evidence) -> SieveResult {
  const std::array<Half, 2> halves = make_halves(p, evidence);
  const CrossFit alone(halves, law_model(evidence.layout).free, {}, -1);
  Eigen::VectorXd law(1 + kNullDraws);
  for (Eigen::Index i = 0; i < law.size(); ++i) {
    law[i] = alone.energy(i);
  }
  // Standardised per candidate: a candidate that luck favours must show more.
  Eigen::MatrixXd scores(1 + kNullDraws, static_cast<Eigen::Index>(evidence.candidates.size()));
  two_at_a_time(evidence.candidates.size(), [&](std::size_t f) {
    const Eigen::VectorXd statistics = candidate_statistics(halves, evidence.layout, evidence.candidates[f], law);
    const auto draws = statistics.tail(kNullDraws).array();
    const double spread = std::sqrt((draws - draws.mean()).square().mean()) + 1e-12;
    scores.col(static_cast<Eigen::Index>(f)) = (statistics.array() - draws.mean()) / spread;
  });
  const Eigen::VectorXd null_maximum = scores.bottomRows(kNullDraws).rowwise().maxCoeff();
  SieveResult result;
  for (Eigen::Index f = 0; f < scores.cols(); ++f) {
    result.candidate_p.push_back(tail_p(null_maximum, scores(0, f)));
  }
  const Eigen::VectorXd flexible = flexible_statistics(halves, evidence.layout, law);
  result.flexible_p = tail_p(flexible.tail(kNullDraws), flexible[0]);
  return result;
}

}  // namespace capstan::tools
