// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/log_zeros.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/settled.hpp"
#include "capstan/tools/support/play_column.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;

constexpr Index kEnoughForZeros = 8000;
constexpr Index kZeroBlocks = 24;
/// Half widths of gaps, of the least of the logs' ranges: each is crossed in every log.
constexpr std::array<double, 8> kGaps = {0.002, 0.005, 0.011, 0.025, 0.055, 0.12, 0.25, 0.4};

struct ZeroRows {
  std::vector<Index> log_rows;
  Eigen::VectorXd q1;
  Blocks blocks;  ///< in which every log has settled
};

auto thin(const Eigen::VectorXd& signal, Index step) -> Eigen::VectorXd {
  return signal(Eigen::seqN(0, (signal.size() + step - 1) / step, step));
}

/// Every `step`-th row of all logs, one below the other.
auto thinned_rows(const std::vector<AxisLog>& logs, Index step) -> ZeroRows {
  ZeroRows rows;
  for (const auto& log : logs) {
    const Eigen::VectorXd here = thin(log.q1_rad, step);
    rows.log_rows.push_back(here.size());
    rows.q1.conservativeResize(rows.q1.size() + here.size());
    rows.q1.tail(here.size()) = here;
  }
  rows.blocks = even_parts(settled_rows(rows.q1, pieces_of(rows.log_rows)), kZeroBlocks);
  return rows;
}

/// Least squares of a target on a constant for each log and the columns behind them.
auto zeros_by(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, const ZeroRows& rows)
    -> std::vector<LogZero> {
  const LinearFit fit = fit_columns(columns, target, rows.blocks,
                                    std::vector<Sign>(static_cast<std::size_t>(columns.cols()), Sign::kAny));
  std::vector<LogZero> zeros(1);
  for (Index log = 1; log < std::ssize(rows.log_rows); ++log) {
    Eigen::VectorXd difference = Eigen::VectorXd::Zero(columns.cols());
    difference[0] = -1.0;
    difference[log] = 1.0;
    zeros.push_back({fit.theta[log] - fit.theta[0], half_interval_of_sum(fit, difference)});
  }
  return zeros;
}

/// A constant for each log, and room for more columns.
auto with_constants(const ZeroRows& rows, Index more) -> Eigen::MatrixXd {
  const Index logs = std::ssize(rows.log_rows);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows.q1.size(), logs + more);
  const Blocks pieces = pieces_of(rows.log_rows);
  for (Index log = 0; log < logs; ++log) {
    const RowRange& piece = pieces[static_cast<std::size_t>(log)];
    columns.col(log).segment(piece.begin, piece.size()).setOnes();
  }
  return columns;
}

/// Whether every log moves where the first one does, for half of its motion. Where one does not, a curve over the angle
/// is as good an answer as another zero of the motor's.
auto share_angles(const std::vector<AxisLog>& logs) -> bool {
  const auto& first = logs.front().q1_rad;
  return std::all_of(logs.begin(), logs.end(), [&first](const AxisLog& log) {
    const double low = log.q1_rad.minCoeff();
    const double high = log.q1_rad.maxCoeff();
    return std::min(high, first.maxCoeff()) - std::max(low, first.minCoeff()) > 0.5 * (high - low);
  });
}

auto least_range(const std::vector<AxisLog>& logs) -> double {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& log : logs) {
    least = std::min(least, range_of(log.q1_rad));
  }
  return least;
}

auto speed_of(const AxisLog& log) -> Eigen::VectorXd {
  Eigen::VectorXd speed = Eigen::VectorXd::Zero(log.samples());
  const Index inside = std::max<Index>(0, log.samples() - 2);
  speed.segment(1, inside) = log.q1_rad.tail(inside) - log.q1_rad.head(inside);
  return speed;
}

/// Whether a joint follows its motor as far as in another log: no hand holds its tip in one of them.
auto moves_alike(const AxisLog& a, const AxisLog& b) -> bool {
  constexpr double kTimes = 1.5;
  const double ratio = range_of(a.q2_rad) * range_of(b.q1_rad) / (range_of(b.q2_rad) * range_of(a.q1_rad));
  return ratio > 1.0 / kTimes && ratio < kTimes;
}

/// What the log's inertia takes, but for its size: the second difference over 20 ms to either side.
auto acceleration_of(const AxisLog& log) -> Eigen::VectorXd {
  const auto reach = std::max<Index>(1, std::lround(0.02 / log.period_s));
  Eigen::VectorXd change = Eigen::VectorXd::Zero(log.samples());
  const Index inside = log.samples() - 2 * reach;
  if (inside > 0) {
    const auto& q1 = log.q1_rad;
    change.segment(reach, inside) = q1.tail(inside) - 2.0 * q1.segment(reach, inside) + q1.head(inside);
  }
  return change;
}

auto measured_of(AxisLog& log) -> Eigen::VectorXd& {
  return log.effort.size() > 0 ? log.effort : log.q2_rad;
}

/// @param which  of the logs the zeros are of, in their order
/// @return whether any log was counted anew
auto take_off(const std::vector<LogZero>& zeros, const std::vector<std::size_t>& which, std::vector<AxisLog>& logs)
    -> bool {
  bool any = false;
  for (std::size_t i = 0; i < which.size(); ++i) {
    if (zeros[i].is_certain()) {
      measured_of(logs[which[i]]).array() -= zeros[i].shift;
      any = true;
    }
  }
  return any;
}

}  // namespace

auto log_zeros(const std::vector<AxisLog>& logs) -> std::vector<LogZero> {
  const Index step = std::max<Index>(1, total_samples(logs) / kEnoughForZeros);
  const ZeroRows rows = thinned_rows(logs, step);
  const double middle = rows.q1.mean();
  const double range = least_range(logs);
  const bool is_curved = share_angles(logs);
  Eigen::MatrixXd columns = with_constants(rows, std::ssize(kGaps) + (is_curved ? 6 : 4));
  Eigen::VectorXd target(rows.q1.size());
  Index first = 0;
  for (const auto& log : logs) {
    const Eigen::VectorXd q1 = (log.q1_rad.array() - middle) / range;
    const Index count = (log.samples() + step - 1) / step;
    Index column = std::ssize(logs);
    const auto add = [&](const Eigen::VectorXd& signal) {
      columns.col(column++).segment(first, count) = thin(signal, step);
    };
    add(q1);
    if (is_curved) {
      add(q1.cwiseAbs2());
      add(q1.array().cube().matrix());
    }
    add(log.tau_nm);
    add(speed_of(log));
    add(acceleration_of(log));
    for (const double share : kGaps) {
      add(play_column(q1, share) - q1);
    }
    target.segment(first, count) = thin(log.measured(), step);
    first += count;
  }
  return zeros_by(columns, target, rows);
}

auto log_zeros_beside(const std::vector<AxisLog>& logs, const Eigen::VectorXd& residual) -> std::vector<LogZero> {
  const ZeroRows rows = thinned_rows(logs, 1);
  return zeros_by(with_constants(rows, 0), residual, rows);
}

auto count_from_one_zero(std::vector<AxisLog>& logs,
                         const std::function<Eigen::VectorXd(const std::vector<AxisLog>&)>& left_by_law)
    -> std::vector<std::string> {
  const bool effort = logs.front().effort.size() > 0;
  std::vector<std::string> sentences;
  if (effort ? !share_angles(logs) : logs.front().q2_rad.size() == 0) {
    return sentences;  // over other angles another weight is as good an answer as another zero
  }
  std::vector<std::size_t> alike;
  std::vector<AxisLog> free;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    if (effort || moves_alike(logs[i], logs.front())) {
      alike.push_back(i);
      free.push_back(logs[i]);
    }
  }
  const std::vector<AxisLog> as_logged = logs;
  if (free.size() < 2 || !take_off(log_zeros(free), alike, logs)) {
    return sentences;
  }
  if (!effort) {
    const std::vector<LogZero> all = log_zeros_beside(logs, left_by_law(logs));
    std::vector<LogZero> of_free;
    std::transform(alike.begin(), alike.end(), std::back_inserter(of_free), [&all](std::size_t i) { return all[i]; });
    take_off(of_free, alike, logs);
  }
  for (std::size_t i = 1; i < logs.size(); ++i) {
    const double shift = as_logged[i].measured()[0] - logs[i].measured()[0];
    if (shift != 0.0) {
      sentences.push_back(logs[i].name + ": " + (effort ? logs[i].target : "the joint") + "'s zero is " +
                          rounded(shift) + (effort ? "" : " rad") + " away from the first log's, and was subtracted");
    }
  }
  return sentences;
}

auto count_from_one_zero(std::vector<AxisLog>& logs, const LawForm& form) -> std::vector<std::string> {
  return count_from_one_zero(
      logs, [&form](const std::vector<AxisLog>& all) { return left_by(identify(all, form).joint, all); });
}

}  // namespace capstan::tools
