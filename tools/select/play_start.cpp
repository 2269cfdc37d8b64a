// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/play_start.hpp"

#include <algorithm>
#include <limits>

#include "capstan/tools/support/geometric_grid.hpp"
#include "capstan/tools/support/play_column.hpp"

namespace capstan::tools {
namespace {

/// Half widths of the plays whose sum is asked, as shares of the motor's range; below, what follows without any.
constexpr double kNarrowest = 1.0 / 400.0;
constexpr double kWidest = 1.0 / 2.02;
constexpr Eigen::Index kPlays = 14;
constexpr Eigen::Index kColumns = kPlays + 3;  ///< beside the motor's angle, its square and its cube
/// Starts, the usual one first.
constexpr double kStarts[] = {0.0, -1.0, -0.5, 0.5, 1.0};
constexpr double kWorthAnother = 0.9;

/// What the sum of plays, and a curve, leave of the joint angle, sum of squares.
auto left_by_plays(const Eigen::VectorXd& q1, const Eigen::VectorXd& q2, double start) -> double {
  const double range = q1.maxCoeff() - q1.minCoeff();
  const Eigen::VectorXd angle = (q1.array() - 0.5 * (q1.maxCoeff() + q1.minCoeff())) / range;
  Eigen::MatrixXd columns(q1.size(), kColumns);
  Eigen::Index play = 0;
  for (const double half_width : geometric_grid(kNarrowest, kWidest, kPlays)) {
    columns.col(play++) = play_column(angle, half_width, start);
  }
  columns.rightCols(3) << angle, angle.array().square(), angle.array().cube();
  columns.rowwise() -= columns.colwise().mean().eval();
  const Eigen::VectorXd target = q2.array() - q2.mean();
  const Sign sign = columns.col(kPlays).dot(target) < 0.0 ? Sign::kNonPositive : Sign::kNonNegative;
  std::vector<Sign> signs(kColumns, sign);
  signs[kColumns - 2] = signs[kColumns - 1] = Sign::kAny;
  const Eigen::VectorXd weights = solve_signed(columns.transpose() * columns, columns.transpose() * target, signs);
  return (target - columns * weights).squaredNorm();
}

}  // namespace

auto turns_of_play(const Eigen::VectorXd& q1, const Blocks& logs, double half_width, double least) -> int {
  int count = 0;
  for (const auto& log : logs) {
    double place = q1[log.begin];
    double low = place;
    double high = place;
    int direction = 0;
    for (Eigen::Index i = log.begin; i < log.end; ++i) {
      place = std::clamp(place, q1[i] - half_width, q1[i] + half_width);
      low = direction > 0 ? low : std::min(low, place);
      high = direction < 0 ? high : std::max(high, place);
      const bool up = direction <= 0 && place > low + least;
      const bool down = direction >= 0 && place < high - least;
      if (up || down) {
        count += direction != 0 ? 1 : 0;
        direction = up ? 1 : -1;
        low = high = place;
      }
    }
  }
  return count;
}

auto start_of_plays(const Eigen::VectorXd& q1, const Eigen::VectorXd& q2) -> double {
  double found = kStarts[0];
  if (q1.maxCoeff() <= q1.minCoeff()) {
    return found;
  }
  double least = std::numeric_limits<double>::infinity();
  for (const double start : kStarts) {
    const double left = left_by_plays(q1, q2, start);
    if (left < (start == kStarts[0] ? 1.0 : kWorthAnother) * least) {
      least = left;
      found = start;
    }
  }
  return found;
}

auto lead_of_play(const Samples& samples, double half_width, double start) -> Eigen::VectorXd {
  Eigen::VectorXd lead = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(samples.size()));
  double middle = samples.front().q1;
  double ahead = middle + start * half_width;
  for (std::size_t i = 0; i < samples.size() && ahead != middle; ++i) {
    const double q1 = samples[i].q1;
    middle = std::clamp(middle, q1 - half_width, q1 + half_width);
    ahead = std::clamp(ahead, q1 - half_width, q1 + half_width);
    lead[static_cast<Eigen::Index>(i)] = ahead - middle;
  }
  return lead;
}

}  // namespace capstan::tools
