// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "capstan/firmware/loop/expect.hpp"
#include "capstan/firmware/parameters/config.hpp"

namespace capstan {

/// By how many counts a motor at rest answers a look (MotorObserver::rt_look): the way between its furthest two places
/// from the look's first cycle until it has sprung back, for the range of its torque beyond what friction takes.
/// Without a load that is the joint's own within a quarter, so an encoder that shows half answers too little in every
/// look.
class LookAnswer {
 public:
  /// Of a look and its springing back, cycles; its torque is over after kTorqueCycles.
  static constexpr std::int32_t kCycles = 22;
  static constexpr std::int32_t kTorqueCycles = 14;
  /// What friction takes of the range of torque, sixteenths of what passes for dead (MotorObserver's `frozen`).
  static constexpr std::int32_t kDead16 = 11;
  /// Of the commissioned answer, and how many in a row may be smaller. Chosen in November 2026 on the campaign's
  /// joints, on 160 drawn ones, five minutes each (seeds 420000 to 420079, 421000 to 421079: three in a row of healthy
  /// joints were never all below 0.71 of the usual answer, one was 0.44; half of the counts make 0.41 to 0.58 of it),
  /// and on 214 whose commissioned answer, found just after a motion, was 0.9 of the usual one (seeds 410000 to 410024,
  /// odd ones of 412001 to 412377): three in a row were never all below 0.77 of that, and 0.80 without one joint.
  static constexpr std::int64_t kLeastPercent = 70;
  static constexpr std::int32_t kInARow = 3;
  /// Counts: fewer are quantised too much to be commissioned.
  static constexpr std::int32_t kLeastCounts = 10;

  /// Of the gains that answer a look beside the motor, 24 bits. An answer is the motor's with its servo: gains that
  /// `tune` found left 0.76 to 1.15 of what the drawn gains had left, twice the stiffness with three times the damping
  /// 0.6 and more (14 drawn joints, seeds 700001 to 700016; half of the counts 0.4 to 0.6 of a gain's own answer).
  static constexpr auto mark(const ControlConfig& gains) -> std::int32_t {
    std::uint32_t hash = 2166136261U;  // FNV-1a, of words
    for (const Q24 gain : {gains.kp, gains.ki_per_s, gains.kd_s, gains.stiffness_nm_per_rad, gains.damping_nms_per_rad,
                           gains.rate_time_constant_s}) {
      hash = (hash ^ static_cast<std::uint32_t>(gain.raw())) * 16777619U;
    }
    return static_cast<std::int32_t>((hash >> 8) ^ (hash & 0xFF));
  }

  void rt_rest() { left_ = small_ = 0; }
  /// The first cycle of a look, before rt_step. @param wanted_a  the torque that it begins with, raw
  /// @param judged  the motor stood without a load
  void rt_begin(std::int32_t wanted_a, bool judged) {
    if (left_ == 0) {
      left_ = kCycles;
      judged_ = judged;
      place_ = furthest_ = nearest_ = 0;
      high_ = low_ = wanted_a;
    }
  }
  /// Whether a look or its springing back is under way.
  [[nodiscard]] auto waits() const -> bool { return left_ > 0; }
  /// One cycle of it. @pre waits()  @param dead_a  range of torque that friction takes, raw
  /// @param least  counts/256 for each A beyond; 0: nothing is too little
  /// @returns true where too many answers in a row were less than that
  auto rt_step(std::int32_t moved, std::int32_t wanted_a, std::int32_t dead_a, std::int32_t least) -> bool {
    CAPSTAN_EXPECT(waits());
    if (!judged_) {
      --left_;
      return false;
    }
    place_ += moved;  // of kCycles, which a cycle's largest motion lets fit
    furthest_ = std::max(furthest_, place_);
    nearest_ = std::min(nearest_, place_);
    if (left_ > kCycles - kTorqueCycles) {
      high_ = std::max(high_, wanted_a);
      low_ = std::min(low_, wanted_a);
    }
    if (--left_ > 0) {
      return false;
    }
    const std::int64_t beyond = std::int64_t{high_} - low_ - dead_a;
    if (beyond <= 0) {
      return false;
    }
    counts_ = furthest_ - nearest_;
    beyond_ = Q24::from_wide(beyond);
    ++number_;
    small_ = std::int64_t{counts_} << 32 < std::int64_t{least} * beyond_.raw() ? small_ + 1 : 0;
    return small_ >= kInARow;
  }
  /// The last one, counts, for so much torque, and how many there were; wraps.
  [[nodiscard]] auto counts() const -> std::int32_t { return counts_; }
  [[nodiscard]] auto beyond_a() const -> Q24 { return beyond_; }
  [[nodiscard]] auto number() const -> std::uint32_t { return number_; }

 private:
  std::int32_t left_ = 0;
  std::int32_t place_ = 0;
  std::int32_t furthest_ = 0;
  std::int32_t nearest_ = 0;
  std::int32_t high_ = 0;
  std::int32_t low_ = 0;
  std::int32_t small_ = 0;
  std::int32_t counts_ = 0;
  Q24 beyond_;
  std::uint32_t number_ = 0;
  bool judged_ = false;
};

}  // namespace capstan
