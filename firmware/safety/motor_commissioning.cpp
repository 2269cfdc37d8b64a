// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/motor_commissioning.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <numeric>

#include "capstan/firmware/control/experiment.hpp"
#include "capstan/firmware/safety/motor_observer.hpp"

#ifdef __SOFTFP__

namespace capstan {

void MotorCommissioning::begin(const MotorConfig& /*motor*/, Q24 /*stiffness_nm_per_rad*/) {}
void MotorCommissioning::begin_dither() {}
auto MotorCommissioning::begin_fast_moves() -> const char* {
  return "this board has no floating point; commission the joint on another";
}
void MotorCommissioning::add(std::uint32_t /*tick*/, Q24 /*q1_rad*/, Q24 /*wanted_a*/, Q24 /*current_a*/) {}
auto MotorCommissioning::result() const -> Result {
  return {};
}

}  // namespace capstan

#else

namespace capstan {
namespace {

constexpr float kTwoPi = 6.2831853F;
constexpr float kPeriodS = 1.0F / kCycleRateHz;
constexpr float kOneRaw = 16777216.0F;  // 2^24

// Cycles without a count after which the motor stands: longer than a count takes at the slowest move.
constexpr std::int32_t kStandsCycles = 20;
constexpr std::int32_t kLeastStanding = 100;
// Of the envelope of the wanted current, as the observer has it.
constexpr int kTrailShift = 5;
constexpr std::int32_t kLeastBlocks = 20;
// A motor that goes on moves at least this many counts in a block.
constexpr std::int32_t kLeastCounts = 2;
// Of the inertia, one standard error: the observer's tests have a quarter and more to spare. The coarsest encoder of
// the simulated instruments (RAVEN, 4,000 counts a turn) leaves about 0.1.
constexpr float kMostError = 0.15F;
// Of the servo's stiffness: steps of 1.5, far finer than the two that half of the counts make. The joints of the
// campaign and 36 drawn ones (seeds 200000 to 200011, 201000 to 201023) took 0.7 to 8.5.
constexpr std::array<float, 8> kStiffnessLadder = {0.5F, 0.75F, 1.1F, 1.7F, 2.5F, 3.8F, 5.7F, 8.5F};
constexpr float kHelpedShare = static_cast<float>(MotorObserver::kHelpedShare8) / 8.0F;
// Of the wanted current. Twice what was found, and what nothing shows of it: 1/64.
constexpr float kLeastGainError = 1.0F / 64.0F;
constexpr float kGainErrors = 2.0F;
constexpr float kMostGainError = 0.5F;
constexpr float kMeanOfNoise = 0.8F;  // size of a white noise's mean sample, of its rms
// A sensor without noise still has steps.
constexpr float kLeastNoiseA = 1e-4F;

auto q24(float value) -> Q24 {
  return Q24::from_wide(static_cast<std::int64_t>(value * kOneRaw));
}

// The targets link no mathematics library, so what is needed of it is here.
/// cos of k twelfths of a turn.
constexpr std::array<float, 12> kCosines = {1.0F,  0.8660254F,  0.5F,  0.0F, -0.5F, -0.8660254F,
                                            -1.0F, -0.8660254F, -0.5F, 0.0F, 0.5F,  0.8660254F};
/// cos of half of each tone's angle in a cycle: 15 and 30 degrees.
constexpr std::array<float, 2> kHalfStepCosines = {0.9659258F, 0.8660254F};

/// exp(-i k 2 pi / 12)
auto turn_of(std::size_t k) -> std::complex<float> {
  return {kCosines[k % 12], kCosines[(k + 3) % 12]};
}
/// By Newton's rule from a guess within 4 %.
auto square_root(float value) -> float {
  if (!(value > 0.0F)) {
    return 0.0F;
  }
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);  // std::bit_cast would say the same, and clang 14's library lacks it
  bits = (bits >> 1U) + 0x1FBD1DF5U;
  float root = 0.0F;
  std::memcpy(&root, &bits, sizeof root);
  for (int i = 0; i < 3; ++i) {
    root = 0.5F * (root + value / root);
  }
  return root;
}
auto size_of(std::complex<float> number) -> float {
  return square_root(std::norm(number));
}

}  // namespace

void MotorCommissioning::begin(const MotorConfig& motor, Q24 stiffness_nm_per_rad) {
  *this = {};
  motor_ = motor;
  scale_ = EncoderScale(motor);
  const float per_count = static_cast<float>(stiffness_nm_per_rad.raw()) * kTwoPi /
                          static_cast<float>(std::max(motor.encoder_counts_per_turn, std::int32_t{1}));
  servo_per_count_ = per_count / static_cast<float>(std::max(motor.torque_per_current_nm_per_a.raw(), std::int32_t{1}));
}

void MotorCommissioning::begin_dither() {
  dither_ = true;
  counting_ = false;
  filled_ = 0;
}

void MotorCommissioning::add(std::uint32_t tick, Q24 q1_rad, Q24 wanted_a, Q24 current_a) {
  // In the encoder's own direction of positive torque.
  const std::int64_t counts = motor_.encoder_sign * scale_.counts_of(q1_rad);
  const bool follows = counting_ && tick == tick_ + 1;
  const auto moved = static_cast<std::int32_t>(std::clamp<std::int64_t>(counts - counts_, -100'000, 100'000));
  const std::int32_t before = wanted_;
  tick_ = tick;
  counts_ = counts;
  wanted_ = wanted_a.raw();
  if (!follows) {
    counting_ = true;
    answering_ = false;
    filled_ = 0;
    still_ = 0;
    return;
  }
  still_ = moved == 0 ? std::min(still_ + 1, kStandsCycles) : 0;
  if (dither_) {
    add_to_block(moved, current_a);
    return;
  }
  judge_stiffness(moved, before);
  judge_friction(moved, wanted_);
  judge_speed(moved);
  judge_current(before, current_a);
}

/// As MotorObserver::rt_watch_current: a current that was measured lies between the last two that were wanted.
void MotorCommissioning::judge_current(std::int32_t before, Q24 current_a) {
  const auto [least, most] = std::minmax(before, wanted_);
  const std::int64_t stray = (current_a.raw() - std::clamp(current_a.raw(), least, most)) >> 8;
  if (still_ == kStandsCycles) {
    squares_ += stray * stray;
    ++samples_;
  } else {
    strayed_ += std::abs(stray);
    driven_ += std::abs(std::int64_t{wanted_}) >> 8;
    ++moving_;
  }
}

auto MotorCommissioning::per_count(std::size_t place) const -> float {
  return servo_per_count_ * kStiffnessLadder[place];
}

void MotorCommissioning::Answered::follow(float wanted, float per_count, std::int32_t moved) {
  const float beyond = wanted - torque;
  if (moved != 0) {
    const float a_count = (moved > 0) == (beyond > 0.0F) ? per_count : per_count * kHelpedShare;
    const float most_now = a_count * static_cast<float>(std::abs(moved));
    torque += std::clamp(beyond, -most_now, most_now);
  }
  most = std::max({most, wanted - torque, torque - wanted});
}

/// As MotorObserver::rt_watch_stretch, at each stiffness of the ladder, with all counts and with half of them.
void MotorCommissioning::judge_stiffness(std::int32_t moved, std::int32_t wanted) {
  const float wanted_a = static_cast<float>(wanted) / kOneRaw;
  const std::int32_t half = (moved + odd_) >> 1;
  odd_ += moved - 2 * half;
  for (std::size_t i = 0; i < kStiffnesses; ++i) {
    if (!answering_) {
      stiffness_[i].whole.torque = stiffness_[i].half.torque = wanted_a;
    }
    stiffness_[i].whole.follow(wanted_a, per_count(i), moved);
    stiffness_[i].half.follow(wanted_a, per_count(i), half);
  }
  answering_ = true;
}

/// As the observer asks it, so that the margin of its thresholds is one to what a healthy joint does.
void MotorCommissioning::judge_friction(std::int32_t moved, std::int32_t wanted) {
  if (!confirmed_) {
    answered_ = confirmed_up_ = confirmed_down_ = wanted;
    confirmed_ = moved != 0;
    return;
  }
  unanswered_most_ = std::max(unanswered_most_, std::abs(wanted - answered_));
  if (moved > 0) {
    against_most_ = std::max(against_most_, confirmed_down_ - wanted);
    answered_ = confirmed_up_ = wanted;
    confirmed_down_ = std::max(confirmed_down_, wanted);
  } else if (moved < 0) {
    against_most_ = std::max(against_most_, wanted - confirmed_up_);
    answered_ = confirmed_down_ = wanted;
    confirmed_up_ = std::min(confirmed_up_, wanted);
  }
}

/// With the inertia: as MotorObserver::rt_watch_speed.
void MotorCommissioning::judge_speed(std::int32_t moved) {
  high_ = std::max(wanted_, high_ - ((high_ - wanted_) >> kTrailShift));
  low_ = std::min(wanted_, low_ + ((wanted_ - low_) >> kTrailShift));
  const std::int32_t slowed = moved_before_ >= 0 ? moved_before_ - moved : moved - moved_before_;
  if (moved_before_ != 0 && gain_ > 0.0F) {
    const float explained = gain_ * static_cast<float>(high_ - low_) / kOneRaw;
    slack_most_ = std::max(slack_most_, static_cast<float>(slowed) - explained);
  }
  moved_before_ = moved;
}

void MotorCommissioning::add_to_block(std::int32_t moved, Q24 current_a) {
  if (filled_ == kBlock) {  // the step after a block's last current bends its last angle, and begins the next block
    moved_[filled_] = moved;
    end_block();
    filled_ = 0;
  }
  first_tick_ = filled_ == 0 ? tick_ : first_tick_;
  moved_[filled_] = moved;
  current_a_[filled_++] = static_cast<float>(current_a.raw()) / kOneRaw;
}

void MotorCommissioning::end_block() {
  const auto [least, most] = std::minmax_element(moved_.begin(), moved_.end());
  const std::int32_t way = std::abs(std::accumulate(moved_.begin() + 1, moved_.end(), 0));
  if ((*least < 0 && *most > 0) || way < kLeastCounts) {
    return;  // it turned back, and friction with it
  }
  ++blocks_;
  for (std::size_t tone = 0; tone < kTones; ++tone) {
    std::complex<float> bend;
    for (std::size_t k = 0; k < kBlock; ++k) {
      const std::complex<float> turn = turn_of((tone + 1) * ((first_tick_ + k) % kBlock));
      bend += static_cast<float>(moved_[k + 1] - moved_[k]) * turn;
      tones_[tone].current += current_a_[k] * turn;
    }
    tones_[tone].bend += bend;
    tones_[tone].bend_squares += std::norm(bend);
  }
}

/// J - K / w^2, kg m2. A current that is held for a cycle bends the angle by cos(w T / 2) T^2 of its tone's
/// acceleration.
auto MotorCommissioning::apparent_inertia(std::size_t tone) const -> float {
  const float rad_per_count = kTwoPi / static_cast<float>(motor_.encoder_counts_per_turn);
  const float counts_per_a = size_of(tones_[tone].bend) / std::max(size_of(tones_[tone].current), 1e-12F);
  const float rad_s2_per_a = counts_per_a * rad_per_count / (kPeriodS * kPeriodS * kHalfStepCosines[tone]);
  return static_cast<float>(motor_.torque_per_current_nm_per_a.raw()) / kOneRaw / std::max(rad_s2_per_a, 1e-12F);
}

/// Standard error of that.
auto MotorCommissioning::error_of(std::size_t tone) const -> float {
  const auto count = static_cast<float>(blocks_);
  const float mean = std::norm(tones_[tone].bend) / count;
  const float scatter = std::max(tones_[tone].bend_squares - mean, 0.0F);
  return mean > 0.0F ? square_root(scatter / (count * mean)) * apparent_inertia(tone)
                     : std::numeric_limits<float>::infinity();
}

auto MotorCommissioning::identify_inertia() -> const char* {
  if (blocks_ < kLeastBlocks) {
    return "the motor did not go one way while it was shaken, so its inertia does not show; give a smaller 'dither='";
  }
  if ((tones_[0].bend * std::conj(tones_[0].current)).real() <= 0.0F) {
    return "the encoder counts against the torque; correct motor.encoder_sign, or swap the motor's wires";
  }
  const float spring = 4.0F / 3.0F * (apparent_inertia(1) - apparent_inertia(0));
  const float inertia = apparent_inertia(0) + std::max(spring, 0.0F);
  const float error = spring <= 0.0F ? error_of(0) : size_of({4.0F / 3.0F * error_of(1), 1.0F / 3.0F * error_of(0)});
  if (!(error < kMostError * inertia)) {
    return "the encoder does not show the motor's answer well enough for its inertia; give a larger 'dither=' or "
           "'amplitude=', or use a finer encoder";
  }
  found_.values.inertia_gm2 = q24(1000.0F * inertia);
  found_.inertia_error = error / inertia;
  const float constant = static_cast<float>(motor_.torque_per_current_nm_per_a.raw()) / kOneRaw;
  gain_ = static_cast<float>(motor_.encoder_counts_per_turn) / kTwoPi * constant / inertia * kPeriodS * kPeriodS;
  return nullptr;
}

auto MotorCommissioning::begin_fast_moves() -> const char* {
  dither_ = false;
  counting_ = false;
  confirmed_ = false;
  answering_ = false;
  moved_before_ = high_ = low_ = 0;
  return identify_inertia();
}

auto MotorCommissioning::result() const -> Result {
  Result found = found_;
  if (samples_ < kLeastStanding) {
    found.problem = "the motor never stood still, so the current's noise is not known; take away what shakes the joint";
  }
  const auto torque = [this](std::int32_t current) {  // never 0, which would be none
    return Q24::from_raw(1) + Q24::from_raw(current) * motor_.torque_per_current_nm_per_a;
  };
  found.values.coulomb_nm = torque(unanswered_most_ / 2);
  found.values.against_nm = torque(against_most_);
  found.values.slack_counts = q24(std::min(slack_most_, 100.0F));
  const auto tells = [](const Stiffness& one) { return one.half.most / std::max(one.whole.most, 1e-6F); };
  const auto best = std::max_element(stiffness_.begin(), stiffness_.end(),
                                     [&](const Stiffness& a, const Stiffness& b) { return tells(a) < tells(b); });
  const float constant = static_cast<float>(motor_.torque_per_current_nm_per_a.raw()) / kOneRaw;
  if (servo_per_count_ > 0.0F) {
    const float per_rad = static_cast<float>(motor_.encoder_counts_per_turn) / kTwoPi * constant;
    found.values.stiffness_nm_per_rad =
        q24(std::min(per_count(static_cast<std::size_t>(best - stiffness_.begin())) * per_rad, 100.0F));
    found.values.excess_nm = q24(best->whole.most * constant);
  }
  const float squares = static_cast<float>(squares_) / static_cast<float>(std::max<std::int32_t>(samples_, 1));
  const float noise = square_root(squares);
  found.values.noise_a = q24(std::max(noise * 256.0F / kOneRaw, kLeastNoiseA));
  const float strayed = static_cast<float>(strayed_) - kMeanOfNoise * noise * static_cast<float>(moving_);
  const float share = std::max(strayed, 0.0F) / static_cast<float>(std::max<std::int64_t>(driven_, 1));
  found.values.gain_error = q24(std::min(kLeastGainError + kGainErrors * share, kMostGainError));
  return found;
}

}  // namespace capstan

#endif
