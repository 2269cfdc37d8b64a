// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/motor_observer.hpp"

#include <algorithm>
#include <cstdlib>

namespace capstan {
namespace {

// Or of the speed, eighths, for a tip that hits something: on tendons of K its motor of J loses K / J t^2 / 2 of it in
// t. Seed 270341 lost 0.31 in two cycles against two; half of the counts are half of it in one.
constexpr std::int32_t kHitShare8 = 3;
// Of the torque with which the motor turned round, eighths: friction along a tendon is a share of its tension, and
// commissioning is without load. Of the same joints those that turned round from 2 to 2.5 A left 0.28 to 0.32 of it;
// after the winding's heat limit took torque away 0.38 were left of 2.2 A (seeds 260382, 260065).
constexpr std::int32_t kLoadShare8 = 4;
// Of the torque of the last count, eighths, that may go without another before an impulse is counted: a joint that
// turns round under load lets its tendons go where their friction holds, so the first count takes a tenth to a sixth of
// it (RAVEN's drawn elbows 1159, 1303, 1310 of commission_test, whose count is 1.6 mrad and took 150 ms).
constexpr std::int32_t kUnloadShare8 = 1;
// Three cycles against three while the motor winds its tendons up: kQuantisation, or a share of the speed, sixteenths,
// and twice what the speed changed by of late, for a change that has begun goes on growing. Chosen in November 2026 on
// the campaign's joints and 160 drawn ones, five minutes each (seeds 420000 to 420079, 421000 to 421079): none came
// further than 0.83 of it; with 3/16 and 2.75 counts nine more cases are found, and one of those joints stops.
constexpr std::int32_t kWindingShare16 = 5;
constexpr std::int32_t kLately = 2;
constexpr std::uint32_t kExplainsCycles = 5;
// After a look, in which a healthy motor springs back from it.
constexpr std::int32_t kLookFades = 20;
// Longest wait of a look for a count, cycles: at the slew limit the largest `frozen` of the drawn elbows, 1.5 A, goes
// in 15.
constexpr std::int32_t kLookHeld = 24;
// Of `frozen`, eighths, that the torque may have gone on by between the last count and a look: the look alone is at 8
// of them after four cycles and at 10 after five, so a dead encoder is found in the same cycle. Without, the coarse
// counts of drawn elbows came one cycle late (4110 and 3633 of commission_test).
constexpr std::int32_t kLookBegins8 = 1;
// The envelope of the wanted current forgets with this shift: about 32 cycles.
constexpr int kTrailShift = 5;
// Two and a half of the longest half swings of a motor on its tendons (RAVEN's elbow: 20 ms).
constexpr std::int32_t kSpringingCycles = 50;
// Silence after which the encoder is asked: longer than three of the last intervals between counts.
constexpr std::int32_t kSilentCycles = 5;
constexpr std::int32_t kSilentIntervals = 3;
constexpr std::int32_t kMostInterval = 15;  // so a slow motor is asked within 50 cycles
constexpr std::int32_t kMostSilentCycles = 10'000;
/// Counts in a cycle: 98 rad/s and more with as many counts a turn as there may be, so that sums of six fit.
auto within_reach(std::int64_t counts) -> std::int32_t {
  constexpr std::int32_t kFar = 1 << 19;
  const auto low = static_cast<std::int32_t>(counts);
  return low == counts ? std::clamp<std::int32_t>(low, -kFar, kFar - 1) : counts > 0 ? kFar - 1 : -kFar;
}

}  // namespace

void MotorObserver::rt_arm() {
  answer_.rt_rest();
  confirmed_up_ = confirmed_down_ = answered_ = stretched_ = turned_ = slewed_ = given_ = 0;
  unanswered_ = look_ = held_ = 0;
  springing_ = moved_ == 0 ? 0 : kSpringingCycles;
  silent_ = kMostSilentCycles;
  interval_ = 0;
}

auto MotorObserver::rt_look() -> Q24 {
  if (look_ >= kLookCycles || scales_.gain == 0) {
    return Q24{};
  }
  // A look that no count has answered goes on until one comes: where the slew limit is slow, or the servo works against
  // it, its torque does not get as far as `frozen` in its own time, and a dead encoder passes.
  if (look_ == kLookCycles / 2 && silent_ > kLookCycles / 2 && held_ < kLookHeld) {
    ++held_;
  } else {
    ++look_;
    held_ = 0;
  }
  looking_ = kLookFades;
  const std::int32_t place = std::min(look_, kLookCycles - look_) + held_;
  const std::int32_t against = look_backward_ ? -place : place;
  return Q24::from_wide(std::int64_t{scales_.frozen / 2} * against);  // one and a half times `frozen` after six cycles
}

void MotorObserver::rt_remember(std::int32_t moved, std::int32_t wanted) {
  const std::int32_t way = moved + before_[0] + before_[1];
  ++now_;
  past_[now_ % kPast] = {moved, way, wanted, high_ - low_, lately_};
  before_ = {moved, before_[0], before_[1]};
}

auto MotorObserver::rt_watch_current(std::int32_t measured, std::int32_t wanted) -> FaultSet {
  const std::int32_t allowed = scales_.mismatch + (std::abs(wanted) >> kGainErrorBits) * scales_.gain_error;
  if (strayed_ == 0 && std::abs(measured - wanted) <= allowed) {
    return 0;
  }
  const auto [least, most] = std::minmax(wanted, wanted_);
  const std::int32_t beyond = measured - std::clamp(measured, least, most);
  strayed_ = std::clamp<std::int32_t>(strayed_ + (std::abs(beyond) >> 1) - (allowed >> 1), 0, scales_.charge);
  return strayed_ >= scales_.charge >> 1 ? bit(Fault::kCurrentMismatch) : 0;
}

/// What a look has stretched moves the motor as long as it fades: until then nothing of it is forgotten.
void MotorObserver::rt_trail(std::int32_t wanted) {
  if (looking_ > 0 && watching_) {
    high_ = std::max(wanted, high_);
    low_ = std::min(wanted, low_);
    return;
  }
  high_ = std::max(wanted, high_ - ((high_ - wanted) >> kTrailShift));
  low_ = std::min(wanted, low_ + ((wanted - low_) >> kTrailShift));
}

/// Two cycles against the two before. A fault makes the servo push, which explains a motor that gets faster and not one
/// that slows down; so of the torque since then only what it lost on the way counts beside the range of before. What a
/// load gave the motor of late it may take again, but for the count by which a steady speed shows as two.
auto MotorObserver::rt_slows_suddenly(std::int32_t moved, std::int32_t wanted) -> bool {
  const std::int32_t before = before_[1] + before_[2];
  const std::int32_t slower = before >= 0 ? before - moved_ - moved : moved_ + moved - before;
  given_ -= given_ >> kTrailShift;
  if (slower < -1) {
    const std::int64_t explained = std::int64_t{scales_.gain} * (high_ - low_) >> 21;
    given_ = static_cast<std::int32_t>(std::max<std::int64_t>(given_, -256 * (std::int64_t{slower} + 1) - explained));
  }
  if (slower * 256 <= scales_.sudden || before == 0) {
    return false;
  }
  const std::int32_t allowed = std::max(scales_.sudden, std::abs(before) * (kHitShare8 * 256 / 16)) + given_;
  if (slower * 256 <= allowed) {
    return false;
  }
  const auto [least, most] = std::minmax({wanted, past(1).wanted, past(2).wanted, past(3).wanted});
  const std::int32_t begun = past(4).wanted;
  const std::int32_t lost = before > 0 ? begun - least : most - begun;
  const std::int64_t range = std::int64_t{past(4).range} + std::max<std::int32_t>(lost, 0);
  return std::int64_t{slower} * 256 > (scales_.gain * range >> 21) + allowed;
}

/// Three cycles against the three before, where the torque goes with the motion and rises: the motor winds its tendons
/// up, and the torque that this takes explains no slowing down. What the speed changed by before that does.
auto MotorObserver::rt_slows_while_winding(std::int32_t moved, std::int32_t wanted) -> bool {
  const std::int32_t before = past(3).way;
  const std::int32_t after = moved + before_[0] + before_[1];
  const std::int32_t slower = before >= 0 ? before - after : after - before;
  lately_ = std::max(lately_ - (lately_ >> kTrailShift), (std::abs(slower) - 1) * 256);
  if (slower * 256 <= scales_.winding || before == 0 || looking_ > 0 || springing_ > 0) {
    return false;
  }
  const std::int32_t allowed =
      std::max(scales_.winding, std::abs(before) * (kWindingShare16 * 256 / 16)) + kLately * past(3).lately;
  if (slower * 256 <= allowed) {
    return false;
  }
  const auto with = [before](std::int32_t torque) { return before > 0 ? torque : -torque; };
  const std::int32_t begun = with(past(4).wanted);
  const std::int32_t rise = with(wanted) - begun;
  const std::int32_t rise_before = begun - with(past(8).wanted);
  return begun > 0 && rise > 0 && rise_before >= 0 && rise >= rise_before - rise;
}

/// Twice the torque's range of the last six cycles, the time that current and motor take to follow it, explains what
/// two cycles gain. What the motor gained already goes on: tendons that fling it back do so before they let it go.
/// @pre the motor moved faster than in the cycle before
auto MotorObserver::rt_is_let_go(std::int32_t moved, std::int32_t wanted) -> bool {
  const std::int32_t before = moved >= 0 ? before_[1] : -before_[1];
  const std::int32_t prior = moved >= 0 ? before_[2] : -before_[2];
  const std::int32_t known = std::max<std::int32_t>(before, 0) + std::max<std::int32_t>(2 * (before - prior), 0);
  const std::int32_t gained = (std::abs(moved) - known) * 256;
  const std::int32_t last = moved >= 0 ? before_[0] : -before_[0];
  if (gained <= scales_.gained || last <= before) {
    return false;  // a blow gives its speed in one cycle
  }
  std::int32_t least = wanted;
  std::int32_t most = wanted;
  for (std::uint32_t cycle = 1; cycle <= kExplainsCycles; ++cycle) {
    least = std::min(least, past(cycle).wanted);
    most = std::max(most, past(cycle).wanted);
  }
  return gained > (std::int64_t{scales_.gain} * (most - least) >> 22) + scales_.gained;
}

auto MotorObserver::rt_watch_speed(std::int32_t moved, std::int32_t wanted) -> FaultSet {
  const std::int32_t gained = moved_ >= 0 ? moved - moved_ : moved_ - moved;  // in the direction of motion
  const std::int32_t beyond = std::abs(gained) * 256 - scales_.slack;
  const bool unexplained = beyond > 0 && beyond > std::int64_t{scales_.gain} * (high_ - low_) >> 23;
  const bool lost = unexplained && ((gained < 0 && moved_ != 0) || rt_is_let_go(moved, wanted));
  if (!lost && !rt_slows_suddenly(moved, wanted) && !rt_slows_while_winding(moved, wanted)) {
    return 0;
  }
  return bit(moved == 0 ? Fault::kEncoderFrozen : Fault::kEncoderMotion);
}

/// The torque that the way answers for follows the wanted one, by so much a count: all of it in the counts' direction,
/// a share where a load helps the motor on. A step of torque, as the winding's heat makes one, counts as it would come
/// at its rate: no motor answers it in its own cycle.
auto MotorObserver::rt_watch_stretch(std::int32_t moved, std::int32_t wanted) -> FaultSet {
  slewed_ += std::clamp(wanted - slewed_, -scales_.slew, scales_.slew);
  if (moved != 0) {
    const std::int32_t beyond = slewed_ - stretched_;
    const std::int32_t a_count = (moved ^ beyond) >= 0 ? scales_.stretch : scales_.helped;
    const std::int32_t answers = a_count * std::min(std::abs(moved), scales_.most);
    stretched_ += std::clamp(beyond, -answers, answers);
  }
  if (looking_ > 0) {
    --looking_;
    return 0;
  }
  const std::int32_t left = std::abs(slewed_ - stretched_);
  const std::int32_t size = std::abs(stretched_);
  turned_ = left <= scales_.excess >> 1 ? size : std::max(turned_, size);
  if (left <= scales_.excess || scales_.excess == 0) {
    return 0;
  }
  return left > turned_ / 8 * kLoadShare8 + scales_.turn ? bit(Fault::kEncoderMotion) : 0;
}

/// A motor that turned slowly may have stopped, or its encoder.
void MotorObserver::rt_listen(std::int32_t moved) {
  if (moved != 0) {
    interval_ = silent_;
    silent_ = 0;
    return;
  }
  silent_ = std::min(silent_ + 1, kMostSilentCycles);
  if (silent_ == kSilentCycles + kSilentIntervals * std::min(interval_, kMostInterval) && look_ >= kLookCycles) {
    look_ = held_ = 0;
    look_backward_ = wanted_ > 0;
    // What the encoder confirmed before the silence was under another load.
    confirmed_up_ = std::max(confirmed_up_, wanted_);
    confirmed_down_ = std::min(confirmed_down_, wanted_);
    // Where the last count came in a look's swing, that swing's torque has gone since, and no load with it.
    if (swung_) {
      const std::int32_t left = std::abs(wanted_);
      answered_ = std::clamp(answered_, -left, left);
    }
  }
}

/// What a torque moves does not gain speed where that torque goes away, and what a load moves gains it slowly.
auto MotorObserver::rt_runs_away(std::int32_t moved, std::int32_t against) -> bool {
  const std::int32_t speed = std::abs(moved);
  const bool goes_on = (moved > 0) == forward_;
  if (against <= 0 || !goes_on) {
    slow_ = against <= 0 ? speed : 0;
  }
  if (against <= scales_.frozen / 4) {
    return false;
  }
  const std::int32_t in_all = speed - slow_;
  const std::int32_t lately = goes_on ? speed - std::abs(past(4).moved) : 0;
  if (against <= scales_.frozen) {
    return in_all > scales_.wild;
  }
  return in_all > scales_.runaway_most || (in_all > scales_.runaway && lately > scales_.runaway_lately);
}

auto MotorObserver::rt_watch_answer(std::int32_t moved, std::int32_t wanted) -> FaultSet {
  rt_listen(moved);
  if (moved == 0) {
    const std::int32_t further = wanted - answered_;
    if (std::abs(further) > scales_.frozen + (look_ < kLookCycles ? scales_.frozen / 8 * kLookBegins8 : 0)) {
      return bit(Fault::kEncoderFrozen);
    }
    const std::int32_t onward = forward_ ? further : -further;
    // A load that goes away does not turn the motor round at once.
    const bool unloads = (answered_ > 0) == (further < 0);
    const std::int32_t held = unloads ? std::abs(answered_) / 8 * kUnloadShare8 : 0;
    // A look that comes takes back what the torque went on by, and is the shorter test of the same.
    if (look_ == kLookCycles) {
      unanswered_ = std::clamp<std::int32_t>(unanswered_ + onward - scales_.rise - held, 0, scales_.impulse);
    }
    return unanswered_ == scales_.impulse ? bit(Fault::kEncoderFrozen) : 0;
  }
  const std::int32_t against = moved > 0 ? confirmed_down_ - wanted : wanted - confirmed_up_;
  const bool runs_away = rt_runs_away(moved, against);
  forward_ = moved > 0;
  answered_ = wanted;
  swung_ = looking_ > 0;
  unanswered_ = 0;
  confirmed_up_ = forward_ ? wanted : std::min(confirmed_up_, wanted);
  confirmed_down_ = forward_ ? std::max(confirmed_down_, wanted) : wanted;
  return runs_away || (against > scales_.against && std::abs(moved) > scales_.creep) ? bit(Fault::kEncoderMotion) : 0;
}

auto MotorObserver::rt_step(const MotorState& motor, Q24 drive_a, bool energised) -> FaultSet {
  if (scales_.gain == 0) {
    return 0;
  }
  const std::int32_t wanted = drive_a.raw() >> 1;
  FaultSet faults = rt_watch_current(motor.current_a.raw() >> 1, wanted);
  const std::int32_t moved = within_reach(motor.counts - counts_);
  counts_ = motor.counts;
  rt_trail(wanted);  // without torque too: what a torque of just now has stretched still pulls
  if (energised && watching_) {
    const FaultSet of_motion =
        rt_watch_speed(moved, wanted) | rt_watch_stretch(moved, wanted) | rt_watch_answer(moved, wanted);
    faults |= springing_ == 0 ? of_motion : of_motion & ~bit(Fault::kEncoderMotion);
    if (look_ == 1) {
      answer_.rt_begin(2 * wanted_, springing_ == 0 && std::abs(wanted_) <= scales_.frozen / 2);
    }
    if (answer_.waits() &&
        answer_.rt_step(moved, 2 * wanted, scales_.frozen / 8 * LookAnswer::kDead16, scales_.answer)) {
      faults |= bit(Fault::kEncoderMotion);
    }
    springing_ = std::max<std::int32_t>(springing_ - 1, 0);
  }
  if (watching_ && !energised) {
    for (Cycle& cycle : past_) {
      cycle.moved = cycle.way = 0;  // the operator may set the count to anything
    }
    before_ = {};
  }
  watching_ = energised;
  rt_remember(energised ? moved : 0, wanted);
  moved_ = moved;
  wanted_ = wanted;
  return faults;
}

}  // namespace capstan
