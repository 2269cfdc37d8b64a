// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/long_rests.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/least_squares.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// A motor stands while its encoder goes to and fro by so many counts, or noises, or by this share of its range: a
/// motion that begins softly says something from there on. Counts that are a larger share than the last tell nothing.
constexpr double kCounts = 3.0;
constexpr double kNoises = 8.0;
constexpr double kShareOfMotor = 1e-4;
constexpr double kLargestShareOfMotor = 0.02;
/// Of the joint's range, whose sensor is noisier: torque moves a joint while its motor stands.
constexpr double kShareOfJoint = 0.05;
/// A joint creeps that goes by more noises, and by a larger share of its range, from the first to the last third of a
/// rest behind a motion: that rest tells something.
constexpr double kCreepNoises = 1.0;
constexpr double kCreepShare = 0.005;
/// A rest is long from this share of the motion on, and then cut down to the other one.
constexpr double kLong = 0.1;
constexpr double kKept = 0.05;
/// Places of a log at which a rest is looked for: several in each long one.
constexpr Eigen::Index kPlaces = 128;

/// Within what each angle of a log stands.
class Standing {
 public:
  explicit Standing(const AxisLog& log) {
    add_motor(log.q1_rad);
    for (const auto& other : log.others) {
      add_motor(other.q1_rad);
    }
    angles_.push_back({log.q2_rad, kShareOfJoint * range_of(log.q2_rad)});
  }

  /// The rows around one, from `first` on, in which every angle stays where it is there.
  [[nodiscard]] auto around(Eigen::Index row, Eigen::Index first) const -> RowRange {
    RowRange rest{first, angles_.front().values.size()};
    for (const auto& [values, enough] : angles_) {
      const auto moves = [here = values[row], enough = enough](double now) { return std::abs(now - here) > enough; };
      Eigen::Index before = row;
      while (before > rest.begin && !moves(values[before - 1])) {
        --before;
      }
      const auto* const end = values.data() + rest.end;
      rest = {before, std::find_if(values.data() + row, end, moves) - values.data()};
    }
    return rest;
  }

 private:
  struct Angle {
    const Eigen::VectorXd& values;
    double enough;
  };

  void add_motor(const Eigen::VectorXd& q1) {
    const double range = range_of(q1);
    const double still =
        std::max({kCounts * quantisation_step(q1), kNoises * white_noise_level(q1), kShareOfMotor * range});
    angles_.push_back({q1, std::min(still, kLargestShareOfMotor * range)});
  }

  std::vector<Angle> angles_;
};

auto creeps(const Eigen::VectorXd& q2, const RowRange& rest) -> bool {
  const Eigen::Index third = std::max<Eigen::Index>(1, rest.size() / 3);
  const double moved = q2.segment(rest.begin, third).mean() - q2.segment(rest.end - third, third).mean();
  return std::abs(moved) > std::max(kCreepNoises * white_noise_level(q2), kCreepShare * range_of(q2));
}

auto long_rests(const AxisLog& log) -> Blocks {
  Blocks rests;
  if (log.effort.size() > 0) {
    return rests;
  }
  const Standing standing(log);
  const Eigen::Index rows = log.samples();
  const auto is_long = [rows](const RowRange& rest) {
    return static_cast<double>(rest.size()) > kLong * static_cast<double>(rows - rest.size());
  };
  const Eigen::Index step = std::max<Eigen::Index>(1, rows / kPlaces);
  for (Eigen::Index row = 0; row < rows; row += step) {
    const RowRange rest = standing.around(row, rests.empty() ? 0 : rests.back().end);
    if (is_long(rest) && rest.size() < rows && (rest.begin == 0 || !creeps(log.q2_rad, rest))) {
      rests.push_back(rest);
      row = rest.end;
    }
  }
  return rests;
}

/// Of a log with so many, all outside of these blocks.
auto rows_outside(const Blocks& blocks, Eigen::Index rows) -> std::vector<Eigen::Index> {
  std::vector<Eigen::Index> outside;
  auto next = blocks.begin();
  for (Eigen::Index row = 0; row < rows; ++row) {
    next += next != blocks.end() && row == next->end ? 1 : 0;
    if (next == blocks.end() || row < next->begin) {
      outside.push_back(row);
    }
  }
  return outside;
}

}  // namespace

auto goes_by_time(const Diagnosis& d) -> bool {
  const auto drifts = [](const auto& round) {
    const std::string first = round.ranking.empty() ? "" : round.ranking.front().name;
    return first == "thermal_drift" || first == "wander";
  };
  return d.law.has("thermal_drift") || std::any_of(d.rounds.begin(), d.rounds.end(), drifts);
}

auto without_long_rests(AxisLog log) -> AxisLog {
  Blocks rests = long_rests(log);
  if (rests.empty()) {
    return log;
  }
  const Eigen::Index motion = log.samples() - rows_in(rests);
  const auto kept = static_cast<Eigen::Index>(kKept * static_cast<double>(motion));
  for (auto& rest : rests) {
    // The last rows of a first rest, and the first ones of any other: a filter begins there, or comes to its end.
    if (rest.begin == 0) {
      rest.end -= kept;
    } else {
      rest.begin += kept;
    }
  }
  const double still_s = static_cast<double>(rows_in(rests)) * log.period_s;
  const auto kept_rows = rows_outside(rests, log.samples());
  log = only_rows(std::move(log), kept_rows);
  log.warnings.push_back(log.name + ": nothing moves for " + rounded(still_s, 2) +
                         " s; these rows say nothing about the law and are not used");
  return log;
}

}  // namespace capstan::tools
