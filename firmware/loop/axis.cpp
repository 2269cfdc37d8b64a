// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/loop/axis.hpp"

#include "capstan/firmware/safety/cautious_limits.hpp"

namespace capstan {
namespace {

/// Of a motor that is not there. Nobody asks for it but a law whose joint it would pull at, which is not this
/// machine's.
constexpr MotorState kAbsent = [] {
  MotorState motor;
  motor.faults = bit(Fault::kModelInvalid);
  return motor;
}();

auto same_law(const LawParameters<Q24>& a, const LawParameters<Q24>& b) -> bool {
  return a.coefficients == b.coefficients && a.shapes == b.shapes &&
         a.conditioner.direction_threshold_rad == b.conditioner.direction_threshold_rad &&
         a.conditioner.rate_time_constant_s == b.conditioner.rate_time_constant_s;
}

auto same_force_law(const ForceConfig& a, const ForceConfig& b) -> bool {
  return a.law == b.law && a.eta_top == b.eta_top && a.eta_bottom == b.eta_bottom &&
         a.pretension_nm == b.pretension_nm && a.ratio == b.ratio && a.pull_weight == b.pull_weight &&
         a.pull_push_weight == b.pull_push_weight && a.friction_nm == b.friction_nm && a.offset_nm == b.offset_nm &&
         a.grid.levels == b.grid.levels && a.grid.inputs == b.grid.inputs && a.grid.forces == b.grid.forces;
}

auto same_effort_law(const EffortConfig& a, const EffortConfig& b) -> bool {
  return a.law.coefficients == b.law.coefficients && a.law.shapes == b.law.shapes &&
         a.view.window_s == b.view.window_s && a.view.standstill_rad_s == b.view.standstill_rad_s &&
         a.view.letting_go_s == b.view.letting_go_s;
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
      given_limits_(config.limits),
      sensing_(config.motor),
      estimator_(config),
      effort_(config.effort),
      modes_(config_),
      gate_(config),
      observer_(config),
      limit_cycle_(config) {
  rt_expect_lost_motion();
}

void Axis::rt_configure(const AxisConfig& config) {
  const bool new_scale = !same_scale(config.motor, config_.motor);
  const bool new_law = new_scale || !same_law(config.law, config_.law);
  const bool new_force = new_scale || !same_force_law(config.force, config_.force);
  const bool new_effort = new_scale || !same_effort_law(config.effort, config_.effort);
  const bool new_monitor = new_law || !same_monitor(config, config_);
  config_ = config;
  given_limits_ = config.limits;
  rt_limit();
  sensing_.rt_configure(config_.motor);
  modes_.rt_configure(config_);
  gate_.rt_configure(config_);
  observer_.rt_configure(config_);
  limit_cycle_.rt_configure(config_);
  if (new_law) {
    estimator_.rt_make_law(config_.law);
  }
  rt_expect_lost_motion();
  if (new_force) {
    modes_.rt_make_force_law(config_.force);
  }
  if (new_effort) {
    effort_.rt_make_law(config_.effort);
  }
  if (new_monitor) {
    estimator_.rt_make_monitor(config_.monitor);
    telemetry_.misfit = telemetry_.tension = telemetry_.pretension_n = telemetry_.pretension_95_n = Q24{};
    telemetry_.warnings = 0;
    telemetry_.tendons = TendonHealth::kNothing;
  }
}

void Axis::rt_expect_lost_motion() {
  modes_.rt_expect_lost_motion(
      estimator_.law().lost_motion(config_.control.torque_backward_nm, config_.control.torque_forward_nm));
}

void Axis::rt_zero(Q24 q1_rad) {
  sensing_.rt_zero(q1_rad);
  estimator_.rt_forget();
  effort_.rt_forget();
}

auto Axis::rt_sense(const AxisSensed& sensed) -> const MotorState& {
  if (fitted()) {
    return sensing_.rt_step(config_, sensed);
  }
  effort_.rt_absent();
  static_cast<void>(sensing_.rt_absent());
  return kAbsent;
}

auto Axis::rt_estimate(const MotorState& motor, const LawInput& input) -> const JointEstimate& {
  if (!fitted()) {
    return estimator_.rt_absent();
  }
  const JointEstimate& estimate = estimator_.rt_step(config_, motor, input);
  effort_.rt_step(motor, input.measured.temperature);
  modes_.rt_observe(gate_.drive_nm(), estimate.valid);
  return estimate;
}

auto Axis::rt_command(const MotorState& motor, const JointEstimate& estimate, const Request& request) -> bool {
  dither_nm_ = request.dither_nm;
  return fitted() && (request.kind == Request::Kind::kNone || modes_.rt_command(view(motor, estimate), request));
}

auto Axis::rt_faults(const MotorState& motor, const JointEstimate& estimate, bool energised) -> FaultSet {
  if (!energised || !fitted()) {
    monitors_.rt_rest();
    limit_cycle_.rt_rest();
    modes_.rt_rest();
  }
  if (!fitted()) {
    return 0;
  }
  FaultSet faults = motor.faults | estimate.faults | gate_.faults() |
                    monitors_.rt_watch_power(config_.limits, motor, gate_.drive_a()) |
                    observer_.rt_step(motor, gate_.drive_a(), energised && motor.follows);
  if (energised) {
    const bool pushed = looked_ || dither_nm_ != Q24{} || modes_.in_torque();
    faults |= limit_cycle_.rt_step(motor, modes_.reference(), pushed);
    // What the winding's heat holds back does not go on with the reference, so no count has to answer it.
    const bool held_back = (gate_.limits() & bit(Limit::kThermal)) != 0;
    faults |= monitors_.rt_watch_speed(config_.limits, motor.q1_rad, estimator_.law().beta(), !pushed) |
              monitors_.rt_watch_motion(config_.limits, motor, estimate, modes_.reference(),
                                        modes_.rt_took_begin() || held_back) |
              (modes_.rt_stream_lost() ? bit(Fault::kLinkLost) : 0);
  }
  return faults;
}

/// Also after new parameters came under torque.
void Axis::rt_limit() {
  config_.limits =
      cautious_ && !MotorObserver::commissioned(config_.observer) ? cautious_limits(given_limits_) : given_limits_;
}

void Axis::rt_arm(const JointEstimate& estimate, bool cautious) {
  dither_nm_ = Q24{};
  if (cautious || cautious_) {
    cautious_ = cautious;
    rt_limit();
    gate_.rt_configure(config_);
  }
  modes_.rt_arm(estimate);
  gate_.rt_restart();
  observer_.rt_arm();
}

auto Axis::rt_reference(const MotorState& motor, const JointEstimate& estimate, bool energised)
    -> const JointReference& {
  if (energised && !motor.follows) {
    modes_.rt_arm(estimate);  // it stands where it is until there is torque
  }
  return energised ? modes_.rt_step(view(motor, estimate)) : modes_.rt_idle(motor);
}

auto Axis::rt_drive(const MotorState& motor, Q24 torque_nm, bool energised) -> AxisDrive {
  const bool driven = energised && fitted();
  dither_nm_ = driven ? dither_nm_ : Q24{};
  if (driven && !motor.follows) {
    observer_.rt_arm();
    AxisDrive waiting = gate_.rt_step(config_.limits, motor, Q24{}, false);
    waiting.enabled = true;
    return waiting;
  }
  const Q24 look_a = driven ? observer_.rt_look() : Q24{};
  looked_ = look_a != Q24{};
  return gate_.rt_step(config_.limits, motor, torque_nm, driven, dither_nm_, look_a);
}

void Axis::rt_report(const MotorState& motor, const JointEstimate& estimate, const JointEstimate* pitch,
                     FaultSet faults) {
  const JointReference& reference = modes_.reference();
  telemetry_.q1_rad = motor.q1_rad;
  telemetry_.tau_nm = motor.tau_nm;
  telemetry_.current_a = motor.current_a;
  telemetry_.q2_rad = estimate.q2_rad;
  telemetry_.q2_reported_rad = estimate.q2_reported_rad;
  telemetry_.q2_error_rad = estimate.error_bar_rad;
  telemetry_.estimate_valid = estimate.valid;
  telemetry_.q2_reference_rad = reference.q2_rad;
  telemetry_.q1_reference_rad = reference.q1_rad;
  telemetry_.joint_torque_reference_nm = reference.joint_torque_nm;
  telemetry_.mode = reference.mode;
  telemetry_.moving = reference.moving;
  telemetry_.drive_a = gate_.drive_a();
  telemetry_.drive_nm = gate_.drive_nm();
  telemetry_.excitation_nm = dither_nm_;
  telemetry_.limits = static_cast<LimitSet>(reference.limits | gate_.limits());
  telemetry_.faults = faults;
  // A law of forces was made for the torque; the tendons of the law of motion know it beside the angle.
  const ForceEstimate<Q24>& force = modes_.force().has_law() ? modes_.force().estimate() : estimate.joint_torque;
  telemetry_.joint_torque_nm = force.force;
  telemetry_.joint_torque_known = force.known && estimate.valid;
  telemetry_.joint_torque_phase = force.phase;
  const Q24 force_error_nm = force_error_.rt_step(config_.force.error, telemetry_.drive_nm, force);
  telemetry_.joint_torque_error_nm = estimate.valid ? force_error_nm : Q24::from_int(-1);
  telemetry_.law_torque_nm = effort_.estimate().law_nm;
  telemetry_.disturbance_nm = effort_.estimate().disturbance_nm;
  telemetry_.disturbance_known = effort_.estimate().known;
  telemetry_.look_counts = observer_.look_answer().counts();
  telemetry_.look_a = observer_.look_answer().beyond_a();
  telemetry_.looks = observer_.look_answer().number();
  telemetry_.misfit = estimator_.monitor().level();
  telemetry_.warnings = static_cast<WarningSet>(estimator_.monitor().warnings() | limit_cycle_.warnings());
  telemetry_.tension = estimator_.monitor().tendons().tension();
  telemetry_.pretension_n = estimator_.monitor().tendons().pretension_n();
  telemetry_.pretension_95_n = estimator_.monitor().tendons().pretension_95_n();
  telemetry_.tendons = estimator_.monitor().tendons().health();
  const bool has_tip = pitch != nullptr && pitch->valid && estimate.valid;
  telemetry_.tip_m = has_tip ? jaw_tip(config_.tip.links, pitch->q2_rad, estimate.q2_rad) : std::array<Q24, 3>{};
}

}  // namespace capstan
