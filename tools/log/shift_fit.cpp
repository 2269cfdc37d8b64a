// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/shift_fit.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kMemory = 10;        // seen rows that the noise's model looks back
constexpr Index kMostRows = 5000;    // of one part
constexpr Index kRowsPerColumn = 4;  // seen rows of all parts
constexpr Index kShifts = 2 * kLongestShift + 1;
constexpr double kRidge = 1e-10;  // of each column's squares

/// What is seen through a window is as good as independent so many rows apart.
auto stride_of(Index window) -> Index {
  return (3 * window + 1) / 2;
}

auto boxed(const VectorXd& x, Index half) -> VectorXd {
  const Index n = x.size();
  const auto at = [&](Index i) { return x[std::clamp<Index>(i, 0, n - 1)]; };
  double sum = 0.0;
  for (Index i = -half; i <= half; ++i) {
    sum += at(i);
  }
  VectorXd result(n);
  for (Index i = 0; i < n; ++i) {
    result[i] = sum / static_cast<double>(2 * half + 1);
    sum += at(i + half + 1) - at(i - half);
  }
  return result;
}

/// One part through the window, with kMemory rows before it.
struct Seen {
  MatrixXd law, slope;  // by column; slope: per row of the log
  MatrixXd target;      // by shift
};

auto seen(const std::vector<MatrixXd>& law, const MatrixXd& target, const LogParts& parts, Index part) -> Seen {
  const Index stride = stride_of(parts.window);
  const Index rows = parts.rows / stride + kMemory;
  const auto columns = static_cast<Index>(law.size());
  const auto at = [&](Index row) { return parts.beside + (row - kMemory) * stride; };
  Seen result{MatrixXd(rows, columns), MatrixXd(rows, columns), MatrixXd(rows, kShifts)};
  for (Index c = 0; c < columns; ++c) {
    const VectorXd x = boxed(boxed(law[static_cast<std::size_t>(c)].col(part), parts.window), parts.window);
    for (Index i = 0; i < rows; ++i) {
      result.law(i, c) = x[at(i)];
      result.slope(i, c) = 0.5 * (x[at(i) + 1] - x[at(i) - 1]);
    }
  }
  const VectorXd y = boxed(boxed(target.col(part), parts.window), parts.window);
  for (Index i = 0; i < rows; ++i) {
    result.target.row(i) = y.segment(at(i) - kLongestShift, kShifts).transpose();
  }
  return result;
}

auto whitened(const MatrixXd& x, const VectorXd& memory) -> MatrixXd {
  const Index rows = x.rows() - kMemory;
  MatrixXd result = x.bottomRows(rows);
  for (Index k = 0; k < kMemory; ++k) {
    result -= memory[k] * x.middleRows(kMemory - 1 - k, rows);
  }
  return result;
}

/// Normal equations, scaled.
class Normal {
 public:
  explicit Normal(const MatrixXd& gram) : scale_(gram.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse()) {
    MatrixXd scaled = scale_.asDiagonal() * gram * scale_.asDiagonal();
    scaled.diagonal().array() += kRidge;
    factor_.compute(scaled);
  }
  [[nodiscard]] auto solve(const MatrixXd& right) const -> MatrixXd {
    return scale_.asDiagonal() * factor_.solve(scale_.asDiagonal() * right);
  }

 private:
  VectorXd scale_;
  Eigen::LDLT<MatrixXd> factor_;
};

/// Autoregressive model of a residual, by Yule and Walker.
auto memory_of(const std::vector<VectorXd>& residual) -> VectorXd {
  VectorXd covariance = VectorXd::Zero(kMemory + 1);
  for (const VectorXd& e : residual) {
    for (Index k = 0; k <= kMemory; ++k) {
      covariance[k] += e.tail(e.size() - k).dot(e.head(e.size() - k));
    }
  }
  MatrixXd toeplitz(kMemory, kMemory);
  for (Index i = 0; i < kMemory; ++i) {
    for (Index k = 0; k < kMemory; ++k) {
      toeplitz(i, k) = covariance[std::abs(i - k)] * (i == k ? 1.0 + 1e-9 : 1.0);
    }
  }
  return toeplitz.ldlt().solve(covariance.tail(kMemory));
}

/// Sums of one part, so that fits without it cost next to nothing.
struct Sums {
  MatrixXd gram, right;  // right: by shift, of the target less the law at no shift
  VectorXd squares;      // by shift
};

class Profile {
 public:
  Profile(const std::vector<Seen>& parts, const VectorXd& memory, const VectorXd& weights) {
    for (const Seen& part : parts) {
      const MatrixXd law = whitened(part.law, memory);
      const MatrixXd rest = whitened(part.target.colwise() - part.law * weights, memory);
      parts_.push_back({law.transpose() * law, law.transpose() * rest, rest.colwise().squaredNorm().transpose()});
      rows_ = static_cast<double>(law.rows());
    }
  }
  /// -2 log likelihood by shift, of all parts but one (-1: of all), less that of no shift.
  [[nodiscard]] auto deviance(Index without) const -> VectorXd {
    Sums sum{MatrixXd::Zero(parts_[0].gram.rows(), parts_[0].gram.cols()),
             MatrixXd::Zero(parts_[0].right.rows(), kShifts), VectorXd::Zero(kShifts)};
    double rows = 0.0;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      if (static_cast<Index>(p) != without) {
        sum.gram += parts_[p].gram;
        sum.right += parts_[p].right;
        sum.squares += parts_[p].squares;
        rows += rows_;
      }
    }
    const MatrixXd weights = Normal(sum.gram).solve(sum.right);
    const VectorXd taken = sum.right.cwiseProduct(weights).colwise().sum().transpose();
    const VectorXd left = (sum.squares - taken).cwiseMax(1e-14 * sum.squares);
    return rows * (left.array() / left[kLongestShift]).log().matrix();
  }

 private:
  std::vector<Sums> parts_;
  double rows_ = 0.0;  // of each part
};

/// The minimum, between the rows by a parabola; nothing at the end of the range.
auto lowest(const VectorXd& deviance) -> std::optional<double> {
  Index best = 0;
  deviance.minCoeff(&best);
  if (best == 0 || best + 1 == deviance.size()) {
    return std::nullopt;
  }
  const double bend = deviance[best - 1] - 2.0 * deviance[best] + deviance[best + 1];
  return static_cast<double>(best - kLongestShift) + 0.5 * (deviance[best - 1] - deviance[best + 1]) / bend;
}

struct Weights {
  VectorXd law, memory;
  double bound = 0.0, first = 0.0;
};

/// Weights of the law at no shift and the noise's model, in turns; then what they let a shift be known to.
auto weights_of(const std::vector<Seen>& parts) -> Weights {
  Weights found{{}, VectorXd::Zero(kMemory)};
  const Index columns = parts[0].law.cols();
  constexpr int kTurns = 3;
  for (int turn = 0; turn < kTurns; ++turn) {
    MatrixXd gram = MatrixXd::Zero(columns, columns);
    VectorXd right = VectorXd::Zero(columns);
    for (const Seen& part : parts) {
      const MatrixXd law = whitened(part.law, found.memory);
      gram += law.transpose() * law;
      right += law.transpose() * whitened(part.target.col(kLongestShift), found.memory);
    }
    found.law = Normal(gram).solve(right);
    if (turn + 1 < kTurns) {
      std::vector<VectorXd> residual;
      for (const Seen& part : parts) {
        residual.emplace_back(part.target.col(kLongestShift) - part.law * found.law);
      }
      found.memory = memory_of(residual);
    }
  }
  MatrixXd gram = MatrixXd::Zero(columns, columns);
  VectorXd beside = VectorXd::Zero(columns);
  double rows = 0.0;
  double moved = 0.0;
  double noise = 0.0;
  for (const Seen& part : parts) {
    const MatrixXd law = whitened(part.law, found.memory);
    const VectorXd slope = whitened(part.slope * found.law, found.memory);
    gram += law.transpose() * law;
    beside += law.transpose() * slope;
    moved += slope.squaredNorm();
    noise += whitened(part.target.col(kLongestShift) - part.law * found.law, found.memory).squaredNorm();
    rows += static_cast<double>(law.rows());
  }
  const Normal normal(gram);
  const double own = moved - beside.dot(normal.solve(beside).col(0));  // what no column can stand in for
  found.bound = std::sqrt(noise / rows / std::max(own, 1e-300));
  const double own_of_first = 1.0 / normal.solve(VectorXd::Unit(columns, 0))(0, 0);
  found.first = std::pow(found.law[0], 2) * own_of_first / noise;
  return found;
}

}  // namespace

auto parts_of_log(Index rows, Index window) -> LogParts {
  LogParts parts;
  parts.window = window;
  parts.beside = kLongestShift + 2 * window + kMemory * stride_of(window) + 2;
  const Index usable = rows - 2 * parts.beside;
  parts.rows = std::clamp<Index>(usable / LogParts::kCount, 0, kMostRows);
  for (Index p = 0; p < LogParts::kCount; ++p) {
    parts.begin[static_cast<std::size_t>(p)] = parts.beside + usable * p / LogParts::kCount;
  }
  return parts;
}

auto cut(const VectorXd& signal, const LogParts& parts) -> MatrixXd {
  MatrixXd result(parts.rows + 2 * parts.beside, LogParts::kCount);
  for (Index p = 0; p < LogParts::kCount; ++p) {
    result.col(p) = signal.segment(parts.begin[static_cast<std::size_t>(p)] - parts.beside, result.rows());
  }
  return result;
}

auto shift_behind(const std::vector<MatrixXd>& law, const MatrixXd& target, const LogParts& parts)
    -> std::optional<ShiftFit> {
  const Index rows = LogParts::kCount * (parts.rows / stride_of(parts.window));
  if (law.empty() || rows < kRowsPerColumn * static_cast<Index>(law.size())) {
    return std::nullopt;
  }
  std::vector<Seen> all;
  for (Index p = 0; p < LogParts::kCount; ++p) {
    all.push_back(seen(law, target, parts, p));
  }
  const Weights weights = weights_of(all);
  const Profile profile(all, weights.memory, weights.law);
  const VectorXd deviance = profile.deviance(-1);
  const auto whole = lowest(deviance);
  if (!whole) {
    return std::nullopt;
  }
  VectorXd without(LogParts::kCount);
  for (Index p = 0; p < LogParts::kCount; ++p) {
    const auto shift = lowest(profile.deviance(p));
    if (!shift) {
      return std::nullopt;
    }
    without[p] = *shift;
  }
  constexpr double kParts = static_cast<double>(LogParts::kCount);
  const double error = std::sqrt((kParts - 1.0) / kParts * (without.array() - without.mean()).square().sum());
  return ShiftFit{*whole, student_t95(kParts - 1.0) * error, -deviance.minCoeff(), weights.bound, weights.first};
}

}  // namespace capstan::tools
