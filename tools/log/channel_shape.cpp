// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/channel_shape.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;
using Rows = std::vector<Index>;

/// Of changes that a clock makes, so many come on its beat. It may jitter and lose pictures; but where changes come
/// sooner than its beat less the jitter, no clock makes them.
constexpr double kOnBeat = 0.97;
constexpr double kJitter = 1.0 / 3.0;  // of the beat: of two pictures, a sixth early or late each
constexpr double kMostLost = 2.0;      // pictures in turn
constexpr double kOneBeat = 1.5;       // beats: up to here none was lost
constexpr Index kFewestChanges = 20;
/// A channel that is held moves by several steps of its resolution from value to value; an encoder's count by one.
constexpr double kFewestStepsPerValue = 1.5;

constexpr double kStuckTravel = 0.25;  // of the motion's range, on the way while the channel stands
constexpr double kStuckBeside = 3.0;   // times the longest travel at the other standstills
constexpr Index kFewestStuck = 8;      // rows

constexpr double kNearZero = 0.03;      // of the largest value
constexpr Index kFewestSharpTurns = 4;  // at zero
constexpr double kEdge = 0.01;          // of the largest value: the smallest
constexpr double kFewestAtEdge = 12.0;  // rows near zero
constexpr double kEvenDensity = 0.25;   // of neighbouring bands
constexpr double kSharpTurns = 0.6;     // share of the turns near zero that are sharp

auto repeated_share(const Eigen::VectorXd& x) -> double {
  return static_cast<double>((changes_of(x).array() == 0.0).count()) / static_cast<double>(x.size() - 1);
}

struct Run {
  Index begin, end;
};

/// Stretches of one value, of at least `fewest` rows.
auto flat_runs(const Eigen::VectorXd& x, Index fewest) -> std::vector<Run> {
  std::vector<Run> runs;
  Index begin = 0;
  for (Index i = 1; i <= x.size(); ++i) {
    if (i == x.size() || x[i] != x[begin]) {
      if (i - begin >= fewest) {
        runs.push_back({begin, i});
      }
      begin = i;
    }
  }
  return runs;
}

void append_rows(Rows& rows, const Run& run) {
  for (Index i = run.begin; i < run.end; ++i) {
    rows.push_back(i);
  }
}

/// The density of a signal that crosses zero is finite there, and folded it still is; one that only comes near thins
/// out, and one that rests at zero piles up.
auto has_hard_edge(const Eigen::VectorXd& x, double top) -> bool {
  const auto between = [&](double low, double high) {
    return static_cast<double>((x.array() > low * top && x.array() <= high * top).count());
  };
  const auto zeros = static_cast<double>((x.array() == 0.0).count());
  const double first = between(0.0, kNearZero);
  const double second = between(kNearZero, 2.0 * kNearZero);
  return first >= kFewestAtEdge && first > kEvenDensity * second && second > kEvenDensity * first &&
         zeros < 0.3 * first;
}

/// Falls to zero and rises from it at once, at the usual speed.
auto turns_sharply(const Eigen::VectorXd& x, double top) -> bool {
  const double speed = quantile(changes_of(x), 0.7);
  Index turns = 0;
  Index sharp = 0;
  constexpr Index kReach = 3;
  for (Index i = kReach; i + kReach < x.size(); ++i) {
    const auto around = x.segment(i - kReach, 2 * kReach + 1);
    Index lowest = 0;
    if (x[i] > kNearZero * top || around.minCoeff(&lowest) < x[i] || lowest != kReach) {
      continue;
    }
    ++turns;
    const double fall = (x[i - kReach] - x[i]) / kReach;
    const double rise = (x[i + kReach] - x[i]) / kReach;
    sharp += fall > 0.3 * speed && rise > 0.3 * speed && fall < 4.0 * rise && rise < 4.0 * fall ? 1 : 0;
  }
  return turns >= kFewestSharpTurns && static_cast<double>(sharp) >= kSharpTurns * static_cast<double>(turns);
}

}  // namespace

auto robust_range(const Eigen::VectorXd& values) -> double {
  return quantile(values, 0.995) - quantile(values, 0.005);
}

auto changes_of(const Eigen::VectorXd& x) -> Eigen::VectorXd {
  return (x.tail(x.size() - 1) - x.head(x.size() - 1)).cwiseAbs();
}

auto varies(const Eigen::VectorXd& values) -> bool {
  return values.size() > 0 && values.maxCoeff() > values.minCoeff();
}

auto rows_per_value(const Eigen::VectorXd& x) -> std::optional<double> {
  std::vector<Index> at;
  std::vector<double> sizes;
  for (Index i = 1; i < x.size(); ++i) {
    if (x[i] != x[i - 1]) {
      at.push_back(i);
      sizes.push_back(std::abs(x[i] - x[i - 1]));
    }
  }
  if (static_cast<Index>(at.size()) < kFewestChanges) {
    return std::nullopt;
  }
  Eigen::VectorXd runs(static_cast<Index>(at.size()) - 1);
  for (Index i = 0; i < runs.size(); ++i) {
    runs[i] = static_cast<double>(at[static_cast<std::size_t>(i) + 1] - at[static_cast<std::size_t>(i)]);
  }
  const double beat = median(runs);
  const double jitter = std::max(1.0, kJitter * beat);
  // Changes of every second row on average come in the next row as well, so there a late one says nothing of a clock.
  const double longest = (beat - jitter > 1.0 ? (1.0 + kMostLost) * beat : beat) + jitter;
  const auto on_beat = (runs.array() >= beat - jitter).count();
  const auto near_beat = (runs.array() >= beat - jitter && runs.array() <= longest).count();
  const double step = quantisation_step(x);
  const double size = median(Eigen::Map<const Eigen::VectorXd>(sizes.data(), static_cast<Index>(sizes.size())));
  const bool by_steps = step <= 0.0 || size > kFewestStepsPerValue * step;
  constexpr double kMostlyNear = 0.85;
  const auto share = [&](Index count) { return static_cast<double>(count) / static_cast<double>(runs.size()); };
  if (beat < 2.0 || share(on_beat) < kOnBeat || share(near_beat) < kMostlyNear || !by_steps) {
    return std::nullopt;
  }
  const auto single = runs.array() <= kOneBeat * beat;
  return single.select(runs.array(), 0.0).sum() / static_cast<double>(single.count());
}

auto frame_rows(const Eigen::VectorXd& values, double beat) -> Rows {
  constexpr double kRest =
      2.5;  // beats without a new value: in less a picture was late or lost, and an old value is none
  Rows frames;
  const auto fill_rest = [&](Index end) {
    const Index begin = frames.empty() ? end : frames.back();
    const auto length = static_cast<double>(end - begin);
    for (double due = beat; length >= kRest * beat && due <= length - 0.5 * beat; due += beat) {
      frames.push_back(begin + static_cast<Index>(due));
    }
  };
  for (Index i = 1; i < values.size(); ++i) {
    if (values[i] != values[i - 1]) {
      fill_rest(i);
      frames.push_back(i);
    }
  }
  fill_rest(values.size());
  return frames;
}

auto stuck_rows(const Eigen::VectorXd& x, const Eigen::VectorXd& motion) -> Rows {
  struct Standstill {
    Run run;
    double travel;
  };
  const double range = robust_range(motion);
  std::vector<Standstill> still;
  for (const Run& run : flat_runs(x, kFewestStuck)) {
    const auto rows = motion.segment(run.begin, run.end - run.begin);
    still.push_back({run, rows.maxCoeff() - rows.minCoeff()});
  }
  // The usual standstill is that of lost motion at a reversal, and of an encoder's steps.
  constexpr std::size_t kFewest = 3;
  std::vector<double> travels;
  for (const auto& s : still) {
    travels.push_back(s.travel);
  }
  std::sort(travels.begin(), travels.end());
  const bool noisy = repeated_share(x) < kRarelyRepeats;
  const double usual = travels.size() > 2 * kFewest ? travels[travels.size() - 1 - kFewest] : 0.0;
  Rows rows;
  for (const auto& s : still) {
    if (s.travel > kStuckTravel * range &&
        (noisy || (travels.size() > 2 * kFewest && s.travel > kStuckBeside * usual))) {
      append_rows(rows, s.run);
    }
  }
  return rows;
}

auto is_magnitude(const Eigen::VectorXd& x, bool effort) -> bool {
  const double top = quantile(x, 0.995);
  const double bottom = x.minCoeff();
  if (!(top > 0.0) || bottom < 0.0 || bottom > kEdge * top) {
    return false;
  }
  return (effort && has_hard_edge(x, top)) || turns_sharply(x, top);
}

auto leap_row(const Eigen::VectorXd& joint, const Eigen::VectorXd& motor) -> std::optional<Index> {
  constexpr double kFurther = 4.0;  // than in any other row; chosen on no log
  constexpr double kStays = 0.5;    // of the leap
  constexpr Index kAround = 10;
  constexpr Index kEnds = 20;  // a twentieth of the log to either side, or there is too little for a log of its own
  const Index n = joint.size() - 1;
  const Eigen::VectorXd of_motor = motor.tail(n) - motor.head(n);
  const Eigen::VectorXd of_joint = joint.tail(n) - joint.head(n);
  const double motion = of_motor.squaredNorm();
  const double ratio = motion > 0.0 ? of_joint.dot(of_motor) / motion : 0.0;
  Eigen::VectorXd changes = (of_joint - ratio * of_motor).cwiseAbs();
  Index at = 0;
  const double leap = n > 0 ? changes.maxCoeff(&at) : 0.0;
  const Index end = std::max(kAround, n / kEnds);
  const bool motor_leaps = n > 0 && std::abs(of_motor[at]) > kFurther * quantile(of_motor.cwiseAbs(), 0.99);
  if (at < end || at + end >= n || motor_leaps) {
    return std::nullopt;
  }
  changes[at] = 0.0;
  const Eigen::VectorXd apart = joint - ratio * motor;
  const double stays = median(apart.segment(at + 1, kAround)) - median(apart.segment(at + 1 - kAround, kAround));
  return leap > kFurther * changes.maxCoeff() && std::abs(stays) > kStays * leap ? std::optional(at + 1) : std::nullopt;
}

auto steps_over_range(const Eigen::VectorXd& x) -> std::optional<double> {
  const double step = quantisation_step(x);
  return step > 0.0 ? std::optional(robust_range(x) / step) : std::nullopt;
}

}  // namespace capstan::tools
