// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/monitors.hpp"

#include <utility>

namespace capstan {
namespace {

constexpr std::int32_t kOverCurrentCycles = 20;
constexpr std::int32_t kMismatchCycles = 50;
constexpr std::int32_t kFrozenCycles = 50;
constexpr std::int32_t kUndervoltageCycles = 10;  // a supply may dip when its motors start
constexpr Q24 kHalf = Q24::from_double(0.5);
constexpr Q24 kOverCurrentFactor = Q24::from_double(1.2);
// Crossing from one tendon to the other, and where it slips, a healthy motor is faster than its joint may be: within
// 8 ms by 2.7 times at most, of joints drawn as for the false alarms and of tuned ones (seeds 570001 to 581008, 28
// November 2026). That is half of what this and limits.fault_travel allow there.
constexpr Q24 kSpeedFactor = Q24::from_int(2);

auto cycles_in(Q24 duration_s) -> std::int32_t {
  return static_cast<std::int32_t>((static_cast<std::int64_t>(duration_s.raw()) * kCycleRateHz) >> Q24::kFrac);
}

/// Counts the cycles in which something holds without a break, up to a number; true when that is reached.
auto debounced(bool holds, std::int32_t& cycles, std::int32_t enough) -> bool {
  cycles = holds ? std::min(cycles + 1, enough) : 0;
  return cycles >= enough;
}

}  // namespace

auto Monitors::rt_watch_power(const LimitConfig& limits, const MotorState& motor, Q24 drive_a) -> FaultSet {
  FaultSet faults = 0;
  if (debounced(abs(motor.current_a) > limits.current_a * kOverCurrentFactor, cycles_over_current_,
                kOverCurrentCycles)) {
    faults |= bit(Fault::kOverCurrent);
  }
  // Without torque 0 was wanted, and then an amplifier that drives is a fault too.
  // Good cycles only take bad ones back, so a sensor that says anything is found too.
  const bool differs = abs(motor.current_a - drive_a) > limits.current_mismatch_a;
  cycles_mismatched_ = std::clamp<std::int32_t>(cycles_mismatched_ + (differs ? 1 : -1), 0, kMismatchCycles);
  if (cycles_mismatched_ == kMismatchCycles) {
    faults |= bit(Fault::kCurrentMismatch);
  }
  if (motor.supply_low || undervoltage_cycles_ > 0) {
    faults |= rt_supply_fault(motor.supply_low);
  }
  return faults;
}

/// Stays until as many good cycles have followed: a supply that flickers must not let arming pass in between.
auto Monitors::rt_supply_fault(bool low) -> FaultSet {
  undervoltage_cycles_ = std::clamp<std::int32_t>(undervoltage_cycles_ + (low ? 1 : -1), 0, kUndervoltageCycles);
  undervoltage_ = undervoltage_cycles_ == kUndervoltageCycles || (undervoltage_ && undervoltage_cycles_ > 0);
  return undervoltage_ ? bit(Fault::kSupplyLow) : 0;
}

auto Monitors::rt_watch_motion(const LimitConfig& limits, const MotorState& motor, const JointEstimate& estimate,
                               const JointReference& reference, bool begins) -> FaultSet {
  const bool of_motor = reference.mode == ControlMode::kMotor;
  const Q24 wanted = of_motor ? reference.q1_rad : reference.q2_rad;
  const Q24 there = of_motor ? motor.q1_rad : estimate.q2_rad;
  FaultSet faults = 0;
  const std::int32_t patience = cycles_in(limits.following_time_s) + 1;
  if (debounced(abs(wanted - there) > limits.following_error_rad, cycles_off_reference_, patience)) {
    faults |= bit(Fault::kFollowingError);
  }
  if (begins) {
    still_cycles_ = 0;
  }
  if (motor.counts != still_counts_ || still_cycles_ == 0) {
    still_counts_ = motor.counts;
    still_reference_ = wanted;
    still_cycles_ = 1;
  } else if (debounced(true, still_cycles_, kFrozenCycles) &&
             abs(wanted - there) - abs(still_reference_ - there) > limits.following_error_rad * kHalf) {
    // Further away, not only elsewhere: a joint that presses with all its current stands while its reference returns.
    faults |= bit(Fault::kEncoderFrozen);
  }
  return faults;
}

auto Monitors::rt_watch_speed(const LimitConfig& limits, Q24 q1_rad, Q24 beta, bool own) -> FaultSet {
  constexpr Q24 kTime = kSpeedFactor * Q24::from_double(static_cast<double>(kPaceCycles) / kCycleRateHz);
  cycles_of_own_ = own ? std::min(cycles_of_own_ + 1, kSettleCycles) : 0;
  const std::size_t place = std::exchange(paces_, (paces_ + 1) % kPaceCycles);
  const Q24 oldest = std::exchange(way_[place], q1_rad);
  if (cycles_of_own_ < kSettleCycles || place % 2 != 0) {  // a millisecond later is soon enough, for half of the cost
    return 0;
  }
  return abs((q1_rad - oldest) * beta) > limits.joint_speed_rad_s * kTime + limits.fault_travel_rad
             ? bit(Fault::kOverspeed)
             : 0;
}

void Monitors::rt_rest() {
  cycles_of_own_ = kSettleCycles - static_cast<std::int32_t>(kPaceCycles) - 1;  // nothing has stretched the tendons
  cycles_off_reference_ = 0;
  still_cycles_ = 0;
}

}  // namespace capstan
