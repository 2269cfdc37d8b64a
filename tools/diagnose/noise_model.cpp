// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/noise_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace capstan::tools {
namespace {

/// Forward and backward prediction errors of one piece at the current order.
struct PredictionErrors {
  Eigen::VectorXd forward, backward;
};

/// One step of Burg's recursion: the reflection coefficient of the next order, and the errors carried over to it.
auto next_reflection(std::vector<PredictionErrors>& errors, Eigen::Index order) -> double {
  double cross = 0.0;
  double power = 0.0;
  for (const auto& e : errors) {
    const Eigen::Index n = e.forward.size() - order;
    cross += e.forward.tail(n).dot(e.backward.segment(order - 1, n));
    power += e.forward.tail(n).squaredNorm() + e.backward.segment(order - 1, n).squaredNorm();
  }
  const double reflection = power > 0.0 ? 2.0 * cross / power : 0.0;
  for (auto& e : errors) {
    const Eigen::Index n = e.forward.size() - order;
    const Eigen::VectorXd forward = e.forward.tail(n);
    const Eigen::VectorXd backward = e.backward.segment(order - 1, n);
    e.forward.tail(n) = forward - reflection * backward;
    e.backward.tail(n) = backward - reflection * forward;
  }
  return reflection;
}

/// The largest order, up to the one asked for, for which pieces of more than four times as many rows hold at least half
/// of all rows: shorter ones tell nothing of it.
auto order_for(const Blocks& pieces, Eigen::Index order) -> Eigen::Index {
  const auto enough = [&pieces](Eigen::Index of_order) {
    Blocks longer;
    std::copy_if(pieces.begin(), pieces.end(), std::back_inserter(longer),
                 [of_order](const auto& piece) { return piece.size() > 4 * of_order; });
    return 2 * rows_in(longer) >= rows_in(pieces);
  };
  while (order > 0 && !enough(order)) {
    --order;
  }
  return order;
}

}  // namespace

auto fit_noise(const Eigen::VectorXd& signal, const Blocks& pieces, Eigen::Index order_asked) -> AutoregressiveNoise {
  constexpr double kSmallest = std::numeric_limits<double>::min();
  const Eigen::Index largest_order = order_for(pieces, order_asked);
  std::vector<PredictionErrors> errors;
  double rows = 0.0;
  double variance = 0.0;
  for (const auto& piece : pieces) {
    if (piece.size() > 4 * largest_order) {
      const Eigen::VectorXd x = signal.segment(piece.begin, piece.size());
      errors.push_back({x, x});
      rows += static_cast<double>(x.size());
      variance += x.squaredNorm();
    }
  }
  variance = std::max(variance / std::max(rows, 1.0), kSmallest);
  AutoregressiveNoise best{Eigen::VectorXd(0), variance};
  double best_bic = rows * std::log(variance);
  Eigen::VectorXd a(0);
  for (Eigen::Index order = 1; order <= largest_order; ++order) {
    const double reflection = next_reflection(errors, order);
    Eigen::VectorXd next(order);
    next.head(order - 1) = a - reflection * a.reverse();
    next[order - 1] = reflection;
    a = next;
    variance = std::max(variance * (1.0 - reflection * reflection), kSmallest);
    const double bic = rows * std::log(variance) + static_cast<double>(order) * std::log(rows);
    if (bic < best_bic) {
      best_bic = bic;
      best = {a, variance};
    }
  }
  return best;
}

auto whitened(const Eigen::MatrixXd& columns, const Blocks& pieces, const AutoregressiveNoise& noise)
    -> Eigen::MatrixXd {
  Eigen::MatrixXd result(columns.rows(), columns.cols());
  const Eigen::Index p = noise.order();
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {  // a column stays in the processor's cache for all lags
    result.col(c).setZero();
    for (const auto& piece : pieces) {
      const Eigen::Index n = piece.size() - p;
      if (n <= 0) {
        continue;
      }
      auto out = result.col(c).segment(piece.begin + p, n);
      out = columns.col(c).segment(piece.begin + p, n);
      for (Eigen::Index k = 1; k <= p; ++k) {
        out -= noise.coefficients[k - 1] * columns.col(c).segment(piece.begin + p - k, n);
      }
    }
  }
  return result;
}

}  // namespace capstan::tools
