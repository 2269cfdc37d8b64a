// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/shift_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kMemory = 10;        // seen rows that the noise's model looks back
constexpr Index kMostRows = 5000;    // of one part
constexpr Index kRowsPerColumn = 4;  // seen rows of all parts
constexpr double kRidge = 1e-10;     // of each column's squares

/// What is seen through a window is as good as independent so many rows apart.
auto stride_of(Index window) -> Index {
  return (3 * window + 1) / 2;
}

auto seen_rows(const LogParts& parts) -> Index {
  return parts.rows / stride_of(parts.window);
}

/// Row of a part as cut for a row as seen.
auto row_of(Index seen, const LogParts& parts) -> Index {
  return parts.beside + (seen - kMemory) * stride_of(parts.window);
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
  MatrixXd target;      // by shift; the last is not shifted
};

auto doubly_boxed(const VectorXd& x, Index half) -> VectorXd {
  return boxed(boxed(x, half), half);
}

auto seen_law(const std::vector<MatrixXd>& law, const LogParts& parts, Index part) -> Seen {
  const Index rows = seen_rows(parts) + kMemory;
  const auto columns = static_cast<Index>(law.size());
  Seen result{MatrixXd(rows, columns), MatrixXd(rows, columns), {}};
  for (Index c = 0; c < columns; ++c) {
    const VectorXd x = doubly_boxed(law[static_cast<std::size_t>(c)].col(part), parts.window);
    for (Index i = 0; i < rows; ++i) {
      const Index at = row_of(i, parts);
      result.law(i, c) = x[at];
      result.slope(i, c) = 0.5 * (x[at + 1] - x[at - 1]);
    }
  }
  return result;
}

auto seen_target(const MatrixXd& target, const LogParts& parts, Index part, const std::vector<Index>& shifts)
    -> MatrixXd {
  const Index rows = seen_rows(parts) + kMemory;
  const VectorXd y = doubly_boxed(target.col(part), parts.window);
  MatrixXd result(rows, std::ssize(shifts) + 1);
  for (Index i = 0; i < rows; ++i) {
    for (Index k = 0; k < std::ssize(shifts); ++k) {
      result(i, k) = y[row_of(i, parts) + shifts[static_cast<std::size_t>(k)]];
    }
    result(i, result.cols() - 1) = y[row_of(i, parts)];
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
    }
  }
  /// Squares that are left by shift, of all parts but one (-1: of all), per those of no shift.
  [[nodiscard]] auto left(Index without) const -> VectorXd {
    const Index shifts = parts_[0].squares.size();
    Sums sum{MatrixXd::Zero(parts_[0].gram.rows(), parts_[0].gram.cols()),
             MatrixXd::Zero(parts_[0].right.rows(), shifts), VectorXd::Zero(shifts)};
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      if (static_cast<Index>(p) != without) {
        sum.gram += parts_[p].gram;
        sum.right += parts_[p].right;
        sum.squares += parts_[p].squares;
      }
    }
    const MatrixXd weights = Normal(sum.gram).solve(sum.right);
    const VectorXd taken = sum.right.cwiseProduct(weights).colwise().sum().transpose();
    const VectorXd left = (sum.squares - taken).cwiseMax(1e-14 * sum.squares);
    return left.head(shifts - 1) / left[shifts - 1];
  }

 private:
  std::vector<Sums> parts_;
};

/// Where the minimum is; nothing at the end of the range.
auto lowest(const VectorXd& left) -> std::optional<Index> {
  Index best = 0;
  left.minCoeff(&best);
  return best == 0 || best + 1 == left.size() ? std::nullopt : std::optional(best);
}

/// The same between the shifts, by a parabola.
auto lowest_between(const VectorXd& left) -> std::optional<double> {
  const auto best = lowest(left);
  if (!best) {
    return std::nullopt;
  }
  const auto near = left.segment(*best - 1, 3);
  return static_cast<double>(*best) + 0.5 * (near[0] - near[2]) / (near[0] - 2.0 * near[1] + near[2]);
}

/// Of the 95 % interval, by leaving out one part after the other (jackknife).
auto half_interval(const Profile& profile) -> std::optional<double> {
  VectorXd without(LogParts::kCount);
  for (Index p = 0; p < LogParts::kCount; ++p) {
    const auto shift = lowest_between(profile.left(p));
    if (!shift) {
      return std::nullopt;
    }
    without[p] = *shift;
  }
  constexpr double kParts = static_cast<double>(LogParts::kCount);
  const double error = std::sqrt((kParts - 1.0) / kParts * (without.array() - without.mean()).square().sum());
  return student_t95(kParts - 1.0) * error;
}

/// Rows from no shift to either side: a row each, then four, then sixteen.
auto shifts_up_to(Index reach) -> std::vector<Index> {
  std::vector<Index> shifts{0};
  constexpr Index kRowByRow = kShortReach;
  constexpr Index kByFour = 60;
  while (shifts.back() < reach) {
    const Index last = shifts.back();
    shifts.push_back(std::min(reach, last + (last < kRowByRow ? 1 : last < kByFour ? 4 : 16)));
  }
  for (Index i = std::ssize(shifts) - 1; i > 0; --i) {
    shifts.push_back(-shifts[static_cast<std::size_t>(i)]);
  }
  std::sort(shifts.begin(), shifts.end());
  return shifts;
}

auto shifts_around(Index centre) -> std::vector<Index> {
  std::vector<Index> shifts(2 * kShortReach + 1);
  std::iota(shifts.begin(), shifts.end(), centre - kShortReach);
  return shifts;
}

struct Weights {
  VectorXd law, memory;
};

/// Weights of the law for one of the shifts and the noise's model, in turns.
auto weights_of(const std::vector<Seen>& parts, Index shift) -> Weights {
  Weights found{{}, VectorXd::Zero(kMemory)};
  const Index columns = parts[0].law.cols();
  constexpr int kTurns = 3;
  for (int turn = 0; turn < kTurns; ++turn) {
    MatrixXd gram = MatrixXd::Zero(columns, columns);
    VectorXd right = VectorXd::Zero(columns);
    for (const Seen& part : parts) {
      const MatrixXd law = whitened(part.law, found.memory);
      gram += law.transpose() * law;
      right += law.transpose() * whitened(part.target.col(shift), found.memory);
    }
    found.law = Normal(gram).solve(right);
    if (turn + 1 < kTurns) {
      std::vector<VectorXd> residual;
      for (const Seen& part : parts) {
        residual.emplace_back(part.target.col(shift) - part.law * found.law);
      }
      found.memory = memory_of(residual);
    }
  }
  return found;
}

/// What the law's weights at no shift tell.
struct Outlook {
  double bound = 0.0;  // no unbiased estimate of a shift has a smaller standard deviation, the law being right; rows
  double first = 0.0;  // as in ShiftFit
};

/// @param unshifted  column of the target
auto outlook_of(const std::vector<Seen>& parts, const Weights& weights, Index unshifted) -> Outlook {
  const Index columns = weights.law.size();
  MatrixXd gram = MatrixXd::Zero(columns, columns);
  VectorXd beside = VectorXd::Zero(columns);
  double rows = 0.0;
  double moved = 0.0;
  double noise = 0.0;
  for (const Seen& part : parts) {
    const MatrixXd law = whitened(part.law, weights.memory);
    const VectorXd slope = whitened(part.slope * weights.law, weights.memory);
    gram += law.transpose() * law;
    beside += law.transpose() * slope;
    moved += slope.squaredNorm();
    noise += whitened(part.target.col(unshifted) - part.law * weights.law, weights.memory).squaredNorm();
    rows += static_cast<double>(law.rows());
  }
  const Normal normal(gram);
  const double own = moved - beside.dot(normal.solve(beside).col(0));  // what no column can stand in for
  const double bound = std::sqrt(noise / rows / std::max(own, 1e-300));
  const double own_of_first = 1.0 / normal.solve(VectorXd::Unit(columns, 0))(0, 0);
  return {bound, std::pow(weights.law[0], 2) * own_of_first / noise};
}

}  // namespace

auto parts_of_log(Index rows, Index window, Index reach) -> LogParts {
  LogParts parts;
  parts.window = window;
  parts.reach = reach;
  parts.beside = reach + kShortReach + 2 * window + kMemory * stride_of(window) + 2;
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
  const Index rows = LogParts::kCount * seen_rows(parts);
  if (law.empty() || rows < kRowsPerColumn * static_cast<Index>(law.size())) {
    return std::nullopt;
  }
  std::vector<Seen> all;
  for (Index p = 0; p < LogParts::kCount; ++p) {
    all.push_back(seen_law(law, parts, p));
  }
  const auto look_at = [&](const std::vector<Index>& shifts) {
    for (Index p = 0; p < LogParts::kCount; ++p) {
      all[static_cast<std::size_t>(p)].target = seen_target(target, parts, p, shifts);
    }
  };
  const std::vector<Index> shifts = shifts_up_to(parts.reach);
  look_at(shifts);
  const Weights unshifted = weights_of(all, std::ssize(shifts));
  const Outlook outlook = outlook_of(all, unshifted, std::ssize(shifts));
  const auto coarse = lowest(Profile(all, unshifted.memory, unshifted.law).left(-1));
  if (!coarse) {
    return std::nullopt;
  }
  const std::vector<Index> around = shifts_around(shifts[static_cast<std::size_t>(*coarse)]);
  look_at(around);
  const Weights weights = weights_of(all, kShortReach);
  const Profile profile(all, weights.memory, weights.law);
  const VectorXd left = profile.left(-1);
  const auto whole = lowest_between(left);
  const auto half = half_interval(profile);
  if (!whole || !half) {
    return std::nullopt;
  }
  const double shift = static_cast<double>(around.front()) + *whole;
  if (std::abs(shift) > static_cast<double>(parts.reach)) {
    return std::nullopt;
  }
  const auto count = static_cast<double>(rows);
  return ShiftFit{shift, *half, -count * std::log(left.minCoeff()),
                  count * std::log1p(std::pow(shift / outlook.bound, 2) / count), outlook.first};
}

}  // namespace capstan::tools
