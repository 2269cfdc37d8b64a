// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/residual_map.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kCells = 8;            // of each signal and direction
constexpr Index kEnoughToMap = 40000;  // neighbours say the same
constexpr Index kFewestVisits = 4;     // a mean of fewer has no spread worth the name
constexpr double kFalseShare = 0.05;   // of the cells that are found
/// Of the motor's range: what turns round within less is taken for noise.
constexpr double kTurnShare = 0.01;

struct MapMotion {
  VectorXd speed, since_reversal;
  std::vector<bool> forward;
};

/// Rows of one log each, by where time goes back.
auto logs_in(const VectorXd& time_s) -> std::vector<std::pair<Index, Index>> {
  std::vector<std::pair<Index, Index>> logs;
  Index begin = 0;
  for (Index i = 1; i <= time_s.size(); ++i) {
    if (i == time_s.size() || time_s[i] < time_s[i - 1]) {
      logs.emplace_back(begin, i);
      begin = i;
    }
  }
  return logs;
}

/// Direction and reversals of one log, each put where the motor was farthest.
void add_motion(const MapSignals& s, Index begin, Index end, double turn, MapMotion& motion) {
  Index farthest = begin;
  Index turned = begin;
  bool forward = true;
  for (Index i = begin; i < end; ++i) {
    const double back = (forward ? 1.0 : -1.0) * (s.q1[farthest] - s.q1[i]);
    if (back <= 0.0) {
      farthest = i;
    } else if (back > turn) {
      forward = !forward;
      turned = farthest == begin ? begin : farthest + 1;  // at the begin: it went that way from the start on
      std::fill(motion.forward.begin() + turned, motion.forward.begin() + i, forward);
      for (Index k = turned; k < i; ++k) {
        motion.since_reversal[k] = s.time_s[k] - s.time_s[turned];
      }
      farthest = i;
    }
    motion.forward[static_cast<std::size_t>(i)] = forward;
    motion.since_reversal[i] = s.time_s[i] - s.time_s[turned];
    const Index before = std::max(begin, i - 2);
    const Index after = std::min(end - 1, i + 2);
    const double passed = s.time_s[after] - s.time_s[before];
    motion.speed[i] = passed > 0.0 ? std::abs(s.q1[after] - s.q1[before]) / passed : 0.0;
  }
}

auto motion_of(const MapSignals& s) -> MapMotion {
  MapMotion motion{VectorXd::Zero(s.q1.size()), VectorXd::Zero(s.q1.size()),
                   std::vector<bool>(static_cast<std::size_t>(s.q1.size()), true)};
  const double turn = kTurnShare * (s.q1.maxCoeff() - s.q1.minCoeff());
  for (const auto& [begin, end] : logs_in(s.time_s)) {
    add_motion(s, begin, end, turn, motion);
  }
  return motion;
}

/// Two-sided p of Student's t, by the normal score of the same tail (Wallace 1959), within 1 % from 3 degrees on.
auto p_of_t(double t, double degrees) -> double {
  const double z = (8.0 * degrees + 1.0) / (8.0 * degrees + 3.0) * std::sqrt(degrees * std::log1p(t * t / degrees));
  return 2.0 * normal_tail(z);
}

/// The mean residual of some rows, ascending, and its p: what neighbouring rows err together counts once.
void judge(const std::vector<Index>& rows, const VectorXd& residual, MapCell& cell) {
  cell.rows = static_cast<Index>(rows.size());
  std::vector<double> sums;
  std::vector<double> sizes;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i == 0 || rows[i] != rows[i - 1] + 1) {
      sums.push_back(0.0);
      sizes.push_back(0.0);
    }
    sums.back() += residual[rows[i]];
    sizes.back() += 1.0;
  }
  cell.visits = static_cast<Index>(sums.size());
  const auto count = static_cast<double>(rows.size());
  cell.mean = std::accumulate(sums.begin(), sums.end(), 0.0) / count;
  if (cell.visits < kFewestVisits) {
    return;
  }
  double spread = 0.0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    spread += std::pow(sums[i] - cell.mean * sizes[i], 2.0);
  }
  const auto visits = static_cast<double>(cell.visits);
  const double error = std::sqrt(spread * visits / (visits - 1.0)) / count;
  cell.p_value = error > 0.0 ? p_of_t(cell.mean / error, visits - 1.0) : (cell.mean == 0.0 ? 1.0 : 0.0);
}

void add_cells(const std::string& name, const VectorXd& signal, const MapMotion& motion, bool forward,
               const VectorXd& residual, ResidualMap& map) {
  std::vector<Index> rows;
  for (Index i = 0; i < signal.size(); ++i) {
    if (motion.forward[static_cast<std::size_t>(i)] == forward) {
      rows.push_back(i);
    }
  }
  if (std::ssize(rows) < kCells) {
    return;
  }
  std::stable_sort(rows.begin(), rows.end(), [&](Index a, Index b) { return signal[a] < signal[b]; });
  for (Index k = 0; k < kCells; ++k) {
    const auto first = rows.begin() + std::ssize(rows) * k / kCells;
    const auto last = rows.begin() + std::ssize(rows) * (k + 1) / kCells;
    std::vector<Index> own(first, last);
    MapCell cell{.signal = name, .forward = forward, .from = signal[own.front()], .to = signal[own.back()]};
    std::sort(own.begin(), own.end());
    judge(own, residual, cell);
    map.cells.push_back(std::move(cell));
  }
}

/// Benjamini and Yekutieli's step-up procedure.
void find_cells(std::vector<MapCell>& cells) {
  std::vector<double> sorted;
  double harmonic = 0.0;
  for (const auto& cell : cells) {
    sorted.push_back(cell.p_value);
    harmonic += 1.0 / static_cast<double>(sorted.size());
  }
  std::sort(sorted.begin(), sorted.end());
  double limit = -1.0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const double allowed = kFalseShare * static_cast<double>(i + 1) / (static_cast<double>(sorted.size()) * harmonic);
    limit = sorted[i] <= allowed ? sorted[i] : limit;
  }
  for (auto& cell : cells) {
    cell.found = cell.visits >= kFewestVisits && cell.p_value <= limit;
  }
}

auto sentence_of(const std::vector<MapCell>& cells) -> std::string {
  const MapCell* largest = nullptr;
  Index found = 0;
  for (const auto& cell : cells) {
    found += cell.found ? 1 : 0;
    if (cell.found && (largest == nullptr || std::abs(cell.mean) > std::abs(largest->mean))) {
      largest = &cell;
    }
  }
  if (largest == nullptr) {
    return "The residual shows no structure: its mean differs from zero in none of " + std::to_string(cells.size()) +
           " cells.";
  }
  return "The mean of the residual differs from zero in " + std::to_string(found) + " of " +
         std::to_string(cells.size()) + " cells, most (" + rounded(largest->mean, 3) + ") at " + largest->signal +
         " from " + rounded(largest->from, 3) + " to " + rounded(largest->to, 3) +
         (largest->forward ? ", forward." : ", backward.");
}

}  // namespace

auto residual_map(const MapSignals& all, const VectorXd& of_all) -> ResidualMap {
  ResidualMap map;
  if (of_all.size() == 0 || all.q1.size() != of_all.size()) {
    return map;
  }
  const auto some = Eigen::seq(0, of_all.size() - 1, std::max<Index>(1, of_all.size() / kEnoughToMap));
  const VectorXd residual = of_all(some);
  const bool loaded = all.load.size() == of_all.size();
  const MapSignals signals{all.time_s(some), all.q1(some), loaded ? VectorXd(all.load(some)) : VectorXd()};
  const MapMotion motion = motion_of(signals);
  for (const bool forward : {true, false}) {
    add_cells("angle", signals.q1, motion, forward, residual, map);
    add_cells("speed", motion.speed, motion, forward, residual, map);
    if (loaded && signals.load.maxCoeff() > signals.load.minCoeff()) {
      add_cells("load", signals.load, motion, forward, residual, map);
    }
    add_cells("time_since_reversal", motion.since_reversal, motion, forward, residual, map);
  }
  find_cells(map.cells);
  map.sentence = sentence_of(map.cells);
  return map;
}

}  // namespace capstan::tools
