// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/torque_balance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "capstan/tools/identify/load_fit.hpp"
#include "capstan/tools/identify/noncausal_samples.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

constexpr auto kParts = static_cast<Eigen::Index>(TorqueParts::kCount);
/// Of the parts, in their order.
enum Column : Eigen::Index { kSense, kOne, kRate, kSpeedup, kSine, kCosine };

/// Means over stretches in which the motor goes one way and is through the loop.
struct Rows {
  Eigen::MatrixXd columns;
  Eigen::VectorXd torque;
  Eigen::VectorXd way;              ///< of the motor since it was through the loop, rad
  Eigen::VectorXd joint_speedup;    ///< rad/s2
  Eigen::VectorXd torque_alike;     ///< the torque through what the joint's acceleration went through
  std::vector<Eigen::Index> first;  ///< rows that no row comes just before
};

/// Columns, torque, way, the joint's acceleration, the torque that goes with it, and when it was.
constexpr Eigen::Index kRowSize = kParts + 5;
using Row = std::array<double, kRowSize>;

/// Rates and accelerations of a log, rad/s and rad/s2.
struct Motion {
  Eigen::VectorXd rate, speedup, joint_speedup, torque_alike;
};

/// The mean whose slope is local_slope(): that is the slope of a signal behind a parabola's weights.
auto behind_slope(const Eigen::VectorXd& signal, Eigen::Index half_window) -> Eigen::VectorXd {
  const Eigen::Index n = signal.size();
  Eigen::VectorXd mean(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index h = std::min({half_window, i, n - 1 - i});
    double sum = 0.0;
    double weights = 0.0;
    for (Eigen::Index k = -h; k <= h; ++k) {
      const auto weight = static_cast<double>((h + 1) * (h + 1) - k * k);
      sum += weight * signal[i + k];
      weights += weight;
    }
    mean[i] = sum / weights;
  }
  return mean;
}

auto mean_row(const AxisLog& log, const Sample<double>& last, const Motion& motion, RowRange rows, double through)
    -> Row {
  const auto mean = [&](const Eigen::VectorXd& signal) { return signal.segment(rows.begin, rows.size()).mean(); };
  const double s = last.forward ? 1.0 : -1.0;
  const double q2 = mean(log.q2_rad);
  const double sine = std::sin(q2);
  const double cosine = 1.0 - std::cos(q2);
  return {s,
          1.0,
          mean(motion.rate),
          mean(motion.speedup),
          sine,
          cosine,
          s * sine,
          s * cosine,
          mean(log.tau_nm),
          std::abs(mean(log.q1_rad) - last.q1_reversal) - through,
          mean(motion.joint_speedup),
          mean(motion.torque_alike),
          static_cast<double>(rows.begin / rows.size())};
}

/// Stretches of 20 ms, and slopes over as much to either side: a count of 4096 a turn is then 0.04 rad/s, and 1 % of a
/// motion of 2 Hz is lost.
void add_log(const AxisLog& log, const Samples& samples, double half_width, std::vector<Row>& all) {
  constexpr double kReachS = 0.02;
  constexpr double kThrough = 2.2;   // half widths; a tenth for the knee
  constexpr double kResting = 0.05;  // of the speed's rms
  const auto reach = std::max<Eigen::Index>(1, std::lround(kReachS / log.period_s));
  const auto slope = [&](const Eigen::VectorXd& signal) { return local_slope(signal, reach, log.period_s); };
  const Eigen::VectorXd rate = slope(log.q1_rad);
  const Motion motion{rate, slope(rate), slope(slope(log.q2_rad)),
                      behind_slope(behind_slope(log.tau_nm, reach), reach)};
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
      all.push_back(mean_row(log, last, motion, {begin, begin + reach}, 2.0 * half_width));
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
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, kRowSize, Eigen::RowMajor>;
  const Matrix table = Eigen::Map<const Matrix>(all.front().data(), count, kRowSize);
  Rows rows{table.leftCols(kParts), table.col(kParts),     table.col(kParts + 1),
            table.col(kParts + 2),  table.col(kParts + 3), {}};
  for (Eigen::Index i = 0; i < count; ++i) {
    if (i == 0 || table(i, kRowSize - 1) != table(i - 1, kRowSize - 1) + 1.0) {
      rows.first.push_back(i);
    }
  }
  return rows;
}

void take_size(TorqueCause cause, const LinearFit& fit, TorqueChange& all) {
  const auto at = static_cast<std::size_t>(cause);
  all.size[at] = fit.theta[0];
  all.size_95[at] = half_interval(fit, 0);
}

/// What a cause alone, and a constant, take away of the change.
void judge(TorqueCause cause, const Eigen::MatrixXd& columns, const Eigen::VectorXd& change, TorqueChange& all) {
  const LinearFit fit = fitted(with_offset(columns), change);
  all.share[static_cast<std::size_t>(cause)] = 1.0 - (fit.rmse * fit.rmse) / (all.rms_nm * all.rms_nm);
  take_size(cause, fit, all);
}

/// Under a load the tendons need a longer way until both slide: rows this many half widths behind the loop, where there
/// are enough. On drawn joints 704 a weight was 15 % too large without, 4 % with 5 and more.
constexpr double kLoaded = 5.0;

/// Rows that are far enough.
auto loaded_rows(const Rows& rows, double half_width) -> std::vector<Eigen::Index> {
  std::vector<Eigen::Index> far;
  for (Eigen::Index i = 0; i < rows.way.size(); ++i) {
    if (rows.way[i] > kLoaded * half_width) {
      far.push_back(i);
    }
  }
  if (static_cast<Eigen::Index>(far.size()) < 4 * kLoadBlocks) {
    far.resize(static_cast<std::size_t>(rows.way.size()));
    std::iota(far.begin(), far.end(), Eigen::Index{0});
  }
  return far;
}

void take_load(TorqueCause cause, const LoadRows& of, double friction, TorqueChange& all) {
  const auto at = static_cast<std::size_t>(cause);
  const LoadAnswer told = told_load(of, friction, all.size[at]);
  all.size[at] = told.load;
  all.size_95[at] = told.half_95;
}

/// A mass swings on its tendons, at some Hz, and they stick and slide at that; over 0.1 s that averages out, in the
/// torque and in the joint's own acceleration alike.
void size_mass(const Rows& rows, const Eigen::VectorXd& alike, const TorqueLogs& now, double friction,
               TorqueChange& all) {
  constexpr Eigen::Index kTogether = 5;
  std::vector<std::array<double, 3>> means;
  for (std::size_t piece = 0; piece < rows.first.size(); ++piece) {
    const Eigen::Index end = piece + 1 < rows.first.size() ? rows.first[piece + 1] : alike.size();
    for (Eigen::Index i = rows.first[piece]; i + kTogether <= end; i += kTogether) {
      if (rows.way[i] > kLoaded * now.half_width_rad) {
        means.push_back({rows.joint_speedup.segment(i, kTogether).mean() / now.beta, alike.segment(i, kTogether).mean(),
                         rows.columns(i, kSense)});
      }
    }
  }
  if (static_cast<Eigen::Index>(means.size()) > kLoadBlocks) {
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>> table(
        means.front().data(), static_cast<Eigen::Index>(means.size()), 3);
    take_load(TorqueCause::kMass, {table.col(0), table.col(2), table.col(1), true}, friction, all);
  }
}

/// Friction that is not there yet at first: f s (1 - 2 fade), fade from one to nothing over the way until it slides.
auto bristle(const Rows& rows, double way) -> Eigen::VectorXd {
  const Eigen::ArrayXd fade = (1.0 - rows.way.array() / way).max(0.0).min(1.0);
  return rows.columns.col(kSense).array() * (1.0 - 2.0 * fade);
}

/// Once it slides it is friction like any other: of the rows behind its way. Joints 701, 703 and 705 come out
/// within 1.4
/// %; where a tendon goes slack under it the motor feels more, 23 and 27 % on 702 and 704. Twice what all rows say
/// otherwise holds all five (November 2026).
void size_bristle(const Rows& rows, const Eigen::VectorXd& change, TorqueChange& all) {
  const auto at = static_cast<std::size_t>(TorqueCause::kBristle);
  std::vector<Eigen::Index> slid;
  for (Eigen::Index i = 0; i < rows.way.size(); ++i) {
    if (rows.way[i] > all.bristle_way_rad) {
      slid.push_back(i);
    }
  }
  if (static_cast<Eigen::Index>(slid.size()) < 4 * kLoadBlocks) {
    return;
  }
  const Eigen::VectorXd sense = rows.columns.col(kSense);
  const LinearFit fit = fitted(with_offset(sense(slid)), change(slid));
  const double whole = all.size[static_cast<std::size_t>(TorqueCause::kFriction)];
  all.size[at] = fit.theta[0];
  all.size_95[at] = std::hypot(half_interval(fit, 0), 2.0 * (fit.theta[0] - whole));
}

/// Of the causes that may be it: loads, as the tendons carry them.
void take_sizes(const Rows& rows, const Eigen::VectorXd& change, const TorqueLogs& now, double friction,
                TorqueChange& all) {
  constexpr double kMayBeIt = 0.3;
  const auto may_be = [&](TorqueCause cause) { return all.share[static_cast<std::size_t>(cause)] > kMayBeIt; };
  const Eigen::VectorXd sense = rows.columns.col(kSense);
  if (may_be(TorqueCause::kWeight)) {
    const auto far = loaded_rows(rows, now.half_width_rad);
    const Eigen::VectorXd cosine = 1.0 - rows.columns.col(kCosine)(far).array();
    take_load(TorqueCause::kWeight, {rows.columns.col(kSine)(far), sense(far), change(far), false, cosine}, friction,
              all);
  }
  if (may_be(TorqueCause::kMass)) {
    size_mass(rows, change + rows.torque_alike - rows.torque, now, friction, all);
  }
  if (may_be(TorqueCause::kBristle)) {
    size_bristle(rows, change, all);
  }
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
  take_sizes(*rows, change, now, healthy.friction(), best);
  return best;
}

}  // namespace capstan::tools
