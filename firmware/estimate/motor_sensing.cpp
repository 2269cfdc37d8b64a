// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/estimate/motor_sensing.hpp"

namespace capstan {
namespace {

// Far beyond the +-20 turns that an angle can express.
constexpr std::int64_t kCountLimit = std::int64_t{1} << 34;

auto quality_fault(Quality quality) -> FaultSet {
  switch (quality) {
    case Quality::kOk:
      return 0;
    case Quality::kInvalid:
      return bit(Fault::kSensorInvalid);
    case Quality::kMissing:
      break;
  }
  return bit(Fault::kSensorMissing);
}

}  // namespace

void MotorSensing::rt_zero(Q24 q1_rad) {
  state_.counts = scale_.counts_of(q1_rad);
  counting_ = false;
  zeroed_ = true;
  lost_ = false;
}

auto MotorSensing::rt_absent() -> const MotorState& {
  const std::int64_t counts = state_.counts;
  state_ = {};
  state_.counts = counts;
  rt_miss();
  return state_;
}

/// What turns before the next count is not seen; after a `zero` that stands for a place that may be left by then.
void MotorSensing::rt_miss() {
  counting_ = false;
  lost_ |= zeroed_;
}

void MotorSensing::rt_count(std::int32_t counts) {
  if (counting_) {
    // Unsigned difference: the counter may wrap between two cycles.
    const auto moved =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(counts) - static_cast<std::uint32_t>(last_counts_));
    lost_ |= abs(scale_.angle_of(moved)) > farthest_rad_;
    state_.counts = clamp<std::int64_t>(state_.counts + moved, -kCountLimit, kCountLimit);
  } else {
    state_.counts = zeroed_ ? state_.counts : counts;
    counting_ = true;
  }
  last_counts_ = counts;
}

auto MotorSensing::rt_step(const AxisConfig& config, const AxisSensed& sensed) -> const MotorState& {
  state_.faults = quality_fault(sensed.encoder) | quality_fault(sensed.current);
  if (sensed.encoder == Quality::kOk) {
    rt_count(sensed.encoder_counts);
    state_.q1_rad = scale_.angle_of(state_.counts);
  } else if (!counting_) {
    rt_miss();
  }
  if (lost_) {
    state_.faults |= bit(Fault::kEncoderJump);
  }
  if (sensed.current == Quality::kOk) {
    state_.current_a = sensed.current_a;
    state_.tau_nm = sensed.current_a * config.motor.torque_per_current_nm_per_a;
  }
  const Q24 least_v = config.limits.supply_min_v;
  state_.supply_low = least_v > Q24{} && (sensed.supply != Quality::kOk || sensed.supply_v < least_v);
  state_.follows = sensed.follows;
  state_.has_joint = sensed.joint == Quality::kOk;
  state_.joint_rad = sensed.joint_rad;
  return state_;
}

}  // namespace capstan
