// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/channel_ends.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "capstan/tools/log/channel_shape.hpp"
#include "capstan/tools/log/wild_values.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;
using Rows = std::vector<Index>;

/// Set for the reasons beside them. Of 160 clean logs of tools/channel_benchmark (seeds 116000 on, 118000 on) and of
/// the measured machines none was accused then (29 November 2026).
constexpr double kClipShare = 0.004;   // of the rows
constexpr double kMostClipped = 0.5;   // of the rows: more of them at its ends, and it is a switch between two levels
constexpr double kAbrupt = 0.5;        // of the usual change, on the way into the end of the range
constexpr Index kWaysIn[] = {1, 3};    // rows: noise hides the longer way, a slow signal the shorter one
constexpr double kMoreThanStep = 1.5;  // steps of the resolution: by single ones a channel comes to rest, too
constexpr Index kLifted = 3;           // rows that noise lifts off the end
/// A smooth turn stays in the last step of its range at most 1 / (sqrt(2) - 1) = 2.4 times as long as in the step
/// before; what is cut off stays there for all that lies beyond.
constexpr double kPilesUp = 4.0;
constexpr double kFineStep = 1e-3;  // of the range: a step of a channel that shows none

constexpr double kWrapShare = 0.6;    // of the full range in one row
constexpr double kWrapAlike = 0.15;   // by which the jumps may differ
constexpr double kTurnShare = 0.02;   // by which a jump may miss a turn: the step of a fast joint from row to row
constexpr double kQuietBeside = 0.1;  // of the jump: all other changes
constexpr double kMostWraps = 0.02;   // of the rows

constexpr int kFewestBits = 8;         // of a word
constexpr double kNearEnd = 0.375;     // of the word's range: all values; half of it is left for each sign
constexpr double kFewestBelow = 0.01;  // of the rows: fewer are single wild values

/// Rows of the stretches that one end of the range cuts off. Noise may lift single rows off it.
/// @param least  change from row to row with which such a stretch begins
/// @param step   of the resolution, or of what stands for it
auto cut_off_at(const Eigen::VectorXd& x, double end, double least, double step) -> Rows {
  const auto from_end = (x.array() - end).abs();
  const auto there = static_cast<double>((from_end == 0.0).count());
  if (there <= kPilesUp * static_cast<double>((from_end > 0.0 && from_end <= step).count())) {
    return {};
  }
  Rows rows;
  Rows stretch;
  const auto finish = [&] {
    // A signal that turns or comes to rest is slow before it is flat; one that is cut off is not.
    const Index begin = stretch.empty() ? 0 : stretch.front();
    const bool abrupt = std::any_of(std::begin(kWaysIn), std::end(kWaysIn), [&](Index rows_in) {
      return begin >= rows_in && std::abs(end - x[begin - rows_in]) > static_cast<double>(rows_in) * least;
    });
    if (stretch.size() > 1 && abrupt) {
      rows.insert(rows.end(), stretch.begin(), stretch.end());
    }
    stretch.clear();
  };
  for (Index i = 0; i < x.size(); ++i) {
    if (x[i] != end) {
      continue;
    }
    if (!stretch.empty() && i > stretch.back() + 1 + kLifted) {
      finish();
    }
    stretch.push_back(i);
  }
  if (!stretch.empty() && stretch.back() + 1 < x.size()) {  // to the log's end: as where a motor is switched off
    finish();
  }
  return rows;
}

}  // namespace

auto clipped_rows(const Eigen::VectorXd& x) -> Rows {
  const double high = x.maxCoeff();
  const double low = x.minCoeff();
  const auto at_end = [&](Index i) { return x[i] == high || x[i] == low; };
  std::vector<double> changes;  // off the ends, where what is cut off shows no more than that it is
  for (Index i = 1; i < x.size(); ++i) {
    if (!at_end(i) || !at_end(i - 1)) {
      changes.push_back(std::abs(x[i] - x[i - 1]));
    }
  }
  const auto repeats = static_cast<double>(std::count(changes.begin(), changes.end(), 0.0));
  const auto moving = static_cast<double>(changes.size());
  if (moving < (1.0 - kMostClipped) * static_cast<double>(x.size()) || repeats > kRarelyRepeats * moving) {
    return {};  // coarse or held: the ends of its range are flat anyway
  }
  const double usual = median(Eigen::Map<const Eigen::VectorXd>(changes.data(), std::ssize(changes)));
  const double resolution = quantisation_step(x);
  const double least = std::max(kAbrupt * usual, kMoreThanStep * resolution);
  const double step = std::max(resolution, kFineStep * (high - low));
  Rows rows = cut_off_at(x, high, least, step);
  const Rows below = cut_off_at(x, low, least, step);
  rows.insert(rows.end(), below.begin(), below.end());
  std::sort(rows.begin(), rows.end());
  return static_cast<double>(rows.size()) < kClipShare * static_cast<double>(x.size()) ? Rows{} : rows;
}

auto jump_rows(const Eigen::VectorXd& x) -> Rows {
  const double range = x.maxCoeff() - x.minCoeff();
  const Eigen::VectorXd changes = changes_of(x);
  Rows rows;
  double largest = 0.0;
  double smallest = range;
  double other = 0.0;
  for (Index i = 0; i < changes.size(); ++i) {
    if (changes[i] > kWrapShare * range) {
      rows.push_back(i + 1);
      largest = std::max(largest, changes[i]);
      smallest = std::min(smallest, changes[i]);
    } else {
      other = std::max(other, changes[i]);
    }
  }
  const bool alike = largest - smallest <= kWrapAlike * largest && other < kQuietBeside * largest;
  Index lasting = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const bool after = k > 0 && rows[k] - rows[k - 1] <= kLongestSpike;
    const bool before = k + 1 < rows.size() && rows[k + 1] - rows[k] <= kLongestSpike;
    lasting += after || before ? 0 : 1;
  }
  const bool few = static_cast<double>(lasting) < kMostWraps * static_cast<double>(x.size());
  return range > 0.0 && alike && few && lasting > 0 ? rows : Rows{};
}

auto nearest_turn(double jump) -> std::optional<double> {
  const auto near = [jump](double turn) { return std::abs(jump - turn) <= kTurnShare * turn; };
  for (const double turn : {2.0 * std::numbers::pi, 360.0, 1.0}) {
    if (near(turn)) {
      return turn;
    }
  }
  constexpr double kFewestCounts = 512.0;  // 256 counts are a joint's 255 degrees as well
  const double counts = std::exp2(std::round(std::log2(jump)));
  return counts >= kFewestCounts && near(counts) ? std::optional(counts) : std::nullopt;
}

auto unsigned_range(const Eigen::VectorXd& x) -> std::optional<double> {
  const double step = quantisation_step(x);
  if (x.minCoeff() < 0.0 || step <= 0.0) {
    return std::nullopt;
  }
  const double bits = std::ceil(std::log2(x.maxCoeff() / step));
  const double range = step * std::exp2(bits);
  const auto below = static_cast<double>((x.array() > (1.0 - kNearEnd) * range).count());
  const auto between = (x.array() > kNearEnd * range && x.array() <= (1.0 - kNearEnd) * range).count();
  const bool word = bits >= kFewestBits && x.maxCoeff() > (1.0 - kTurnShare) * range &&
                    x.minCoeff() < kTurnShare * range && between == 0 &&
                    below >= kFewestBelow * static_cast<double>(x.size());
  return word ? std::optional(range) : std::nullopt;
}

}  // namespace capstan::tools
