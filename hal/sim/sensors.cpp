// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/hal/sim/deterministic_math.hpp"
#include "capstan/hal/sim/step.hpp"

namespace capstan::sim {

Late::Late(double delay_s) {
  const double whole = std::floor(delay_s / kStepS);
  share_ = delay_s / kStepS - whole;
  if (delay_s > 0.0)
    history_.assign(static_cast<std::size_t>(whole) + 2, 0.0);
}

double Late::sample(double value) {
  if (history_.empty())
    return value;
  newest_ = (newest_ + 1) % history_.size();
  history_[newest_] = value;
  const double oldest = history_[(newest_ + 1) % history_.size()];
  const double younger = history_[(newest_ + 2) % history_.size()];
  return younger + share_ * (oldest - younger);
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
  if (time_s >= effects_.pulley_slip_at_s) {
    const double every = effects_.pulley_slip_every_s;
    const double again = every > 0.0 ? std::floor((time_s - effects_.pulley_slip_at_s) / every) : 0.0;
    shown += (1.0 + again) * effects_.pulley_slip_rad;
  }
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
