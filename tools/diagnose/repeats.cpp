// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/repeats.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

constexpr double kCloseShare = 0.03;  // of the motion's range
constexpr double kAgreeing = 0.9;     // of the samples
constexpr Eigen::Index kCoarseRows = 2000;
constexpr double kSettledShare = 0.005;  // of the motion's range: less of a change from first to last is none

/// Share of rows at which the signal agrees with itself `lag` rows later.
auto agreement(const Eigen::VectorXd& motion, Eigen::Index lag, double close, Eigen::Index begin, Eigen::Index rows)
    -> double {
  const auto difference = motion.segment(begin + lag, rows) - motion.segment(begin, rows);
  return static_cast<double>((difference.array().abs() < close).count()) / static_cast<double>(rows);
}

auto thinned(const Eigen::VectorXd& motion, Eigen::Index step) -> Eigen::VectorXd {
  Eigen::VectorXd result(motion.size() / step);
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    result[i] = motion[i * step];
  }
  return result;
}

/// A lag at which almost everything agrees is a period only if something moved in between.
auto moves_within(const Eigen::VectorXd& motion, Eigen::Index begin, Eigen::Index length, double range) -> bool {
  const auto part = motion.segment(begin, length);
  return part.maxCoeff() - part.minCoeff() > 0.5 * range;
}

/// The first lag above another at which the motion agrees with itself after having gone away; of the lags around it the
/// one that agrees best. 0 if there is none.
auto coarse_period(const Eigen::VectorXd& motion, double close, double range, Eigen::Index above) -> Eigen::Index {
  const Eigen::Index n = motion.size();
  double least = std::numeric_limits<double>::infinity();
  Eigen::Index period = 0;
  bool gone_away = false;  // small lags agree trivially
  for (Eigen::Index lag = 1; lag <= n / 2; ++lag) {
    // The later part of what overlaps: a lead-in before the first cycle does not count against it.
    const Eigen::Index rows = std::min(n - lag, std::max(lag, (n - lag) * 3 / 4));
    const Eigen::Index begin = n - lag - rows;
    const double share = agreement(motion, lag, close, begin, rows);
    gone_away = gone_away || share < 0.5;
    const bool agrees =
        lag > above && gone_away && share > kAgreeing && moves_within(motion, begin, std::min(rows, lag), range);
    if (!agrees && period != 0) {
      break;  // the multiples of a period agree as well, but it is the first that counts
    }
    const double difference =
        (motion.segment(begin + lag, rows) - motion.segment(begin, rows)).squaredNorm() / static_cast<double>(rows);
    if (agrees && difference < least) {
      least = difference;
      period = lag;
    }
  }
  return period;
}

/// The lag near a coarse one, of `step` rows each, at which the motion agrees best.
auto exact_period(const Eigen::VectorXd& motion, Eigen::Index coarse, Eigen::Index step) -> Eigen::Index {
  constexpr Eigen::Index kReach = 4;  // coarse lags: noise moves the coarse minimum by one or two
  double least = std::numeric_limits<double>::infinity();
  Eigen::Index period = coarse * step;
  for (Eigen::Index lag = std::max<Eigen::Index>(1, (coarse - kReach) * step); lag <= (coarse + kReach) * step; ++lag) {
    const Eigen::Index rows = motion.size() - lag;
    if (rows < lag) {
      break;
    }
    const Eigen::Index used = std::max(lag, rows * 3 / 4);
    const double difference = rms(motion.tail(used) - motion.segment(motion.size() - used - lag, used));
    if (difference < least) {
      least = difference;
      period = lag;
    }
  }
  return period;
}

/// Whole cycles counted back from the end, as long as they agree with the one after them.
auto whole_cycles(const Eigen::VectorXd& motion, Eigen::Index length, double close) -> Repeats {
  Repeats repeats{motion.size() - length, length, 1};
  while (repeats.first >= length && agreement(motion, length, close, repeats.first - length, length) > kAgreeing) {
    repeats.first -= length;
    ++repeats.count;
  }
  return repeats;
}

/// A swing that dies away agrees with the next one, but not with the last.
auto dies_away(const Eigen::VectorXd& motion, const Repeats& repeats, double range) -> bool {
  auto difference = [&](Eigen::Index a, Eigen::Index b) {
    return rms(motion.segment(repeats.cycle(a).begin, repeats.length) -
               motion.segment(repeats.cycle(b).begin, repeats.length));
  };
  const Eigen::Index last = repeats.count - 1;
  double neighbours = 0.0;
  for (Eigen::Index i = 0; i < last; ++i) {
    neighbours += difference(i, i + 1) / static_cast<double>(last);
  }
  return difference(0, last) > std::max(kSettledShare * range, 2.0 * neighbours);
}

}  // namespace

auto find_repeats(const Eigen::VectorXd& motion, double noise_rad) -> std::optional<Repeats> {
  const double range = motion.maxCoeff() - motion.minCoeff();
  const double close = std::max(kCloseShare * range, 4.0 * noise_rad);
  const Eigen::Index step = std::max<Eigen::Index>(1, motion.size() / kCoarseRows);
  const Eigen::VectorXd coarse = thinned(motion, step);
  for (Eigen::Index period = coarse_period(coarse, close, range, 0); range > 0.0 && period > 0;
       period = coarse_period(coarse, close, range, period)) {
    const auto repeats = whole_cycles(motion, exact_period(motion, period, step), close);
    if (repeats.count >= 2 && !dies_away(motion, repeats, range)) {
      return repeats;
    }
  }
  return std::nullopt;
}

auto comes_again(const Eigen::VectorXd& signal, const Repeats& repeats) -> bool {
  const double close = kCloseShare * range_of(signal);
  for (Eigen::Index i = 0; close > 0.0 && i + 1 < repeats.count; ++i) {
    if (agreement(signal, repeats.length, close, repeats.cycle(i).begin, repeats.length) <= kAgreeing) {
      return false;
    }
  }
  return true;
}

auto pure_error(const Eigen::VectorXd& signal, const Repeats& repeats) -> Eigen::VectorXd {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(repeats.length);
  for (Eigen::Index i = 0; i < repeats.count; ++i) {
    mean += signal.segment(repeats.cycle(i).begin, repeats.length);
  }
  const auto count = static_cast<double>(repeats.count);
  mean /= count;
  Eigen::VectorXd error = Eigen::VectorXd::Zero(signal.size());
  for (Eigen::Index i = 0; i < repeats.count; ++i) {
    error.segment(repeats.cycle(i).begin, repeats.length) =
        (signal.segment(repeats.cycle(i).begin, repeats.length) - mean) * std::sqrt(count / (count - 1.0));
  }
  return error;
}

}  // namespace capstan::tools
