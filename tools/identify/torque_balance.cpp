// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/torque_balance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "capstan/tools/identify/load_fit.hpp"
#include "capstan/tools/identify/noncausal_samples.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/tone_share.hpp"

namespace capstan::tools {
namespace {

constexpr auto kParts = static_cast<Eigen::Index>(TorqueParts::kCount);
/// Of the parts, in their order.
enum BalanceColumn : Eigen::Index { kSense, kOne, kRate, kSpeedup, kSine, kCosine };

/// Means over stretches in which the motor goes one way and is through the loop.
struct BalanceRows {
  Eigen::MatrixXd columns;
  Eigen::VectorXd torque;
  Eigen::VectorXd angle;          ///< of the motor, rad
  Eigen::VectorXd joint_rad;      ///< angle of the joint
  Eigen::VectorXd way;            ///< of the motor since it was through the loop, rad
  Eigen::VectorXd joint_speedup;  ///< rad/s2
  Eigen::VectorXd torque_alike;   ///< the torque through what the joint's acceleration went through
  Eigen::VectorXd time;           ///< s; of several logs one after the other
  double speedup_noise = 0.0;     ///< of the joint's acceleration, by its sensor's noise, (rad/s2)^2
};

/// Columns, torque, both angles, way, the joint's acceleration, the torque that goes with it, and the time.
constexpr Eigen::Index kRowSize = kParts + 7;
using Row = std::array<double, kRowSize>;

/// Rates and accelerations of a log, rad/s and rad/s2.
struct SmoothMotion {
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

/// What white noise of the joint's sensor is in means over `reach` rows of its acceleration, (rad/s2)^2.
auto speedup_noise(const AxisLog& log, Eigen::Index reach) -> double {
  Eigen::VectorXd impulse = Eigen::VectorXd::Zero(8 * reach + 1);
  impulse[4 * reach] = 1.0;
  const Eigen::VectorXd answer = local_slope(local_slope(impulse, reach, log.period_s), reach, log.period_s);
  double squares = 0.0;
  for (Eigen::Index i = 0; i + reach <= answer.size(); ++i) {
    squares += std::pow(answer.segment(i, reach).mean(), 2);
  }
  return squares * std::pow(white_noise_level(log.q2_rad), 2);
}

auto mean_row(const AxisLog& log, const Sample<double>& last, const SmoothMotion& motion, RowRange rows, double through,
              double time_s) -> Row {
  const auto mean = [&](const Eigen::VectorXd& signal) { return signal.segment(rows.begin, rows.size()).mean(); };
  const double s = last.forward ? 1.0 : -1.0;
  const double q1 = mean(log.q1_rad);
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
          q1,
          q2,
          std::abs(q1 - last.q1_reversal) - through,
          mean(motion.joint_speedup),
          mean(motion.torque_alike),
          time_s};
}

/// Rows of 20 ms, for stretches, and slopes over as much to either side: a count of 4096 a turn is then 0.04 rad/s, and
/// 1 % of a motion of 2 Hz is lost.
auto reach_of(const AxisLog& log) -> Eigen::Index {
  constexpr double kReachS = 0.02;
  return std::max<Eigen::Index>(1, std::lround(kReachS / log.period_s));
}

/// @param began_s  where the log begins in the time of all
void add_log(const AxisLog& log, const Samples& samples, const TorqueLogs& from, double began_s,
             std::vector<Row>& all) {
  constexpr double kThrough = 2.2;   // half widths; a tenth for the knee
  constexpr double kResting = 0.05;  // of the speed's rms
  const Eigen::Index reach = reach_of(log);
  const auto slope = [&](const Eigen::VectorXd& signal) { return local_slope(signal, reach, log.period_s); };
  const Eigen::VectorXd rate = slope(log.q1_rad);
  const SmoothMotion motion{rate, slope(rate), slope(slope(ahead_by(from.late_s / log.period_s, log.q2_rad))),
                            behind_slope(behind_slope(log.tau_nm, reach), reach)};
  const double slowest = kResting * rms(rate);
  for (Eigen::Index begin = 0; begin + reach <= log.samples(); begin += reach) {
    bool slides = true;
    for (Eigen::Index i = begin; slides && i < begin + reach; ++i) {
      const auto& sample = samples[static_cast<std::size_t>(i)];
      slides = (sample.forward ? rate[i] : -rate[i]) > slowest &&
               std::abs(sample.q1 - sample.q1_reversal) > kThrough * from.half_width_rad;
    }
    if (slides) {
      const auto& last = samples[static_cast<std::size_t>(begin + reach - 1)];
      all.push_back(mean_row(log, last, motion, {begin, begin + reach}, 2.0 * from.half_width_rad,
                             began_s + log.period_s * static_cast<double>(begin)));
    }
  }
}

auto rows_of(const TorqueLogs& from) -> std::optional<BalanceRows> {
  constexpr std::size_t kFewest = 200;  // 4 s of sliding
  std::vector<Row> all;
  double noise = 0.0;
  double began_s = 0.0;
  for (std::size_t i = 0; i < from.logs.size(); ++i) {
    const AxisLog& log = from.logs[i];
    if (!log.has_torque || log.q2_rad.size() == 0) {
      return std::nullopt;
    }
    const std::size_t before = all.size();
    add_log(log, from.samples[i], from, began_s, all);
    began_s += log.period_s * static_cast<double>(log.samples());
    noise += all.size() > before ? static_cast<double>(all.size() - before) * speedup_noise(log, reach_of(log)) : 0.0;
  }
  if (all.size() < kFewest) {
    return std::nullopt;
  }
  const auto count = static_cast<Eigen::Index>(all.size());
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, kRowSize, Eigen::RowMajor>;
  const Matrix table = Eigen::Map<const Matrix>(all.front().data(), count, kRowSize);
  return BalanceRows{table.leftCols(kParts), table.col(kParts),     table.col(kParts + 1),
                     table.col(kParts + 2),  table.col(kParts + 3), table.col(kParts + 4),
                     table.col(kParts + 5),  table.col(kParts + 6), noise / static_cast<double>(count)};
}

void take_size(TorqueCause cause, const LinearFit& fit, TorqueChange& all) {
  const auto at = static_cast<std::size_t>(cause);
  all.size[at] = fit.theta[0];
  all.size_95[at] = half_interval(fit, 0);
}

/// Of a signal's energy about its mean.
auto share_of(const LinearFit& fit, const Eigen::VectorXd& signal) -> double {
  return 1.0 - std::pow(fit.rmse / rms_about_mean(signal), 2);
}

/// What a cause alone, and a constant, take away of the change.
void judge(TorqueCause cause, const Eigen::MatrixXd& columns, const Eigen::VectorXd& change, TorqueChange& all) {
  const LinearFit fit = fitted(with_offset(columns), change);
  all.share[static_cast<std::size_t>(cause)] = share_of(fit, change);
  take_size(cause, fit, all);
}

/// Of the change's energy, by a mass. What shakes the joint from outside goes with the joint's acceleration, too, so
/// the motor's has to explain the change as well. It does not where a mass swings on its tendons after each turn of the
/// motor: then it has to say as large a mass, for certain, and a swing comes and goes where a tremor keeps its pitch.
auto share_of_mass(const BalanceRows& rows, const Eigen::VectorXd& change, const Eigen::VectorXd& alike,
                   const TorqueChange& all) -> double {
  const double by_joint = all.share_of(TorqueCause::kMass);
  const LinearFit motor = fitted(with_offset(rows.columns.col(kSpeedup)), change);
  const double by_motor = share_of(motor, change);
  const double as_large = motor.theta[0] / all.size_of(TorqueCause::kMass);
  const bool agrees =
      motor.theta[0] > half_interval(motor, 0) && as_large < kMassAsLarge && 1.0 < kMassAsLarge * as_large;
  const bool swings = by_motor < by_joint && agrees && tone_share(rows.time, alike) < kOneTone;
  return swings ? by_joint : std::min(by_joint, by_motor);
}

/// Under a load the tendons need a longer way until both slide: rows this many half widths behind the loop, where there
/// are enough. On drawn joints 704 a weight was 15 % too large without, 4 % with 5 and more.
constexpr double kLoaded = 5.0;

/// Rows that are far enough.
auto loaded_rows(const BalanceRows& rows, double half_width) -> std::vector<Eigen::Index> {
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

/// A mass by the joint's own acceleration, whose noise makes every mass too small by its share of the acceleration's
/// square.
void size_mass(const BalanceRows& rows, const std::vector<Eigen::Index>& far, const Eigen::VectorXd& alike, double beta,
               double friction, TorqueChange& all) {
  constexpr double kMostNoise = 0.5;
  const Eigen::VectorXd speedup = rows.joint_speedup(far);
  take_load(TorqueCause::kMass, {speedup / beta, rows.columns.col(kSense)(far), alike(far), true}, friction, all);
  const double noise_share = rows.speedup_noise / std::pow(rms_about_mean(speedup), 2);
  const double true_share = 1.0 - std::min(kMostNoise, noise_share);
  all.size[static_cast<std::size_t>(TorqueCause::kMass)] /= true_share;
  all.size_95[static_cast<std::size_t>(TorqueCause::kMass)] /= true_share;
}

/// Friction that is not there yet at first: f s (1 - 2 fade), fade from one to nothing over the way until it slides.
auto bristle(const BalanceRows& rows, double way) -> Eigen::VectorXd {
  const Eigen::ArrayXd fade = (1.0 - rows.way.array() / way).max(0.0).min(1.0);
  return rows.columns.col(kSense).array() * (1.0 - 2.0 * fade);
}

/// Once it slides it is friction like any other: of the rows behind its way. Joints 701, 703 and 705 come out
/// within 1.4
/// %; where a tendon goes slack under it the motor feels more, 23 and 27 % on 702 and 704. Twice what all rows say
/// otherwise holds all five (November 2026).
void size_bristle(const BalanceRows& rows, const Eigen::VectorXd& change, TorqueChange& all) {
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

/// A load that goes with this function of the joint's angle, straight at 0, as tendons carry it while both are taut:
/// its friction turns round with the motion.
auto fitted_load(const Eigen::VectorXd& load, const Eigen::VectorXd& sense, const Eigen::VectorXd& change)
    -> LinearFit {
  Eigen::MatrixXd columns(load.size(), 3);
  columns << load, load.cwiseProduct(sense), sense;
  return fitted(with_offset(columns), change);
}

/// Both look alike near 0; the farther the joint goes, the less a weight pulls more.
void ask_for_spring(const BalanceRows& rows, const Eigen::VectorXd& change, double half_width, TorqueChange& all) {
  const auto far = loaded_rows(rows, half_width);
  const Eigen::VectorXd sense = rows.columns.col(kSense)(far);
  const Eigen::VectorXd torque = change(far);
  const LinearFit weight = fitted_load(rows.columns.col(kSine)(far), sense, torque);
  const LinearFit spring = fitted_load(rows.joint_rad(far), sense, torque);
  all.spring_over_weight = weight.rmse > 0.0 ? spring.rmse / weight.rmse : 1.0;
  all.spring_nm_per_rad = spring.theta[0];
  all.spring_95 = half_interval(spring, 0);
}

/// Of the causes that may be it: loads, as the tendons carry them.
/// @param alike  the change, through what the joint's acceleration went through
void take_sizes(const BalanceRows& rows, const Eigen::VectorXd& change, const Eigen::VectorXd& alike,
                const TorqueLogs& now, double friction, TorqueChange& all) {
  constexpr double kMayBeIt = 0.3;
  const auto may_be = [&](TorqueCause cause) { return all.share[static_cast<std::size_t>(cause)] > kMayBeIt; };
  const Eigen::VectorXd sense = rows.columns.col(kSense);
  const auto far = loaded_rows(rows, now.half_width_rad);
  if (may_be(TorqueCause::kWeight)) {
    ask_for_spring(rows, change, now.half_width_rad, all);
    const Eigen::VectorXd cosine = 1.0 - rows.columns.col(kCosine)(far).array();
    take_load(TorqueCause::kWeight, {rows.columns.col(kSine)(far), sense(far), change(far), false, cosine}, friction,
              all);
  }
  if (may_be(TorqueCause::kMass)) {
    size_mass(rows, far, alike, now.beta, friction, all);
  }
  if (may_be(TorqueCause::kBristle)) {
    size_bristle(rows, change, all);
  }
}

/// Beyond the healthy joint's.
auto change_of(const BalanceRows& rows, const TorqueParts& healthy) -> Eigen::VectorXd {
  return rows.torque - rows.columns * Eigen::Map<const Eigen::VectorXd>(healthy.values.data(), kParts);
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

auto periodic_torque(const TorqueLogs& now, const TorqueParts& healthy, double order) -> double {
  const auto rows = rows_of(now);
  if (!rows) {
    return 0.0;
  }
  Eigen::MatrixXd wave(rows->angle.size(), 2);
  wave << (order * rows->angle).array().sin(), (order * rows->angle).array().cos();
  return fitted(with_offset(wave), change_of(*rows, healthy)).theta.head(2).norm();
}

auto torque_change(const TorqueLogs& now, const TorqueParts& healthy) -> std::optional<TorqueChange> {
  const auto rows = rows_of(now);
  if (!rows) {
    return std::nullopt;
  }
  const Eigen::VectorXd change = change_of(*rows, healthy);
  TorqueChange all;
  all.rms_nm = rms_about_mean(change);
  judge(TorqueCause::kFriction, rows->columns.col(kSense), change, all);
  judge(TorqueCause::kWeight, rows->columns.middleCols(kSine, 2), change, all);
  const Eigen::VectorXd alike = change + rows->torque_alike - rows->torque;
  judge(TorqueCause::kMass, rows->joint_speedup / now.beta, alike, all);
  all.share[static_cast<std::size_t>(TorqueCause::kMass)] = share_of_mass(*rows, change, alike, all);
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
  take_sizes(*rows, change, alike, now, healthy.friction(), best);
  return best;
}

}  // namespace capstan::tools
