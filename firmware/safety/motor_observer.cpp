// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/motor_observer.hpp"

#include <algorithm>
#include <cstdlib>

namespace capstan {
namespace {

// Every threshold is a multiple of a commissioned value (`commission`), so the margin is one to what that very joint
// showed in 40 s. Chosen in November 2026 on the five joints of the fault campaign without faults, and on the drawn
// joints of `capstan faults --hours`, seeds 5000 to 5023, 9000 to 9023 and 40000 to 40035; the false alarms of
// docs/safety_concept.md are of other seeds.

// Counts. A smooth motion's second difference is quantised to at most 2; largest unexplained one seen: 1.9.
constexpr std::int32_t kQuantisation = 7 * 256 / 2;
// Of observer.slack, eighths.
constexpr std::int32_t kSlack8 = 14;
// Two cycles against two: quantised to at most 2 counts in all, like two single ones, so half of the speed shows from
// half of the speed on. Chosen in November 2026 on the campaign's joints (plant seed 3) and the drawn ones of seeds
// 200000 to 200011, 201000 to 201023 and 202000 to 202025: no healthy motion came further than 1.91 counts.
constexpr std::int32_t kSudden = 11 * 256 / 4;
constexpr std::int32_t kSuddenSlack8 = 9;
// Or of the speed, eighths, for a tip that hits something: on tendons of K its motor of J loses K / J t^2 / 2 of it in
// t. Seed 270341 lost 0.31 in two cycles against two; half of the counts are half of it in one.
constexpr std::int32_t kHitShare8 = 3;
// Of observer.excess, eighths. Chosen in November 2026 on some 87 drawn joints, five minutes each (of seeds 210000 to
// 210041 and 220000 to 220047): at most 1.06 times what commissioning saw, without the looks, is 0.85 of this. Half of
// the counts make 1.3 to 2.1 times of it, so this finds it on most joints and not on all.
constexpr std::int64_t kExcess8 = 10;
constexpr std::int32_t kExcessNoises = 4;
// And counts of the servo's stiffness, which a coarse encoder's torque goes up and down by.
constexpr std::int32_t kExcessCounts = 6;
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
// After a look, in which a healthy motor springs back from it.
constexpr std::int32_t kLookFades = 20;
// The envelope of the wanted current forgets with this shift: about 32 cycles.
constexpr int kTrailShift = 5;
// Of observer.coulomb, which is half of the largest torque that went unanswered in a healthy run: 2 are that, and 1
// more the margin.
constexpr std::int32_t kFrozenCoulombs8 = 24;  // eighths
constexpr std::int32_t kRiseCoulombs8 = 8;
// Of observer.against, eighths: 2 times was seen on the drawn joints of seeds 5000 to 5023 (tremor), 2.5 the threshold;
// and at least three times `frozen`: a look is half larger than that, and a motor springs back from it. With twice
// `frozen` 9 of 36 joints from seed 40000 stopped, so that limit decides what a wrong sign costs, see the document.
constexpr std::int64_t kAgainst8 = 20;
constexpr std::int64_t kAgainstFrozens = 3;
// A count that gains speed against the torque. Of limits.joint_speed: 1.2 times in all with once of it within four
// cycles, or 2.5 times in all. Chosen in November 2026 on the campaign's five joints and the drawn ones of seeds 81000
// to 81023, 81111, 90000 to 90045, 95000 to 95045, 100000 to 100046 and 105000 to 105045: no healthy motion came
// further than 0.54 of the one; of the other 0.58 is the most that was seen where it was noted (a tremor of 0.028 N m).
constexpr std::int32_t kRunawayShare = 12;  // tenths
constexpr std::int32_t kSuddenShare = 10;
constexpr std::int32_t kRunawayMostShare = 25;
// And, where the torque has little left to go by before it meets its limit, five times against a quarter of `frozen`.
constexpr std::int32_t kWildShare = 50;
constexpr std::int32_t kRunawayCounts = 2;  // a coarse encoder's counts come one by one
constexpr std::int32_t kFrozenNoises = 10;
constexpr std::int32_t kFrozenCounts = 6;
constexpr std::int32_t kRiseNoises = 4;
constexpr std::int32_t kRiseCounts = 2;
// Speed, as a share of limits.joint_speed, that an unanswered torque may give the motor: 3/8, in J dv.
constexpr std::int32_t kUnansweredShare8 = 3;
// A coarse encoder answers late: at least four cycles at twice what is allowed.
constexpr std::int64_t kLeastImpulse = 4;
// The same for a current that nobody wanted: 1/8.
constexpr std::int32_t kStrayShare8 = 1;
// White noise passes this CUSUM with a mean of -5 sigma a cycle: Wald's bound on one passing it from zero is
// exp(-2 * 5 * 10) a cycle, once in 1e32 years. What is left is offset and the amplifier's error, a sixteenth of the
// wish.
constexpr std::int32_t kMismatchNoises = 5;
constexpr std::int32_t kChargeNoises = 10;
constexpr int kGainErrorShift = 4;

// Two and a half of the longest half swings of a motor on its tendons (RAVEN's elbow: 20 ms).
constexpr std::int32_t kSpringingCycles = 50;
// Longest time in which a torque that rises as fast as it may goes unjudged.
constexpr std::int64_t kBlindCycles = 10;

// Silence after which the encoder is asked: longer than three of the last intervals between counts.
constexpr std::int32_t kSilentCycles = 5;
constexpr std::int32_t kSilentIntervals = 3;
constexpr std::int32_t kMostSilentCycles = 10'000;

constexpr std::int64_t kMost = std::int64_t{1} << 30;

auto limited(std::int64_t value) -> std::int32_t {
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(value, 0, kMost));
}
/// value * share / per, of raw numbers of one format
auto scaled(Q24 value, std::int64_t share, Q24 per) -> std::int64_t {
  return value.raw() * share / std::max<std::int64_t>(per.raw(), 1);
}
/// J dv, in A cycles raw: (g m2 / 1000) (rad/s) / (Nm/A) / 1 ms
auto impulse_of(const AxisConfig& config, Q24 speed_rad_s, std::int32_t share8) -> std::int64_t {
  const std::int64_t momentum = wide_product(config.observer.inertia_gm2.raw(), speed_rad_s.raw()) >> 24;
  return (momentum * share8 / 8 << 24) / std::max<std::int64_t>(config.motor.torque_per_current_nm_per_a.raw(), 1);
}

}  // namespace

MotorObserver::Scales::Scales(const AxisConfig& config) {
  const ObserverConfig& own = config.observer;
  const Q24 constant = config.motor.torque_per_current_nm_per_a;
  if (!commissioned(own) || constant <= Q24{}) {
    return;
  }
  // counts/256 = 256 cpr / (2 pi) * kt / J * (1 ms)^2, with J in g m2: 256 / (2 pi) / 1000 = 0.040744
  constexpr std::int64_t kPerTurn32 = 174'993'000;  // 0.0407437 * 2^32
  const std::int64_t per_turn = std::int64_t{config.motor.encoder_counts_per_turn} * kPerTurn32 >> 8;
  gain = std::max<std::int32_t>(
      1, limited((per_turn / std::max<std::int32_t>(own.inertia_gm2.raw(), 1)) * constant.raw() >> 24));
  slack = std::max(kQuantisation, limited(std::int64_t{own.slack_counts.raw()} * kSlack8 >> (24 - 8 + 3)));
  const std::int64_t friction = scaled(own.coulomb_nm, std::int64_t{1} << 24, constant);
  const std::int64_t noise = own.noise_a.raw();
  // One count of the servo's stiffness, which is the torque that may go to and fro between two counts.
  constexpr std::int64_t kTwoPi = Q24::from_double(6.283185307179586).raw();
  const std::int64_t count =
      scaled(config.control.stiffness_nm_per_rad, kTwoPi, constant) / config.motor.encoder_counts_per_turn;
  frozen = limited(friction * kFrozenCoulombs8 / 8 + kFrozenNoises * noise + kFrozenCounts * count);
  against = limited(std::max<std::int64_t>(std::int64_t{frozen} * kAgainstFrozens,
                                           scaled(own.against_nm, kAgainst8 << 21, constant)));
  rise = limited(friction * kRiseCoulombs8 / 8 + kRiseNoises * noise + kRiseCounts * count);
  impulse = limited(std::max(impulse_of(config, config.limits.joint_speed_rad_s, kUnansweredShare8),
                             std::int64_t{rise} * kLeastImpulse));
  mismatch = limited(kMismatchNoises * noise);
  charge = limited(std::max(impulse_of(config, config.limits.joint_speed_rad_s, kStrayShare8), kChargeNoises * noise));
  stretch = limited(scaled(own.stiffness_nm_per_rad, kTwoPi, constant) / config.motor.encoder_counts_per_turn);
  helped = stretch / 8 * kHelpedShare8;
  turn = limited(2 * friction);
  slew = slew_limit(config).raw();
  const std::int64_t largest = scaled(own.excess_nm, kExcess8 << 21, constant);
  excess = stretch == 0 || largest == 0 ? 0 : limited(largest + kExcessNoises * noise + kExcessCounts * count);
  sudden = std::max(kSudden, limited(std::int64_t{own.slack_counts.raw()} * kSuddenSlack8 >> (24 - 8 + 3)));
  winding = std::max(kQuantisation, sudden);
  answer = own.answer_gains != LookAnswer::mark(config.control)
               ? 0
               : limited((per_turn * 1000 >> 24) * own.answer_rad_per_a.raw() / 100 * LookAnswer::kLeastPercent >> 24);
  // counts/256 = 256 cpr / (2 pi) v / 1000
  fast = limited((per_turn >> 24) * config.limits.joint_speed_rad_s.raw() >> 24);
}

auto MotorObserver::slew_limit(const AxisConfig& config) -> Q24 {
  if (!commissioned(config.observer)) {
    return Q24::max();
  }
  // (J v / 2) / (2 cycles)^2, twice that on average
  const std::int64_t by_speed = impulse_of(config, config.limits.joint_speed_rad_s, 4) / 4;
  // A ramp of s a cycle moves J by s n^3 / 6 in n cycles.
  constexpr std::int64_t kRamp = 6 * kCycleRateHz / (kBlindCycles * kBlindCycles * kBlindCycles);
  const std::int64_t by_travel = kRamp * impulse_of(config, config.limits.fault_travel_rad, 8);
  return Q24::from_raw(std::max<std::int32_t>(1, limited(std::min(by_speed, by_travel))));
}

auto MotorObserver::check(const AxisConfig& config) -> const char* {
  const ObserverConfig& own = config.observer;
  if (own.inertia_gm2 < Q24{} || own.coulomb_nm < Q24{} || own.against_nm < Q24{} || own.noise_a < Q24{}) {
    return "an observer's value is negative; commission the joint";
  }
  if (commissioned(own) && (own.coulomb_nm == Q24{} || own.against_nm == Q24{} || own.noise_a == Q24{})) {
    return "observer.inertia is set, but observer.coulomb, observer.against or observer.noise is not: no motor is "
           "without "
           "friction or noise; commission the joint, or set observer.inertia to 0 too";
  }
  return nullptr;
}

void MotorObserver::rt_arm() {
  answer_.rt_rest();
  confirmed_up_ = confirmed_down_ = answered_ = stretched_ = turned_ = slewed_ = given_ = 0;
  unanswered_ = look_ = 0;
  springing_ = moved_ == 0 ? 0 : kSpringingCycles;
  silent_ = kMostSilentCycles;
  interval_ = 0;
}

auto MotorObserver::rt_look() -> Q24 {
  if (look_ >= kLookCycles || scales_.gain == 0) {
    return Q24{};
  }
  ++look_;
  looking_ = kLookFades;
  const std::int32_t place = std::min(look_, kLookCycles - look_);
  const std::int32_t against = look_backward_ ? -place : place;
  return Q24::from_raw(static_cast<std::int32_t>(std::int64_t{scales_.frozen} * against * 3 / kLookCycles));
}

auto MotorObserver::rt_step(const MotorState& motor, Q24 drive_a, bool energised) -> FaultSet {
  blow_ = false;
  if (scales_.gain == 0) {
    return 0;
  }
  FaultSet faults = rt_watch_current(motor.current_a.raw(), drive_a.raw());
  constexpr std::int64_t kFar = 1 << 20;
  const auto moved = static_cast<std::int32_t>(std::clamp<std::int64_t>(motor.counts - counts_, -kFar, kFar));
  counts_ = motor.counts;
  rt_trail(drive_a.raw());  // without torque too: what a torque of just now has stretched still pulls
  if (energised && watching_) {
    const FaultSet of_motion = rt_watch_speed(moved, drive_a.raw()) | rt_watch_stretch(moved, drive_a.raw()) |
                               rt_watch_answer(moved, drive_a.raw());
    faults |= springing_ == 0 ? of_motion : of_motion & ~bit(Fault::kEncoderMotion);
    if (look_ == 1) {
      answer_.rt_begin(wanted_, springing_ == 0 && std::abs(wanted_) <= scales_.frozen / 2);
    }
    faults |= answer_.rt_step(moved, drive_a.raw(), scales_.frozen / 16 * LookAnswer::kDead16, scales_.answer)
                  ? bit(Fault::kEncoderMotion)
                  : 0;
    springing_ = std::max<std::int32_t>(springing_ - 1, 0);
  }
  if (watching_ && !energised) {
    for (Cycle& cycle : past_) {
      cycle.moved = cycle.way = 0;  // the operator may set the count to anything
    }
  }
  watching_ = energised;
  rt_remember(energised ? moved : 0, drive_a.raw());
  moved_ = moved;
  wanted_ = drive_a.raw();
  return faults;
}

void MotorObserver::rt_remember(std::int32_t moved, std::int32_t wanted) {
  const std::int32_t way = moved + past(1).moved + past(2).moved;
  ++now_;
  past_[now_ % kPast] = {moved, way, wanted, limited(std::int64_t{high_} - low_), lately_};
}

auto MotorObserver::rt_watch_current(std::int32_t measured, std::int32_t wanted) -> FaultSet {
  const auto [least, most] = std::minmax(wanted, wanted_);
  const std::int64_t beyond = std::int64_t{measured} - std::clamp(measured, least, most);
  const std::int32_t allowed = scales_.mismatch + (std::abs(wanted) >> kGainErrorShift);
  strayed_ = static_cast<std::int32_t>(
      std::clamp<std::int64_t>(strayed_ + (std::abs(beyond) >> 1) - (allowed >> 1), 0, scales_.charge));
  return strayed_ >= scales_.charge >> 1 ? bit(Fault::kCurrentMismatch) : 0;
}

/// What a look has stretched moves the motor as long as it fades: until then nothing of it is forgotten.
void MotorObserver::rt_trail(std::int32_t wanted) {
  if (looking_ > 0 && watching_) {
    high_ = std::max(wanted, high_);
    low_ = std::min(wanted, low_);
    return;
  }
  high_ = std::max(wanted, high_ - static_cast<std::int32_t>((std::int64_t{high_} - wanted) >> kTrailShift));
  low_ = std::min(wanted, low_ + static_cast<std::int32_t>((std::int64_t{wanted} - low_) >> kTrailShift));
}

auto MotorObserver::rt_watch_speed(std::int32_t moved, std::int32_t wanted) -> FaultSet {
  const std::int32_t gained = moved_ >= 0 ? moved - moved_ : moved_ - moved;  // in the direction of motion
  const auto explained = static_cast<std::int32_t>(
      std::min<std::int64_t>(std::int64_t{scales_.gain} * (std::int64_t{high_} - low_) >> 24, kMost));
  const std::int32_t allowed = explained + scales_.slack;
  blow_ = gained * 256 > allowed;
  const bool slows = moved_ != 0 && -gained * 256 > allowed;
  const bool suddenly = rt_slows_suddenly(moved, wanted);
  const bool winding = rt_slows_while_winding(moved, wanted);
  if (!slows && !suddenly && !winding) {
    return 0;
  }
  return bit(moved == 0 ? Fault::kEncoderFrozen : Fault::kEncoderMotion);
}

/// Two cycles against the two before. A fault makes the servo push, which explains a motor that gets faster and not one
/// that slows down; so of the torque since then only what it lost on the way counts beside the range of before. What a
/// load gave the motor of late it may take again, but for the count by which a steady speed shows as two.
auto MotorObserver::rt_slows_suddenly(std::int32_t moved, std::int32_t wanted) -> bool {
  const std::int32_t before = past(2).moved + past(3).moved;
  const std::int32_t slower = before >= 0 ? before - moved_ - moved : moved_ + moved - before;
  given_ -= given_ >> kTrailShift;
  if (slower < -1) {
    const std::int64_t explained = scales_.gain * (std::int64_t{high_} - low_) >> 22;
    given_ = std::max(given_, limited(-256 * (std::int64_t{slower} + 1) - explained));
  }
  const std::int32_t allowed = std::max(scales_.sudden, std::abs(before) * (kHitShare8 * 256 / 16)) + given_;
  if (before == 0 || slower * 256 <= allowed) {
    return false;
  }
  const auto [least, most] = std::minmax({wanted, past(1).wanted, past(2).wanted, past(3).wanted});
  const std::int64_t begun = past(4).wanted;
  const std::int64_t lost = before > 0 ? begun - least : most - begun;
  const std::int64_t range = past(4).range + std::max<std::int64_t>(lost, 0);
  return std::int64_t{slower} * 256 > (scales_.gain * range >> 22) + allowed;
}

/// Three cycles against the three before, where the torque goes with the motion and rises: the motor winds its tendons
/// up, and the torque that this takes explains no slowing down. What the speed changed by before that does.
auto MotorObserver::rt_slows_while_winding(std::int32_t moved, std::int32_t wanted) -> bool {
  const std::int32_t before = past(3).way;
  const std::int32_t after = moved + past(1).moved + past(2).moved;
  const std::int32_t slower = before >= 0 ? before - after : after - before;
  lately_ = std::max(lately_ - (lately_ >> kTrailShift), (std::min<std::int32_t>(std::abs(slower), 1 << 20) - 1) * 256);
  const std::int32_t allowed =
      std::max(scales_.winding, std::abs(before) * (kWindingShare16 * 256 / 16)) + kLately * past(3).lately;
  if (before == 0 || slower * 256 <= allowed || looking_ > 0 || springing_ > 0) {
    return false;
  }
  const auto with = [before](std::int64_t torque) { return before > 0 ? torque : -torque; };
  const std::int64_t begun = with(past(4).wanted);
  const std::int64_t rise = with(wanted) - begun;
  const std::int64_t rise_before = begun - with(past(8).wanted);
  return begun > 0 && rise > 0 && rise_before >= 0 && 2 * rise >= rise_before;
}

/// The torque that the way answers for follows the wanted one, by so much a count: all of it in the counts' direction,
/// a share where a load helps the motor on. A step of torque, as the winding's heat makes one, counts as it would come
/// at its rate: no motor answers it in its own cycle.
auto MotorObserver::rt_watch_stretch(std::int32_t moved, std::int32_t wanted) -> FaultSet {
  const std::int64_t change = std::int64_t{wanted} - slewed_;
  slewed_ += static_cast<std::int32_t>(std::clamp<std::int64_t>(change, -scales_.slew, scales_.slew));
  if (moved != 0) {
    const std::int64_t beyond = std::int64_t{slewed_} - stretched_;
    const std::int32_t a_count = (moved > 0) == (beyond > 0) ? scales_.stretch : scales_.helped;
    const std::int64_t answers = std::int64_t{a_count} * std::abs(moved);
    stretched_ += static_cast<std::int32_t>(std::clamp(beyond, -answers, answers));
  }
  if (looking_ > 0) {
    --looking_;
    return 0;
  }
  const std::int64_t left = std::int64_t{slewed_} - stretched_;
  const std::int32_t size = std::abs(stretched_);
  turned_ = std::abs(left) <= scales_.excess >> 1 ? size : std::max(turned_, size);
  const std::int32_t allowed = std::max(scales_.excess, turned_ / 8 * kLoadShare8 + scales_.turn);
  return scales_.excess > 0 && std::abs(left) > allowed ? bit(Fault::kEncoderMotion) : 0;
}

/// A motor that turned slowly may have stopped, or its encoder.
void MotorObserver::rt_listen(std::int32_t moved) {
  if (moved != 0) {
    interval_ = silent_;
    silent_ = 0;
    return;
  }
  silent_ = std::min(silent_ + 1, kMostSilentCycles);
  if (silent_ == kSilentCycles + kSilentIntervals * interval_ && look_ >= kLookCycles) {
    look_ = 0;
    look_backward_ = wanted_ > 0;
    // What the encoder confirmed before the silence was under another load.
    confirmed_up_ = std::max(confirmed_up_, wanted_);
    confirmed_down_ = std::min(confirmed_down_, wanted_);
  }
}

/// What a torque moves does not gain speed where that torque goes away, and what a load moves gains it slowly.
auto MotorObserver::rt_runs_away(std::int32_t moved, std::int64_t against) -> bool {
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
  const auto beyond = [this](std::int32_t counts, std::int32_t share) {
    return counts >= kRunawayCounts && std::int64_t{counts} * 256 * 10 > std::int64_t{scales_.fast} * share;
  };
  if (against <= scales_.frozen) {
    return beyond(in_all, kWildShare);
  }
  return beyond(in_all, kRunawayMostShare) || (beyond(in_all, kRunawayShare) && beyond(lately, kSuddenShare));
}

auto MotorObserver::rt_watch_answer(std::int32_t moved, std::int32_t wanted) -> FaultSet {
  rt_listen(moved);
  const std::int64_t up = std::int64_t{wanted} - confirmed_up_;
  const std::int64_t down = std::int64_t{confirmed_down_} - wanted;
  if (moved == 0) {
    const std::int64_t further = std::int64_t{wanted} - answered_;
    const std::int64_t onward = forward_ ? further : -further;
    // A load that goes away does not turn the motor round at once.
    const bool unloads = (answered_ > 0) == (further < 0);
    const std::int32_t held = unloads ? std::abs(answered_) / 8 * kUnloadShare8 : 0;
    unanswered_ = static_cast<std::int32_t>(
        std::clamp<std::int64_t>(unanswered_ + onward - scales_.rise - held, 0, scales_.impulse));
    return std::abs(further) > scales_.frozen || unanswered_ == scales_.impulse ? bit(Fault::kEncoderFrozen) : 0;
  }
  const std::int64_t against = moved > 0 ? down : up;
  const bool runs_away = rt_runs_away(moved, against);
  forward_ = moved > 0;
  answered_ = wanted;
  unanswered_ = 0;
  confirmed_up_ = forward_ ? wanted : std::min(confirmed_up_, wanted);
  confirmed_down_ = forward_ ? std::max(confirmed_down_, wanted) : wanted;
  return runs_away || against > scales_.against ? bit(Fault::kEncoderMotion) : 0;
}

}  // namespace capstan
