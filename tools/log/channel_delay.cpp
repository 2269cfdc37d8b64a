// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/channel_delay.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/log/delay_law.hpp"
#include "capstan/tools/log/shift_fit.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kFewestRows = 400;
constexpr Index kFewestTurns = 8;
/// A motor whose acceleration takes away less than this share of the noise's squares has no inertia to speak of, and
/// needs no window that calms the acceleration.
constexpr double kInertia = 0.02;
/// From how many rows on a shift counts. Where a joint is seen, the torque is a tendon's, whose friction builds up on
/// the way, and a turn that is seen late lets it run ahead; and one that sticks at rest turns its torque before it
/// moves.
struct LeastShift {
  double behind, ahead;
};
/// These and what follows were chosen 2026-11-23 and 2026-11-26 on seeds 3000 to 3499 and 104000 to 104499 of
/// tools/channel_benchmark. What runs ahead is doubted more: friction that sticks at rest looks like it.
constexpr LeastShift kUsual = {0.5, 0.5};
constexpr LeastShift kOfTendonMotor = {0.7, 1.2};
/// From how many errors on, behind and ahead.
constexpr double kCertain = 2.3;
constexpr double kCertainAhead = 4.0;
/// Where every stroke is like the last, a law that lacks something lacks it everywhere alike, so leaving parts out
/// shows nothing of it (clean logs were accused at 1.5 to 6.6 errors), and a shift of many rows looks like other drag
/// and inertia.
constexpr double kCertainOfOneStroke = 7.0;
constexpr double kTurnErrors = 2.5;  // by which a turn may be off, of what the angle's steps let it be known to
constexpr double kFewestGain = 30.0;
/// Of what a delay of that size has to explain; a shift that makes up for something else explains less. 0.2 accuses two
/// more of the 1,000 clean logs and names two per cent more of the delays of 8 to 40 rows.
constexpr double kExplained = 0.3;
/// By how much the two laws' shifts may differ if both are the late motor angle's.
constexpr double kAlike = 0.3;

/// A shift by what it is known to.
struct Shift {
  double rows = 0.0, half = 0.0;
  [[nodiscard]] auto certainty() const -> double { return std::abs(rows) / half; }
};

auto believed(const std::optional<ShiftFit>& fit, const Turns& turns, const LeastShift& fewest)
    -> std::optional<Shift> {
  if (!fit) {
    return std::nullopt;
  }
  const double of_turns = kTurnErrors * turns.unsure / std::sqrt(static_cast<double>(turns.count));
  const Shift shift{fit->rows, std::hypot(fit->half, of_turns)};
  // Errors are those between parts of the log, and parts of a motion that is repeated lack the same: the recipe
  // `identify`, four times the same 15 s without a late channel, was accused at 3.4 errors.
  const double usual = (fit->rows > 0.0 ? kCertain : kCertainAhead) * std::sqrt(turns.repeats);
  const double certain = turns.spread < kAlikeStrokes ? kCertainOfOneStroke : std::min(usual, kCertainOfOneStroke);
  const double least = std::max(fit->rows > 0.0 ? fewest.behind : fewest.ahead, certain * shift.half);
  const bool good = std::abs(fit->rows) > least && fit->gain > std::max(kFewestGain, kExplained * fit->expected);
  return good ? std::optional(shift) : std::nullopt;
}

/// Up to half a mean stroke: farther, a motion looks like the one back.
auto behind_law(const LawChannels& channels, const VectorXd& target, const Turns& turns, Index window)
    -> std::optional<ShiftFit> {
  const Index half_stroke = target.size() / (2 * turns.count);
  const Index reach = turns.spread < kAlikeStrokes ? kShortReach : std::clamp(half_stroke, kShortReach, kLongReach);
  const LogParts parts = parts_of_log(target.size(), window, reach);
  if (parts.rows == 0) {
    return std::nullopt;
  }
  return shift_behind(delay_law(channels, turns, parts), cut(target, parts), parts);
}

auto effort_behind_motor(const DelayChannels& c, const Turns& turns, const DelayWindows& windows)
    -> std::optional<ShiftFit> {
  const LawChannels motor{c.q1, nullptr, c.period_s};
  const auto fit = behind_law(motor, *c.tau, turns, windows.acceleration);
  const bool inertia = fit && fit->first >= kInertia;
  return inertia || windows.speed >= windows.acceleration ? fit : behind_law(motor, *c.tau, turns, windows.speed);
}

/// A joint behind the motor's motion, its torque, and a gap of just the width that the joint shows. A late joint looks
/// like one with a wider gap, so if it is late behind that, the width is asked again of the joint as it would be in
/// time.
auto joint_behind_law(const DelayChannels& c, const Turns& turns, Index window) -> std::optional<ShiftFit> {
  constexpr int kMostTimes = 4;
  Index late = 0;
  for (int times = 1;; ++times) {
    const LawChannels law{c.q1, c.tau, c.period_s, own_play(*c.q1, *c.target, late)};
    const auto fit = behind_law(law, *c.target, turns, window);
    const Index now = fit ? std::max<Index>(0, std::lround(fit->rows)) : late;
    if (now == late || times == kMostTimes || !believed(fit, turns, kUsual)) {
      return fit;
    }
    late = now;
  }
}

auto late(LateChannel channel, const Shift& shift) -> ChannelDelay {
  const double rows = std::abs(shift.rows);
  return {channel, rows, rows - shift.half, rows + shift.half};
}

}  // namespace

auto delay_between(const DelayChannels& c) -> std::optional<ChannelDelay> {
  if (c.q1->size() < kFewestRows) {
    return std::nullopt;
  }
  const Turns turns = turns_of(*c.q1);
  if (turns.count < kFewestTurns) {
    return std::nullopt;
  }
  const DelayWindows windows = delay_windows(*c.q1, turns);
  std::optional<ShiftFit> of_motor;
  std::optional<Shift> effort;
  std::optional<Shift> target;
  if (c.tau != nullptr) {
    of_motor = effort_behind_motor(c, turns, windows);
    effort = believed(of_motor, turns, c.target == nullptr ? kUsual : kOfTendonMotor);
  }
  if (c.target != nullptr) {
    const auto of_joint = joint_behind_law(c, turns, windows.speed);
    target = believed(of_joint, turns, kUsual);
    // A late effort lets the joint run ahead of it; only then is the effort looked for with the joint's help.
    if (c.tau != nullptr && of_joint && of_joint->rows + of_joint->half < 0.0) {
      const auto by_all = behind_law({c.q1, c.target, c.period_s}, *c.tau, turns, windows.speed);
      const auto behind = believed(by_all, turns, kUsual);
      const bool better = behind && behind->rows > 0.0 && (!effort || behind->certainty() > effort->certainty());
      effort = better ? behind : effort;
    }
  }
  if (target && target->rows > 0.0 && (!effort || target->certainty() >= effort->certainty())) {
    return late(LateChannel::kTarget, *target);
  }
  if (effort) {
    return late(effort->rows > 0.0 ? LateChannel::kMotorEffort : LateChannel::kMotorAngle, *effort);
  }
  // A joint that leads is no late motor angle by itself: a turn that is seen late makes it lead, and so does creep.
  const bool both = target && target->rows < 0.0 && of_motor && of_motor->rows < 0.0 &&
                    std::abs(of_motor->rows - target->rows) < kAlike * std::abs(target->rows) + of_motor->half;
  return both ? std::optional(late(LateChannel::kMotorAngle, *target)) : std::nullopt;
}

}  // namespace capstan::tools
