// SPDX-License-Identifier: Apache-2.0
#include "firmware/axis.hpp"

#include <memory>

namespace capstan {
namespace {

constexpr SamplePeriod<Q24> kPeriod{kCycleRateHz};
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

auto same_law(const LawParameters<Q24>& a, const LawParameters<Q24>& b) -> bool {
  return a.coefficients == b.coefficients && a.shapes == b.shapes &&
         a.conditioner.direction_threshold_rad == b.conditioner.direction_threshold_rad &&
         a.conditioner.rate_time_constant_s == b.conditioner.rate_time_constant_s;
}

auto same_force_law(const ForceConfig& a, const ForceConfig& b) -> bool {
  return a.law == b.law && a.eta_top == b.eta_top && a.eta_bottom == b.eta_bottom &&
         a.pretension_nm == b.pretension_nm && a.ratio == b.ratio && a.friction_nm == b.friction_nm &&
         a.offset_nm == b.offset_nm && a.grid.levels == b.grid.levels && a.grid.inputs == b.grid.inputs &&
         a.grid.forces == b.grid.forces;
}

auto same_monitor(const AxisConfig& a, const AxisConfig& b) -> bool {
  return a.monitor.joint_rms_rad == b.monitor.joint_rms_rad && a.monitor.torque_rms_nm == b.monitor.torque_rms_nm &&
         a.monitor.excess == b.monitor.excess && a.monitor.settle_rad == b.monitor.settle_rad &&
         a.control.torque_forward_nm == b.control.torque_forward_nm &&
         a.control.torque_backward_nm == b.control.torque_backward_nm;
}

// What turns counts and currents into the law's arguments; a change of it is a jump for the law's memory.
auto same_scale(const MotorConfig& a, const MotorConfig& b) -> bool {
  return a.encoder_counts_per_turn == b.encoder_counts_per_turn && a.encoder_sign == b.encoder_sign &&
         a.torque_per_current_nm_per_a == b.torque_per_current_nm_per_a && a.fitted == b.fitted;
}

}  // namespace

Axis::Axis(const AxisConfig& config)
    : config_(config),
      scales_(config),
      law_(kPeriod, config.law),
      controller_(config.control),
      force_(config_.force),
      monitor_(config.monitor) {
  trajectory_.rt_configure(config_.limits);
}

Axis::Scales::Scales(const AxisConfig& config)
    : encoder(config.motor),
      per_torque_constant(config.motor.torque_per_current_nm_per_a),
      per_continuous_current(config.limits.continuous_current_a),
      thermal_gain(kPeriod.filter_gain(config.limits.thermal_time_s)) {}

void Axis::rt_configure(const AxisConfig& config) {
  const bool new_scale = !same_scale(config.motor, config_.motor);
  const bool new_law = new_scale || !same_law(config.law, config_.law);
  const bool new_force = new_scale || !same_force_law(config.force, config_.force);
  const bool new_monitor = new_law || !same_monitor(config, config_);
  config_ = config;
  scales_ = Scales(config_);
  controller_.rt_configure(config_.control);
  trajectory_.rt_configure(config_.limits);
  if (new_law) {
    std::construct_at(&law_, kPeriod, config_.law);  // in place: too large to be made and then copied within a cycle
  }
  if (new_force) {
    force_.rt_configure(config_.force);
  }
  if (new_monitor) {
    monitor_.rt_configure(config_.monitor);
    telemetry_.misfit = Q24{};
    telemetry_.warnings = 0;
  }
}

void Axis::rt_zero(Q24 q1_rad) {
  counts_ = scales_.encoder.counts_of(q1_rad);
  counting_ = false;
  zeroed_ = true;
  lost_ = false;
  law_.restart();
}

void Axis::rt_count(const AxisSensed& sensed) {
  if (counting_) {
    // Unsigned difference: the counter may wrap between two cycles.
    const auto moved = static_cast<std::int32_t>(static_cast<std::uint32_t>(sensed.encoder_counts) -
                                                 static_cast<std::uint32_t>(last_counts_));
    const Q24 angle = scales_.encoder.angle_of(moved);
    lost_ |= abs(angle) > per_cycle(config_.motor.speed_limit_rad_s);
    counts_ = clamp<std::int64_t>(counts_ + moved, -kCountLimit, kCountLimit);
  } else {
    counts_ = zeroed_ ? counts_ : sensed.encoder_counts;
    counting_ = true;
  }
  last_counts_ = sensed.encoder_counts;
}

void Axis::rt_sense(const AxisSensed& sensed) {
  if (!fitted()) {
    telemetry_ = {};
    sensor_faults_ = 0;
    counting_ = false;
    return;
  }
  sensor_faults_ = quality_fault(sensed.encoder) | quality_fault(sensed.current);
  telemetry_.limits = 0;
  telemetry_.estimate_valid = false;
  if (sensed.encoder == Quality::kOk) {
    rt_count(sensed);
    telemetry_.q1_rad = scales_.encoder.angle_of(counts_);
  }
  if (lost_) {
    sensor_faults_ |= bit(Fault::kEncoderJump);
  }
  if (sensed.current == Quality::kOk) {
    telemetry_.current_a = sensed.current_a;
    telemetry_.tau_nm = sensed.current_a * config_.motor.torque_per_current_nm_per_a;
  }
  const Q24 least_v = config_.limits.supply_min_v;
  supply_low_ = least_v > Q24{} && (sensed.supply != Quality::kOk || sensed.supply_v < least_v);
  has_joint_ = sensed.joint == Quality::kOk;
  joint_rad_ = sensed.joint_rad;
}

void Axis::rt_estimate(const Axis* other, Q24 temperature_c) {
  if (!fitted() || sensor_faults_ != 0 || (other != nullptr && other->sensor_faults_ != 0)) {
    return;  // an estimate from an old value would be a guess; the fault is the sensor's own
  }
  Measured<Q24> now;
  now.q1 = telemetry_.q1_rad;
  now.tau = telemetry_.tau_nm;
  now.temperature = temperature_c;
  if (other != nullptr) {
    now.other_q1 = other->telemetry_.q1_rad;
    now.other_tau = other->telemetry_.tau_nm;
    now.other_forward = other->law_.sample().forward;
  }
  const Estimate<Q24> estimate = law_.update(now);
  telemetry_.q2_rad = estimate.q2;
  telemetry_.q2_reported_rad = estimate.q2_reported;
  telemetry_.estimate_valid = !estimate.saturated;
  if (estimate.saturated) {
    sensor_faults_ |= bit(Fault::kEstimatorRange);
    return;
  }
  if (monitor_.watches()) {
    rt_monitor();
  }
  if (force_.has_law()) {
    force_.rt_observe(telemetry_.drive_a * config_.motor.torque_per_current_nm_per_a);
    telemetry_.joint_torque_nm = force_.estimate().force;
    telemetry_.joint_torque_known = force_.estimate().known;
    telemetry_.joint_torque_phase = force_.estimate().phase;
  }
}

void Axis::rt_monitor() {
  const Sample<Q24>& sample = law_.sample();
  monitor_.rt_step(config_.monitor, config_.control,
                   {.q1_rad = sample.q1,
                    .q1_reversal_rad = sample.q1_reversal,
                    .tau_nm = sample.tau,
                    .forward = sample.forward,
                    .has_joint = has_joint_,
                    .joint_error_rad = joint_rad_ - telemetry_.q2_reported_rad});
  telemetry_.misfit = monitor_.level();
  telemetry_.warnings = monitor_.warnings();
}

}  // namespace capstan
