// SPDX-License-Identifier: Apache-2.0
// The motor observer's thresholds, from the commissioned values.
#include <algorithm>
#include <limits>

#include "capstan/firmware/safety/motor_observer.hpp"

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
// Speed that a load gives the motor within two cycles: of limits.joint_speed, eighths, and counts that a coarse encoder
// shows. Chosen in November 2026 on drawn forceps, fingers, elbows and wrists (seeds 930000 to 930023, 931000 to
// 931009, tuned 931500 to 931503) and the campaign's joints: healthy motion came to 0.73 of the one (a wrist with twice
// the usual friction; 0.91 on wrist 931503, which is stopped without this test too) and 2.7 counts of the other. A torn
// or loose tendon gives 1.1 to 5 times as much. Joints 220045, 260065 and 260382, flung back by their tendons, came to
// 1.1 to 1.5 of it until what a motor gains already was taken off.
constexpr std::int32_t kGainedShare8 = 5;
constexpr std::int32_t kGainedCounts = 17 * 256 / 4;
// Of observer.excess, eighths. Chosen in November 2026 on some 87 drawn joints, five minutes each (of seeds 210000 to
// 210041 and 220000 to 220047): at most 1.06 times what commissioning saw, without the looks, is 0.85 of this. Half of
// the counts make 1.3 to 2.1 times of it, so this finds it on most joints and not on all.
constexpr std::int64_t kExcess8 = 10;
constexpr std::int32_t kExcessNoises = 4;
// And counts of the servo's stiffness, which a coarse encoder's torque goes up and down by.
constexpr std::int32_t kExcessCounts = 6;
// Of observer.coulomb, which is half of the largest torque that went unanswered in a healthy run: 2 are that, and 1
// more the margin.
constexpr std::int32_t kFrozenCoulombs8 = 24;  // eighths
constexpr std::int32_t kRiseCoulombs8 = 8;
// Of observer.against, eighths: 2 times was seen on the drawn joints of seeds 5000 to 5023 (tremor), 2.5 the threshold;
// and at least three times `frozen`: a look is half larger than that, and a motor springs back from it. With twice
// `frozen` 9 of 36 joints from seed 40000 stopped, so that limit decides what a wrong sign costs, see the document.
constexpr std::int64_t kAgainst8 = 20;
constexpr std::int64_t kAgainstFrozens = 3;
// Of limits.joint_speed, eighths, below which counts may go on against the torque: a load that changes slowly (a
// wrist's pitch joint swings) takes the motor along at 0.03 to 0.13 rad/s, however far the torque has gone (956002,
// 970022, 970053). An encoder of the wrong sign makes a motor fast. Chosen in November 2026 on those; RAVEN's elbow
// counts slower than that anyway, so there every count is judged.
constexpr std::int32_t kCreepShare8 = 2;
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
// exp(-2 * 5 * 10) a cycle, once in 1e32 years.
constexpr std::int32_t kMismatchNoises = 5;
constexpr std::int32_t kChargeNoises = 10;
// Of the wanted current, where nobody measured by what the amplifier is off.
constexpr Q24 kUsualGainError = Q24::from_double(1.0 / 16.0);
// Longest time in which a torque that rises as fast as it may goes unjudged.
constexpr std::int64_t kBlindCycles = 10;
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
  const std::int64_t fits = std::numeric_limits<std::int64_t>::max() / constant.raw();  // what is more is limited
  const std::int64_t per_inertia = std::min(per_turn / std::max<std::int32_t>(own.inertia_gm2.raw(), 1), fits);
  gain = std::max<std::int32_t>(1, limited(per_inertia * constant.raw() >> 24));
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
  gain_error = (own.gain_error > Q24{} ? own.gain_error : kUsualGainError).raw() >> (24 - kGainErrorBits);
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
  const std::int64_t fast = limited((per_turn >> 24) * config.limits.joint_speed_rad_s.raw() >> 24);
  creep = limited(fast * kCreepShare8 / 2048);
  gained = std::max(kGainedCounts, limited(fast * kGainedShare8 / 8));
  const auto faster = [fast](std::int64_t share) {
    return std::max<std::int32_t>(kRunawayCounts - 1, limited(fast * share / 2560));
  };
  wild = faster(kWildShare);
  runaway_most = faster(kRunawayMostShare);
  runaway = faster(kRunawayShare);
  runaway_lately = faster(kSuddenShare);
  for (std::int32_t* current :
       {&frozen, &against, &rise, &impulse, &mismatch, &charge, &stretch, &helped, &turn, &slew, &excess}) {
    *current >>= 1;
  }
  slew = std::max<std::int32_t>(slew, 1);
  most = limited(kMost / std::max<std::int32_t>(stretch, 1));
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

}  // namespace capstan
