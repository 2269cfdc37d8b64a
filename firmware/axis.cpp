// SPDX-License-Identifier: Apache-2.0
#include "firmware/axis.hpp"

#include <memory>

namespace capstan {
namespace {

constexpr SamplePeriod<Q24> kPeriod{kCycleRateHz};
// A reference may have waited for one cycle before it was used, and torque goes within one: 100 ms in all.
constexpr std::int32_t kLinkTimeoutCycles = 98;
constexpr std::int32_t kOverCurrentCycles = 20;
constexpr std::int32_t kMismatchCycles = 50;
constexpr std::int32_t kFrozenCycles = 50;
// The gate brings the current down to the continuous one at a heat of 1, so more than noise above that is a current
// that the gate does not rule.
constexpr Q24 kTooHot = Q24::from_double(1.25);
constexpr Q24 kOne = Q24::from_int(1);
constexpr Q24 kHalf = Q24::from_double(0.5);
constexpr Q24 kOverCurrentFactor = Q24::from_double(1.2);
// Heat at which the peak current is allowed again. At the continuous current it stays at 1, so without a gap between
// the two the limit would come and go with the sensor's noise.
constexpr Q24 kCool = Q24::from_double(0.9);
// Far beyond the +-20 turns that an angle can express.
constexpr std::int64_t kCountLimit = std::int64_t{1} << 34;

auto cycles_in(Q24 duration_s) -> std::int32_t {
  return static_cast<std::int32_t>((static_cast<std::int64_t>(duration_s.raw()) * kCycleRateHz) >> Q24::kFrac);
}

/// Counts the cycles in which something holds without a break, up to a number; true when that is reached.
auto lasts(bool holds, std::int32_t& cycles, std::int32_t enough) -> bool {
  cycles = holds ? std::min(cycles + 1, enough) : 0;
  return cycles >= enough;
}

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
      monitor_(config.monitor) {}

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
  return faults;
}

auto Axis::rt_motion_faults() -> FaultSet {
  const LimitConfig& limits = config_.limits;
  const Q24 reference = telemetry_.q2_reference_rad;
  FaultSet faults = 0;
  const std::int32_t patience = cycles_in(limits.following_time_s) + 1;
  if (lasts(abs(reference - telemetry_.q2_rad) > limits.following_error_rad, cycles_off_reference_, patience)) {
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

auto Axis::rt_command(const AxisCommand& command) -> bool {
  if (!fitted()) {
    return false;
  }
  const LimitConfig& limits = config_.limits;
  const bool takes_over = command.kind == AxisCommand::Kind::kStop || command.kind == AxisCommand::Kind::kMove ||
                          command.kind == AxisCommand::Kind::kFollow;
  if (in_torque() && takes_over) {
    rt_hold_here(Start::kKeepsTorque);
  }
  const bool inside = command.position_rad >= limits.joint_min_rad && command.position_rad <= limits.joint_max_rad;
  switch (command.kind) {
    case AxisCommand::Kind::kNone:
      return true;
    case AxisCommand::Kind::kZero:
      return false;
    case AxisCommand::Kind::kStop:
      trajectory_.rt_stop(limits);
      following_ = false;
      return true;
    case AxisCommand::Kind::kMove:
      if (!inside || command.speed_rad_s <= Q24{}) {
        return false;
      }
      following_ = false;
      trajectory_.rt_start(command.position_rad, std::min(command.speed_rad_s, limits.joint_speed_rad_s));
      return true;
    case AxisCommand::Kind::kFollow:
      follow_target_ = clamp(command.position_rad, limits.joint_min_rad, limits.joint_max_rad);
      if (!inside) {
        rt_flag(Limit::kReference);
      }
      following_ = true;
      cycles_since_reference_ = 0;
      return inside;
    case AxisCommand::Kind::kTorque:
      return rt_take_torque(command);
    case AxisCommand::Kind::kForce:
    case AxisCommand::Kind::kFollowForce:
      return rt_take_force(command);
  }
  return false;
}

auto Axis::rt_take_torque(const AxisCommand& command) -> bool {
  torque_target_nm_ = command.torque_nm;
  trailing_q2_ = in_torque() ? trailing_q2_ : telemetry_.q2_rad;
  mode_ = ControlMode::kTorque;
  following_ = true;
  cycles_since_reference_ = 0;
  return true;
}

auto Axis::rt_take_force(const AxisCommand& command) -> bool {
  if (!force_.has_law() || command.torque_rate_nm_s <= Q24{} || (!in_force() && in_motion())) {
    return false;
  }
  const Q24 most = config_.limits.joint_torque_nm;
  const bool inside = abs(command.joint_torque_nm) <= most;
  const bool streamed = command.kind == AxisCommand::Kind::kFollowForce;
  if (!inside && !streamed) {
    return false;
  }
  if (!inside) {
    rt_flag(Limit::kJointTorque);
  }
  if (!in_force()) {
    trailing_q2_ = telemetry_.q2_rad;
    mode_ = ControlMode::kForce;
    force_.rt_start(telemetry_.drive_a * config_.motor.torque_per_current_nm_per_a);
  }
  force_.rt_aim(clamp(command.joint_torque_nm, -most, most), command.torque_rate_nm_s);
  following_ = streamed;
  cycles_since_reference_ = 0;
  return inside;
}

void Axis::rt_hold_here(Start start) {
  trajectory_.rt_reset(telemetry_.q2_rad);
  telemetry_.q2_reference_rad = telemetry_.q2_rad;
  telemetry_.joint_torque_reference_nm = Q24{};
  following_ = false;
  mode_ = ControlMode::kPosition;
  start_ = start;
}

auto Axis::rt_take_over() -> Q24 {
  const std::optional<Q24> kept_nm = start_ == Start::kKeepsTorque
                                         ? std::optional(telemetry_.drive_a * config_.motor.torque_per_current_nm_per_a)
                                         : std::nullopt;
  start_ = Start::kNone;
  return controller_.rt_start(config_.control, law_, telemetry_.q2_rad, kept_nm);
}

void Axis::rt_arm() {
  rt_hold_here(Start::kSteady);
  last_drive_a_ = Q24{};
}

/// Too far, or faster than moves may be. By how far a low-pass lags, because a rate from counts is mostly noise.
auto Axis::rt_runs_away() -> bool {
  constexpr Q24 kTrailS = Q24::from_double(0.02);
  constexpr Q30 kTrailGain = kPeriod.filter_gain(kTrailS);
  const LimitConfig& limits = config_.limits;
  trailing_q2_ += (telemetry_.q2_rad - trailing_q2_) * kTrailGain;
  return telemetry_.q2_rad > limits.joint_max_rad || telemetry_.q2_rad < limits.joint_min_rad ||
         abs(telemetry_.q2_rad - trailing_q2_) > limits.joint_speed_rad_s * kTrailS;
}

auto Axis::rt_reference() -> Q24 {
  if (!following_) {
    return trajectory_.rt_step(config_.limits);
  }
  // A streamed reference may not run faster than moves may, so a wrong first value can not throw the joint.
  const Q24 step = per_cycle(config_.limits.joint_speed_rad_s);
  const Q24 last = telemetry_.q2_reference_rad;
  const Q24 next = clamp(follow_target_, last - step, last + step);
  if (next != follow_target_) {
    rt_flag(Limit::kReference);
  }
  trajectory_.rt_track(next);
  return next;
}

auto Axis::rt_control() -> Q24 {
  if (in_torque() && rt_runs_away()) {
    rt_flag(Limit::kReference);
    rt_hold_here(Start::kSteady);
  }
  if (in_torque()) {
    telemetry_.q2_reference_rad = telemetry_.q2_rad;  // nothing is asked of the position
    return in_force() ? rt_force() : torque_target_nm_;
  }
  if (start_ != Start::kNone) {
    return rt_take_over();
  }
  telemetry_.q2_reference_rad = rt_reference();
  return controller_.rt_update(config_, law_, telemetry_.q2_reference_rad, telemetry_.q2_rad);
}

auto Axis::rt_force() -> Q24 {
  const Q24 torque = force_.rt_update(config_.force);
  telemetry_.joint_torque_reference_nm = force_.wanted();
  if (force_.out_of_reach()) {
    rt_flag(Limit::kJointTorque);
  }
  return torque;
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
