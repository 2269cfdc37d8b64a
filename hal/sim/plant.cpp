// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/plant.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "capstan/hal/sim/deterministic_math.hpp"

namespace capstan::sim {
namespace {

// Independent streams from one seed, so that turning one sensor's noise off leaves the others as they were.
std::uint64_t stream(std::uint64_t seed, std::uint64_t number) {
  Random mixer(seed ^ (number * 0xd1342543de82ef95U));
  return mixer.next();
}

const PlantParameters& checked(const PlantParameters& parameters) {
  validate(parameters);
  return parameters;
}

}  // namespace

Periphery::Periphery(const PlantParameters& parameters, std::uint64_t seed)
    : parameters_(checked(parameters)),
      faults_(stream(seed, 1)),
      encoder_(parameters),
      current_sensor_(parameters, stream(seed, 2)),
      late_q1_(parameters.sample_delay_s),
      late_current_(parameters.sample_delay_s),
      camera_(parameters, stream(seed, 3)),
      tip_noise_(stream(seed, 4)),
      thermometer_noise_(stream(seed, 5)),
      current_decay_(det_exp(-2.0 * std::numbers::pi * parameters.current_bandwidth_hz * kStepS /
                             static_cast<double>(parameters.substeps))),
      substep_s_(kStepS / static_cast<double>(parameters.substeps)) {}

void Periphery::begin(double current_command_a, bool enabled, Tendon& top, Tendon& bottom) {
  command_a_ = faults_.filter_command(truth_.time_s, current_command_a, enabled);
  enabled_ = enabled;
  if (faults_.snapped(truth_.time_s, true))
    top.snap();
  if (faults_.snapped(truth_.time_s, false))
    bottom.snap();
  apply_slow_effects(top, bottom);
}

Loads Periphery::powered(int substep, const DrivetrainState& before) {
  advance_current();
  return unpowered(substep, before);
}

Loads Periphery::unpowered(int substep, const DrivetrainState& before) const {
  return loads(truth_.time_s + static_cast<double>(substep) * substep_s_, before);
}

double Periphery::site_m() const {
  const Environment& e = parameters_.environment;
  return e.site_period_s > 0.0 ? e.site_m + e.site_step_m * std::floor(truth_.time_s / e.site_period_s) : e.site_m;
}

void Periphery::apply_slow_effects(Tendon& top, Tendon& bottom) {
  const Effects& e = parameters_.effects;
  const double now = truth_.time_s;
  if (e.creep_ratio > 0.0) {
    top.creep(kStepS);
    bottom.creep(kStepS);
  }
  if (e.thermal_growth_m != 0.0) {
    const double growth = e.thermal_growth_m * warmth(now);
    top.lengthen(growth - applied_growth_m_);
    applied_growth_m_ = growth;
  }
  if (e.pretension_change_n != applied_pretension_n_ && now >= e.pretension_change_at_s) {
    const double change = e.pretension_change_n - applied_pretension_n_;
    const double both = parameters_.stiffness_top_n_per_m + parameters_.stiffness_bottom_n_per_m;
    top.lengthen(-change / both);
    bottom.lengthen(-change / both);
    applied_pretension_n_ = e.pretension_change_n;
  }
  if (e.fraying_share > 0.0 && !frayed_ && now >= e.fraying_at_s) {
    top.weaken(1.0 - e.fraying_share);
    frayed_ = true;
  }
  if (e.wear_per_rad != 0.0 || e.sheath_bend_per_rad != 0.0) {
    const double bend = 1.0 + e.sheath_bend_per_rad * std::fabs(truth_.q2_rad);
    const double factor = std::max(0.0, (1.0 + e.wear_per_rad * travelled_rad_) * bend);
    top.set_eta(parameters_.eta_top * factor);
    bottom.set_eta(parameters_.eta_bottom * factor);
  }
}

void Periphery::advance_current() {
  if (!enabled_) {
    current_a_ = 0.0;
    return;
  }
  const double limit = parameters_.current_limit_a * faults_.supply(truth_.time_s);
  const double target = std::clamp(command_a_, -limit, limit);
  current_a_ = target + (current_a_ - target) * current_decay_;
}

double Periphery::second_rad(double time_s) const {
  const Effects& e = parameters_.effects;
  return e.axis_coupling_rad * det_sin(2.0 * std::numbers::pi * e.axis_coupling_hz * time_s);
}

Loads Periphery::loads(double time_s, const DrivetrainState& s) const {
  const Effects& e = parameters_.effects;
  Loads result;
  double constant = parameters_.torque_constant_nm_per_a;
  if (e.torque_fade != 0.0)
    constant *= 1.0 - e.torque_fade * (1.0 - det_exp(-time_s / e.torque_fade_time_s));
  result.motor_torque_nm = constant * current_a_;
  if (e.magnetic_detent_nm != 0.0) {
    result.motor_torque_nm -= e.magnetic_detent_nm * det_sin(e.magnetic_detent_per_turn * s.q1_rad);
  }
  if (e.offset_nm != 0.0)
    result.motor_torque_nm -= e.offset_nm;
  if (e.stribeck_nm != 0.0) {
    const double speed = s.q1_rate_rad_per_s / e.stribeck_rad_per_s;
    result.extra_motor_coulomb_nm = e.stribeck_nm * det_exp(-std::min(speed * speed, 100.0));
  }
  if (e.tremor_nm != 0.0)
    result.tip_torque_nm = e.tremor_nm * det_sin(2.0 * std::numbers::pi * e.tremor_hz * time_s);
  result.tip_torque_nm += faults_.tip_torque(time_s);
  if (e.sticky_spot_nm != 0.0) {
    const double distance = (s.q2_rad - e.sticky_spot_angle_rad) / e.sticky_spot_width_rad;
    result.extra_joint_coulomb_nm = e.sticky_spot_nm * det_exp(-std::min(distance * distance, 100.0));
  }
  if (e.axis_coupling_rad != 0.0)
    result.path_move_m = e.axis_coupling_radius_m * (second_rad(time_s) - second_rad(time_s - substep_s_));
  return result;
}

void Periphery::observe(const DrivetrainState& s) {
  travelled_rad_ += std::fabs(s.q1_rad - truth_.q1_rad);
  truth_.time_s = static_cast<double>(step_count_) * kStepS;
  ++step_count_;
  truth_.q1_rad = s.q1_rad;
  truth_.q2_rad = s.q2_rad;
  truth_.q1_rate_rad_per_s = s.q1_rate_rad_per_s;
  truth_.q2_rate_rad_per_s = s.q2_rate_rad_per_s;
  truth_.tau_in_nm = s.tau_in_nm;
  truth_.tau_out_nm = s.tau_out_nm;
  truth_.motor_torque_nm = loads(truth_.time_s, s).motor_torque_nm;
  truth_.current_a = current_a_;
  truth_.q2_camera_rad = faults_.filter_logged(FaultTarget::kCamera, truth_.time_s, camera_.sample(s.q2_rad));
  observe_tip(s);
  if (parameters_.warming_k > 0.0) {
    truth_.temperature_c = parameters_.ambient_c + parameters_.warming_k * warmth(truth_.time_s) +
                           parameters_.thermometer_noise_k * thermometer_noise_.normal();
  }
  if (parameters_.effects.axis_coupling_rad != 0.0)
    truth_.second_rad = second_rad(truth_.time_s);
  readings_ = Readings{.encoder_counts = encoder_.counts(late_q1_.sample(s.q1_rad), truth_.time_s),
                       .current_a = current_sensor_.sample(late_current_.sample(current_a_)),
                       .encoder_ok = true,
                       .current_ok = true};
  faults_.apply(truth_.time_s, readings_);
}

// A lock takes what the tendons give and the link does not need.
void Periphery::observe_tip(const DrivetrainState& s) {
  const Effects& e = parameters_.effects;
  Environment touched = parameters_.environment;
  touched.site_m = site_m();
  double torque = environment_torque(touched, s.q2_rad, s.q2_rate_rad_per_s).value;
  if (touched.kind == EnvironmentKind::kLocked) {
    torque = s.joint_torque_nm - e.gravity_torque_nm * det_sin(s.q2_rad + e.gravity_angle_rad) +
             loads(truth_.time_s, s).tip_torque_nm;
  }
  torque += stop_torque(parameters_, s.q2_rad).value;
  truth_.tip_force_n = torque / parameters_.tip_length_m;
  if (parameters_.tip_force_noise_n > 0.0)
    truth_.tip_force_n += parameters_.tip_force_noise_n * tip_noise_.normal();
  truth_.tip_force_n = faults_.filter_logged(FaultTarget::kTipForce, truth_.time_s, truth_.tip_force_n);
  truth_.tip_torque_nm = truth_.tip_force_n * parameters_.tip_length_m;
}

// How much of its warming the instrument has behind it.
double Periphery::warmth(double time_s) const {
  return 1.0 - det_exp(-time_s / parameters_.effects.thermal_time_s);
}

void require_number(double current_command_a) {
  if (!std::isfinite(current_command_a))
    throw std::runtime_error("the current command is not a number; the controller must limit its output");
}

Plant::Plant(const PlantParameters& parameters, std::uint64_t seed)
    : periphery_(parameters, seed), drivetrain_(parameters) {
  periphery_.observe(drivetrain_.state());
}

void Plant::step(double current_command_a, bool enabled) {
  require_number(current_command_a);
  divergence_.guard([&] {
    periphery_.begin(current_command_a, enabled, drivetrain_.top(), drivetrain_.bottom());
    drivetrain_.set_site(periphery_.site_m());
    const double dt = kStepS / static_cast<double>(parameters().substeps);
    for (int i = 1; i <= parameters().substeps; ++i)
      drivetrain_.advance(periphery_.powered(i, drivetrain_.state()), dt);
  });
  periphery_.observe(drivetrain_.state());
}

void Plant::step(std::span<const MotorCommand> commands) {
  if (commands.size() != axis_count())
    throw std::invalid_argument("there must be one command per axis; give as many as the instrument has");
  step(commands.front().current_a, commands.front().enabled);
}

void Plant::step_kinematic(double q1_rad) {
  if (!std::isfinite(q1_rad))
    throw std::runtime_error("the input angle is not a number; give an angle in rad");
  divergence_.guard([&] {
    periphery_.begin(0.0, false, drivetrain_.top(), drivetrain_.bottom());
    drivetrain_.set_site(periphery_.site_m());
    const double dt = kStepS / static_cast<double>(parameters().substeps);
    const double start = drivetrain_.state().q1_rad;
    for (int i = 1; i <= parameters().substeps; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(parameters().substeps);
      drivetrain_.advance_to(start + share * (q1_rad - start), periphery_.unpowered(i, drivetrain_.state()), dt);
    }
  });
  periphery_.observe(drivetrain_.state());
}

}  // namespace capstan::sim
