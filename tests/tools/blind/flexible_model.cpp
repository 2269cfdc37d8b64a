// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/blind/flexible_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "capstan/tools/diagnose/preparation.hpp"

namespace capstan::tools::blind {
namespace {

constexpr Eigen::Index kHats = 11;
constexpr Eigen::Index kMeans = 4000;  // at most about so many stretches to learn from
constexpr Eigen::Index kParts = 4;

using Signals = std::vector<Eigen::VectorXd>;

/// Difference over a time span that looks back only, per second.
auto rate_of(const Eigen::VectorXd& signal, double period_s, double span_s) -> Eigen::VectorXd {
  const auto back = std::max<Eigen::Index>(1, std::lround(span_s / period_s));
  Eigen::VectorXd rate(signal.size());
  for (Eigen::Index i = 0; i < signal.size(); ++i) {
    const Eigen::Index from = std::max<Eigen::Index>(0, i - back);
    rate[i] = i > from ? (signal[i] - signal[from]) / (period_s * static_cast<double>(i - from)) : 0.0;
  }
  return rate;
}

/// The smallest step of a signal: its encoder's.
auto step_of(const Eigen::VectorXd& signal) -> double {
  double step = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 1; i < signal.size(); ++i) {
    const double now = std::abs(signal[i] - signal[i - 1]);
    step = now > 1e-12 ? std::min(step, now) : step;
  }
  return std::isfinite(step) ? step : 0.0;
}

/// What a log says of each row, looking back only.
struct Rows {
  Signals signals;
  std::vector<bool> forward;
};

auto rows_of(const AxisLog& log, bool with_time) -> Rows {
  constexpr double kRateSpan = 0.02;
  constexpr double kJerkSpan = 0.04;
  const Eigen::VectorXd rate = rate_of(log.q1_rad, log.period_s, kRateSpan);
  Rows rows{{log.q1_rad, log.tau_nm, rate, rate_of(rate, log.period_s, kJerkSpan)}, {}};
  Eigen::VectorXd since(log.samples()), way(log.samples()), torque(log.samples());
  const double threshold = 1.5 * step_of(log.q1_rad);
  bool forward = true;
  double extreme = log.q1_rad[0];
  Eigen::Index turned = 0;
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    const double q = log.q1_rad[i];
    if (forward ? q < extreme - threshold : q > extreme + threshold) {
      forward = !forward;
      turned = i;
      extreme = q;
    }
    extreme = forward ? std::max(extreme, q) : std::min(extreme, q);
    rows.forward.push_back(forward);
    since[i] = log.period_s * static_cast<double>(i - turned);
    way[i] = std::abs(q - log.q1_rad[turned]);
    torque[i] = log.tau_nm[turned];
  }
  for (Eigen::VectorXd* signal : {&since, &way, &torque}) {
    rows.signals.push_back(*signal);
  }
  for (const auto& other : log.others) {
    rows.signals.push_back(other.q1_rad);
  }
  if (log.temperature_c.size() == log.samples()) {
    rows.signals.push_back(log.temperature_c);
  }
  if (with_time) {
    rows.signals.push_back(log.time_s);
  }
  return rows;
}

/// Hats and products of one row.
class Features {
 public:
  explicit Features(Rows rows) : rows_(std::move(rows)) {
    for (auto& signal : rows_.signals) {
      std::vector<double> sorted(signal.begin(), signal.end());
      std::sort(sorted.begin(), sorted.end());
      const double low = sorted[sorted.size() / 200];
      const double high = sorted[sorted.size() - 1 - sorted.size() / 200];
      const double range = high > low ? high - low : 1.0;
      signal = ((signal.array() - low) / range).cwiseMax(0.0).cwiseMin(1.0);
    }
  }
  [[nodiscard]] auto size() const -> Eigen::Index {
    const auto n = static_cast<Eigen::Index>(rows_.signals.size());
    return 2 + n * 2 * kHats + n * (n - 1) * kHats;
  }
  /// Adds the features of a row, times a weight, to a vector of them.
  void add(Eigen::Index row, double weight, Eigen::Ref<Eigen::VectorXd> sum) const {
    const auto n = static_cast<Eigen::Index>(rows_.signals.size());
    const bool forward = rows_.forward[static_cast<std::size_t>(row)];
    sum[forward ? 0 : 1] += weight;
    for (Eigen::Index a = 0; a < n; ++a) {
      const double place = at(a, row) * static_cast<double>(kHats - 1);
      const Eigen::Index hat = std::min<Eigen::Index>(kHats - 2, static_cast<Eigen::Index>(place));
      const double share = place - static_cast<double>(hat);
      const auto spread = [&](Eigen::Index first, double value) {
        sum[first + hat] += (1.0 - share) * value;
        sum[first + hat + 1] += share * value;
      };
      spread(2 + (2 * a + (forward ? 0 : 1)) * kHats, weight);
      Eigen::Index product = 2 + n * 2 * kHats + a * (n - 1) * kHats;
      for (Eigen::Index b = 0; b < n; ++b) {
        if (b != a) {
          spread(product, weight * 2.0 * (at(b, row) - 0.5));
          product += kHats;
        }
      }
    }
  }

 private:
  [[nodiscard]] auto at(Eigen::Index signal, Eigen::Index row) const -> double {
    return rows_.signals[static_cast<std::size_t>(signal)][row];
  }
  Rows rows_;
};

/// Scalar products of means of stretches, in parts that lie all over the rows.
struct Products {
  std::array<Eigen::MatrixXd, kParts> grams;
  std::array<Eigen::VectorXd, kParts> targets;
  std::array<double, kParts> energies = {};
};

auto products_of(const Features& features, const Eigen::VectorXd& residual, const Blocks& learned) -> Products {
  Eigen::Index rows = 0;
  for (const auto& block : learned) {
    rows += block.size();
  }
  const Eigen::Index stretch = std::max<Eigen::Index>(1, rows / kMeans);
  Products products;
  std::size_t part = 0;
  Eigen::MatrixXd means(features.size(), kMeans);
  for (const auto& block : learned) {
    // Half a part's share of each block in a row, so that no part is a neighbour's copy.
    const Eigen::Index pieces = 2 * kParts;
    for (Eigen::Index piece = 0; piece < pieces; ++piece) {
      const Eigen::Index begin = block.begin + block.size() * piece / pieces;
      const Eigen::Index count = (block.begin + block.size() * (piece + 1) / pieces - begin) / stretch;
      if (count == 0) {
        continue;
      }
      means.setZero(features.size(), count);
      Eigen::VectorXd target = Eigen::VectorXd::Zero(count);
      for (Eigen::Index i = 0; i < count * stretch; ++i) {
        features.add(begin + i, 1.0 / static_cast<double>(stretch), means.col(i / stretch));
        target[i / stretch] += residual[begin + i] / static_cast<double>(stretch);
      }
      Eigen::MatrixXd& gram = products.grams[part];
      if (gram.size() == 0) {
        gram.setZero(features.size(), features.size());
        products.targets[part].setZero(features.size());
      }
      gram.selfadjointView<Eigen::Lower>().rankUpdate(means);
      products.targets[part] += means * target;
      products.energies[part] += target.squaredNorm();
      part = (part + 1) % kParts;
    }
  }
  return products;
}

/// Ridge regression, the ridge a share of the mean energy of a feature.
auto solved(Eigen::MatrixXd gram, const Eigen::VectorXd& target, double share) -> Eigen::VectorXd {
  gram.diagonal().array() += share * gram.diagonal().mean();
  return gram.selfadjointView<Eigen::Lower>().llt().solve(target);
}

auto fitted(const Products& products) -> Eigen::VectorXd {
  Eigen::MatrixXd gram = products.grams[0];
  Eigen::VectorXd target = products.targets[0];
  for (std::size_t part = 1; part < kParts; ++part) {
    gram += products.grams[part];
    target += products.targets[part];
  }
  double best_share = 1.0;
  double least = std::numeric_limits<double>::infinity();
  for (const double share : {1e-3, 1e-2, 1e-1, 1.0}) {
    double left = 0.0;
    for (std::size_t part = 0; part < kParts; ++part) {
      const Eigen::VectorXd theta = solved(gram - products.grams[part], target - products.targets[part], share);
      left += products.energies[part] - 2.0 * theta.dot(products.targets[part]) +
              theta.dot(products.grams[part].selfadjointView<Eigen::Lower>() * theta);
    }
    if (left < least) {
      least = left;
      best_share = share;
    }
  }
  return solved(gram, target, best_share);
}

/// Share of the residual's energy on the rows set aside that goes.
auto share_taken(const Features& features, const Eigen::VectorXd& residual, const Split& split) -> double {
  const Eigen::VectorXd theta = fitted(products_of(features, residual, split.learned()));
  double before = 0.0;
  double after = 0.0;
  Eigen::VectorXd row(features.size());
  for (const auto& block : split.of(Role::kReport)) {
    for (Eigen::Index i = block.begin; i < block.end; ++i) {
      row.setZero();
      features.add(i, 1.0, row);
      before += residual[i] * residual[i];
      after += std::pow(residual[i] - row.dot(theta), 2);
    }
  }
  return before > 0.0 ? 1.0 - after / before : 0.0;
}

}  // namespace

auto flexible_model_of(const AxisLog& log, const Diagnosis& diagnosis) -> FlexibleModel {
  const Eigen::VectorXd residual = diagnosis.traces.measured - diagnosis.traces.before;
  if (residual.size() == 0 || residual.size() > log.samples()) {
    return {};  // no law was fitted
  }
  // The rows that the diagnosis learned from and set aside: all but a few at the end, which fill no row of its grid.
  const Preparation p = prepare({log}, form_of_model(kDefaultModel, {log}));
  const Split split = refined(p.split, p.factor);
  return {share_taken(Features(rows_of(log, false)), residual, split),
          share_taken(Features(rows_of(log, true)), residual, split)};
}

}  // namespace capstan::tools::blind
