// SPDX-License-Identifier: Apache-2.0
// What an axis watches in every cycle, and the one gate that its outputs pass.
#include "firmware/axis.hpp"

namespace capstan {
namespace {

// A reference may have waited for one cycle before it was used, and torque goes within one: 100 ms in all.
constexpr std::int32_t kLinkTimeoutCycles = 98;
constexpr std::int32_t kOverCurrentCycles = 20;
constexpr std::int32_t kMismatchCycles = 50;
constexpr std::int32_t kFrozenCycles = 50;
constexpr std::int32_t kStarvedCycles = 10;  // a supply may dip when its motors start
// The gate brings the current down to the continuous one at a heat of 1, so more than noise above that is a current
// that the gate does not rule.
constexpr Q24 kTooHot = Q24::from_double(1.25);
constexpr Q24 kOne = Q24::from_int(1);
constexpr Q24 kHalf = Q24::from_double(0.5);
constexpr Q24 kOverCurrentFactor = Q24::from_double(1.2);
// Heat at which the peak current is allowed again. At the continuous current it stays at 1, so without a gap between
// the two the limit would come and go with the sensor's noise.
constexpr Q24 kCool = Q24::from_double(0.9);

auto cycles_in(Q24 duration_s) -> std::int32_t {
  return static_cast<std::int32_t>((static_cast<std::int64_t>(duration_s.raw()) * kCycleRateHz) >> Q24::kFrac);
}

/// Counts the cycles in which something holds without a break, up to a number; true when that is reached.
auto lasts(bool holds, std::int32_t& cycles, std::int32_t enough) -> bool {
  cycles = holds ? std::min(cycles + 1, enough) : 0;
  return cycles >= enough;
}

}  // namespace

auto Axis::rt_current_faults() -> FaultSet {
  const LimitConfig& limits = config_.limits;
  FaultSet faults = 0;
  if (lasts(abs(telemetry_.current_a) > limits.current_a * kOverCurrentFactor, cycles_over_current_,
            kOverCurrentCycles)) {
    faults |= bit(Fault::kOverCurrent);
  }
  // drive_a is what was wanted in the last cycle, and 0 without torque: then an amplifier that drives is a fault too.
  // Good cycles only take bad ones back, so a sensor that says anything is found too.
  const bool differs = abs(telemetry_.current_a - telemetry_.drive_a) > limits.current_mismatch_a;
  cycles_mismatched_ = std::clamp<std::int32_t>(cycles_mismatched_ + (differs ? 1 : -1), 0, kMismatchCycles);
  if (cycles_mismatched_ == kMismatchCycles) {
    faults |= bit(Fault::kCurrentMismatch);
  }
  if (heat_ > kTooHot) {
    faults |= bit(Fault::kWindingHot);
  }
  if (supply_low_ || cycles_starved_ > 0) {
    faults |= rt_supply_fault();
  }
  return faults;
}

/// Stays until as many good cycles have followed: a supply that flickers must not let arming pass in between.
auto Axis::rt_supply_fault() -> FaultSet {
  cycles_starved_ = std::clamp<std::int32_t>(cycles_starved_ + (supply_low_ ? 1 : -1), 0, kStarvedCycles);
  starved_ = cycles_starved_ == kStarvedCycles || (starved_ && cycles_starved_ > 0);
  return starved_ ? bit(Fault::kSupplyLow) : 0;
}

auto Axis::rt_motion_faults() -> FaultSet {
  const LimitConfig& limits = config_.limits;
  const Q24 reference = in_motor() ? telemetry_.q1_reference_rad : telemetry_.q2_reference_rad;
  const Q24 there = in_motor() ? telemetry_.q1_rad : telemetry_.q2_rad;
  FaultSet faults = 0;
  const std::int32_t patience = cycles_in(limits.following_time_s) + 1;
  if (lasts(abs(reference - there) > limits.following_error_rad, cycles_off_reference_, patience)) {
    faults |= bit(Fault::kFollowingError);
  }
  if (counts_ != still_counts_ || still_cycles_ == 0) {
    still_counts_ = counts_;
    still_reference_ = reference;
    still_cycles_ = 1;
  } else if (lasts(true, still_cycles_, kFrozenCycles) &&
             abs(reference - still_reference_) > limits.following_error_rad * kHalf) {
    faults |= bit(Fault::kEncoderFrozen);
  }
  if (following_ && ++cycles_since_reference_ > kLinkTimeoutCycles) {
    faults |= bit(Fault::kLinkLost);
  }
  return faults;
}

auto Axis::rt_faults(bool energised) -> FaultSet {
  telemetry_.faults = sensor_faults_ | (fitted() ? rt_current_faults() : 0);
  if (energised && fitted()) {
    telemetry_.faults |= rt_motion_faults();
  } else {
    cycles_off_reference_ = 0;
    still_cycles_ = 0;
    following_ = false;
    mode_ = ControlMode::kPosition;
  }
  return telemetry_.faults;
}

void Axis::rt_warm() {
  const Q24 load = telemetry_.current_a * scales_.per_continuous_current;
  heat_ += (load * load - heat_) * scales_.thermal_gain;
  hot_ = heat_ >= (hot_ ? kCool : kOne);
}

auto Axis::rt_outward(Q24 current_a) const -> bool {
  return (telemetry_.q1_rad >= config_.limits.motor_max_rad && current_a > Q24{}) ||
         (telemetry_.q1_rad <= config_.limits.motor_min_rad && current_a < Q24{});
}

auto Axis::rt_limit(Q24 torque_nm, bool energised) -> AxisDrive {
  const LimitConfig& limits = config_.limits;
  telemetry_.mode = mode_;
  if (!energised || in_torque()) {
    telemetry_.q1_reference_rad = telemetry_.q1_rad;
  } else if (!in_motor()) {
    telemetry_.q1_reference_rad = controller_.motor_reference();
  }
  telemetry_.moving = energised && in_motion();
  rt_warm();
  if (!energised || !fitted()) {
    last_drive_a_ = Q24{};
    telemetry_.drive_a = Q24{};
    return {};
  }
  Q24 wanted = torque_nm * scales_.per_torque_constant;
  // In motor space, because that is where tendons break: no torque further out than the travel allows.
  if (rt_outward(wanted)) {
    rt_flag(Limit::kMotorTravel);
    wanted = Q24{};
  }
  const Q24 peak = hot_ ? limits.continuous_current_a : limits.current_a;
  if (abs(wanted) > peak) {
    rt_flag(hot_ ? Limit::kThermal : Limit::kCurrent);
    wanted = clamp(wanted, -peak, peak);
  }
  const Q24 step = limits.current_rate_a_per_cycle;
  Q24 gated = clamp(wanted, last_drive_a_ - step, last_drive_a_ + step);
  if (gated != wanted) {
    rt_flag(Limit::kRate);
  }
  // The rate limit may delay a torque, never its removal.
  gated = rt_outward(gated) ? Q24{} : clamp(gated, -peak, peak);
  last_drive_a_ = gated;
  telemetry_.drive_a = gated;
  return {.current_a = gated, .enabled = true};
}

}  // namespace capstan
