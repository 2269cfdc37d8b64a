// SPDX-License-Identifier: Apache-2.0
#include "hal/sim/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "hal/sim/deterministic_math.hpp"

namespace capstan::sim {
namespace {

constexpr double kStepS = 0.001;

std::size_t steps(double seconds) {
  return static_cast<std::size_t>(std::floor(seconds / kStepS + 0.5));
}

// Through unsigned: wrap-around is what a counter does, and is defined there.
std::int32_t wrap(std::int64_t value) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(value));
}

}  // namespace

void FaultSchedule::add(const Fault& fault) {
  if (!(fault.time_s >= 0.0) || !(fault.duration_s >= 0.0) || !std::isfinite(fault.amount)) {
    throw std::invalid_argument(
        "fault: time and duration must not be negative and the amount finite; correct the schedule");
  }
  if (fault.kind == FaultKind::kDelayed && !(fault.amount >= 0.0 && fault.amount <= kLongestDelayS)) {
    throw std::invalid_argument("fault: a delay is 0 to 0.5 s; shorten `amount`");
  }
  const bool amplifier_kind = fault.kind == FaultKind::kOff || fault.kind == FaultKind::kStuck;
  if (fault.target == FaultTarget::kAmplifier && !amplifier_kind) {
    throw std::invalid_argument("fault: an amplifier can only be off or stuck; choose one of these");
  }
  faults_.push_back(fault);
}

bool FaultSchedule::active(const Fault& fault, double time_s) const {
  // Half a step of slack: times are multiples of 1 ms with rounding.
  const double since = time_s - fault.time_s + 0.5 * kStepS;
  return since >= 0.0 && (fault.duration_s == 0.0 || since < fault.duration_s);
}

void FaultSchedule::apply(double time_s, Readings& readings) {
  if (faults_.empty())
    return;
  if (history_.empty()) {
    history_.assign(steps(kLongestDelayS) + 1, readings);
    stuck_ = readings;
  }
  newest_ = (newest_ + 1) % history_.size();
  history_[newest_] = readings;
  bool encoder_stuck = false;
  bool current_stuck = false;
  for (const Fault& fault : faults_) {
    if (!active(fault, time_s))
      continue;
    encoder_stuck |= fault.target == FaultTarget::kEncoder && fault.kind == FaultKind::kStuck;
    current_stuck |= fault.target == FaultTarget::kCurrent && fault.kind == FaultKind::kStuck;
    apply_one(fault, readings);
  }
  if (!encoder_stuck)
    stuck_.encoder_counts = history_[newest_].encoder_counts;
  if (!current_stuck)
    stuck_.current_a = history_[newest_].current_a;
}

Readings FaultSchedule::faulty(const Fault& fault, const Readings& good) {
  switch (fault.kind) {
    case FaultKind::kOff:
      return {0, 0.0, false, false};
    case FaultKind::kStuck:
      return stuck_;
    case FaultKind::kGarbage:
      return {wrap(static_cast<std::int64_t>(random_.next() >> 1U)), random_.normal(), true, true};
    case FaultKind::kJump:
      return {wrap(std::int64_t{good.encoder_counts} + std::llround(std::clamp(fault.amount, -2.0e9, 2.0e9))),
              good.current_a + fault.amount, true, true};
    case FaultKind::kNan:
      return {std::numeric_limits<std::int32_t>::min(), std::numeric_limits<double>::quiet_NaN(), false, true};
    case FaultKind::kSign:
      return {wrap(-std::int64_t{good.encoder_counts}), -good.current_a, true, true};
    case FaultKind::kDelayed:
      break;
  }
  return history_[(newest_ + history_.size() - steps(fault.amount)) % history_.size()];
}

void FaultSchedule::apply_one(const Fault& fault, Readings& readings) {
  const Readings replaced = faulty(fault, readings);
  if (fault.target == FaultTarget::kEncoder) {
    readings.encoder_counts = replaced.encoder_counts;
    readings.encoder_ok = readings.encoder_ok && replaced.encoder_ok;
  } else if (fault.target == FaultTarget::kCurrent) {
    readings.current_a = replaced.current_a;
    readings.current_ok = readings.current_ok && replaced.current_ok;
  }
}

double FaultSchedule::filter_command(double time_s, double command_a, bool& enabled) {
  bool stuck = false;
  for (const Fault& fault : faults_) {
    if (fault.target != FaultTarget::kAmplifier || !active(fault, time_s))
      continue;
    if (fault.kind == FaultKind::kOff)
      enabled = false;
    stuck |= fault.kind == FaultKind::kStuck;
  }
  if (!stuck)
    stuck_command_a_ = enabled ? command_a : 0.0;
  if (stuck)
    enabled = true;
  return stuck_command_a_;
}

Encoder::Encoder(const PlantParameters& parameters)
    : effects_(parameters.effects),
      counts_per_rad_(parameters.encoder_counts_per_turn / (2.0 * std::numbers::pi)),
      start_counts_(parameters.encoder_start_counts) {}

std::int32_t Encoder::counts(double q1_rad, double time_s) const {
  double shown = q1_rad;
  if (effects_.angle_periodic_rad != 0.0) {
    const double angle = effects_.angle_periodic_per_turn * q1_rad + effects_.angle_periodic_phase_rad;
    shown += effects_.angle_periodic_rad * det_sin(angle);
  }
  if (time_s >= effects_.pulley_slip_at_s)
    shown += effects_.pulley_slip_rad;
  return wrap(static_cast<std::int64_t>(std::floor(start_counts_ + shown * counts_per_rad_)));
}

CurrentSensor::CurrentSensor(const PlantParameters& parameters, std::uint64_t seed)
    : offset_a_(parameters.current_offset_a),
      noise_a_(parameters.current_noise_a),
      step_a_(parameters.current_adc_step_a),
      full_scale_a_(parameters.current_full_scale_a),
      random_(seed) {}

double CurrentSensor::sample(double current_a) {
  const double seen = current_a + offset_a_ + noise_a_ * random_.normal();
  const double limited = std::clamp(seen, -full_scale_a_, full_scale_a_);
  return step_a_ > 0.0 ? std::floor(limited / step_a_ + 0.5) * step_a_ : limited;
}

Camera::Camera(const PlantParameters& parameters, std::uint64_t seed)
    : noise_rad_(parameters.camera_noise_rad),
      frame_period_s_(parameters.camera_rate_hz > 0.0 ? 1.0 / parameters.camera_rate_hz : 0.0),
      late_(steps(parameters.camera_delay_s + parameters.effects.transport_delay_s), 0.0),
      random_(seed) {}

double Camera::sample(double q2_rad) {
  if (clock_s_ + 1.0e-9 >= next_frame_s_) {
    held_rad_ = q2_rad + noise_rad_ * random_.normal();
    next_frame_s_ += frame_period_s_;
  }
  clock_s_ += kStepS;
  if (late_.empty())
    return held_rad_;
  const double oldest = late_[cursor_];
  late_[cursor_] = held_rad_;
  cursor_ = (cursor_ + 1) % late_.size();
  return oldest;
}

}  // namespace capstan::sim
