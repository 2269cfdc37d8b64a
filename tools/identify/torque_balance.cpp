// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/torque_balance.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/hindsight.hpp"
#include "capstan/tools/identify/least_squares.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

constexpr auto kParts = static_cast<Eigen::Index>(TorqueParts::kCount);
/// Of the parts, in their order.
enum Column : Eigen::Index { kSense, kOne, kRate, kSpeedup, kSine, kCosine };
constexpr Eigen::Index kBlocks = 24;

/// Means over stretches in which the motor goes one way and is through the loop.
struct Rows {
  Eigen::MatrixXd columns;
  Eigen::VectorXd torque;
  Eigen::VectorXd way;  ///< of the motor since it was through the loop, rad
};

using Row = std::array<double, kParts + 2>;  // columns, torque, way

auto mean_row(const AxisLog& log, const Sample<double>& last, const Eigen::VectorXd& rate,
              const Eigen::VectorXd& speedup, RowRange rows, double through) -> Row {
  const auto mean = [&](const Eigen::VectorXd& signal) { return signal.segment(rows.begin, rows.size()).mean(); };
  const double s = last.forward ? 1.0 : -1.0;
  const double q2 = mean(log.q2_rad);
  const double sine = std::sin(q2);
  const double cosine = 1.0 - std::cos(q2);
  return {s,      1.0,      mean(rate), mean(speedup),    sine,
          cosine, s * sine, s * cosine, mean(log.tau_nm), std::abs(mean(log.q1_rad) - last.q1_reversal) - through};
}

/// Stretches of 20 ms, and slopes over as much to either side: a count of 4096 a turn is then 0.04 rad/s, and 1 % of a
/// motion of 2 Hz is lost.
void add_log(const AxisLog& log, const Samples& samples, double half_width, std::vector<Row>& all) {
  constexpr double kReachS = 0.02;
  constexpr double kThrough = 2.2;   // half widths; a tenth for the knee
  constexpr double kResting = 0.05;  // of the speed's rms
  const auto reach = std::max<Eigen::Index>(1, std::lround(kReachS / log.period_s));
  const Eigen::VectorXd rate = local_slope(log.q1_rad, reach, log.period_s);
  const Eigen::VectorXd speedup = local_slope(rate, reach, log.period_s);
  const double slowest = kResting * rms(rate);
  for (Eigen::Index begin = 0; begin + reach <= log.samples(); begin += reach) {
    bool slides = true;
    for (Eigen::Index i = begin; slides && i < begin + reach; ++i) {
      const auto& sample = samples[static_cast<std::size_t>(i)];
      slides = (sample.forward ? rate[i] : -rate[i]) > slowest &&
               std::abs(sample.q1 - sample.q1_reversal) > kThrough * half_width;
    }
    if (slides) {
      const auto& last = samples[static_cast<std::size_t>(begin + reach - 1)];
      all.push_back(mean_row(log, last, rate, speedup, {begin, begin + reach}, 2.0 * half_width));
    }
  }
}

auto rows_of(const TorqueLogs& from) -> std::optional<Rows> {
  constexpr std::size_t kFewest = 200;  // 4 s of sliding
  std::vector<Row> all;
  for (std::size_t i = 0; i < from.logs.size(); ++i) {
    if (!from.logs[i].has_torque || from.logs[i].q2_rad.size() == 0) {
      return std::nullopt;
    }
    add_log(from.logs[i], from.samples[i], from.half_width_rad, all);
  }
  if (all.size() < kFewest) {
    return std::nullopt;
  }
  const auto count = static_cast<Eigen::Index>(all.size());
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, kParts + 2, Eigen::RowMajor>;
  const Matrix table = Eigen::Map<const Matrix>(all.front().data(), count, kParts + 2);
  return Rows{table.leftCols(kParts), table.col(kParts), table.col(kParts + 1)};
}

auto fitted(const Eigen::MatrixXd& columns, const Eigen::VectorXd& torque) -> LinearFit {
  const std::vector<Sign> signs(static_cast<std::size_t>(columns.cols()), Sign::kAny);
  return fit_columns(columns, torque, even_parts({{0, columns.rows()}}, kBlocks), signs);
}

/// A constant torque beside it counts for nothing: sensors of current have one.
void judge(TorqueCause cause, const Eigen::MatrixXd& columns, const Eigen::VectorXd& change, TorqueChange& all) {
  Eigen::MatrixXd with_offset(columns.rows(), columns.cols() + 1);
  with_offset << columns, Eigen::VectorXd::Ones(columns.rows());
  const LinearFit fit = fitted(with_offset, change);
  const auto at = static_cast<std::size_t>(cause);
  all.share[at] = 1.0 - (fit.rmse * fit.rmse) / (all.rms_nm * all.rms_nm);
  all.size[at] = fit.theta[0];
  all.size_95[at] = half_interval(fit, 0);
}

/// Friction that is not there yet at first: f s (1 - 2 fade), fade from one to nothing over the way until it slides.
auto bristle(const Rows& rows, double way) -> Eigen::VectorXd {
  const Eigen::ArrayXd fade = (1.0 - rows.way.array() / way).max(0.0).min(1.0);
  return rows.columns.col(kSense).array() * (1.0 - 2.0 * fade);
}

}  // namespace

auto torque_parts(const TorqueLogs& from) -> std::optional<TorqueParts> {
  const auto rows = rows_of(from);
  if (!rows) {
    return std::nullopt;
  }
  const Eigen::VectorXd theta = fitted(rows->columns, rows->torque).theta;
  TorqueParts parts;
  std::copy(theta.begin(), theta.end(), parts.values.begin());
  return parts;
}

auto torque_change(const TorqueLogs& now, const TorqueParts& healthy) -> std::optional<TorqueChange> {
  const auto rows = rows_of(now);
  if (!rows) {
    return std::nullopt;
  }
  const Eigen::Map<const Eigen::VectorXd> parts(healthy.values.data(), kParts);
  const Eigen::VectorXd change = rows->torque - rows->columns * parts;
  TorqueChange all;
  all.rms_nm = rms((change.array() - change.mean()).matrix());
  judge(TorqueCause::kFriction, rows->columns.col(kSense), change, all);
  judge(TorqueCause::kWeight, rows->columns.middleCols(kSine, 2), change, all);
  judge(TorqueCause::kMass, rows->columns.col(kSpeedup), change, all);
  judge(TorqueCause::kDrag, rows->columns.col(kRate), change, all);
  TorqueChange best = all;
  for (const double widths : {0.5, 1.0, 2.0, 4.0, 8.0}) {
    const double way = widths * now.half_width_rad;
    judge(TorqueCause::kBristle, bristle(*rows, way), change, all);
    if (all.share.back() > best.share.back()) {
      best = all;
      best.bristle_way_rad = way;
    }
  }
  return best;
}

}  // namespace capstan::tools
