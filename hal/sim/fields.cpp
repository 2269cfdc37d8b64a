// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/fields.hpp"

#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace capstan::sim {
namespace {

using P = PlantParameters;
using E = Effects;

constexpr double kHuge = 1.0e9;

constexpr std::array kPlantFields = std::to_array<Field<P>>({
    {"motor_inertia_kgm2", &P::motor_inertia_kgm2, 1.0e-10, 10.0},
    {"motor_viscous_nms_per_rad", &P::motor_viscous_nms_per_rad, 0.0, 100.0},
    {"motor_coulomb_nm", &P::motor_coulomb_nm, 0.0, 100.0},
    {"torque_constant_nm_per_a", &P::torque_constant_nm_per_a, 1.0e-6, 1.0e3},
    {"current_limit_a", &P::current_limit_a, 0.0, 1.0e3},
    {"current_bandwidth_hz", &P::current_bandwidth_hz, 1.0, 1.0e5},
    {"input_radius_m", &P::input_radius_m, 1.0e-5, 1.0},
    {"output_radius_m", &P::output_radius_m, 1.0e-5, 1.0},
    {"eta_top", &P::eta_top, 0.0, 10.0},
    {"eta_bottom", &P::eta_bottom, 0.0, 10.0},
    {"stiffness_top_n_per_m", &P::stiffness_top_n_per_m, 1.0, kHuge},
    {"stiffness_bottom_n_per_m", &P::stiffness_bottom_n_per_m, 1.0, kHuge},
    {"pretension_n", &P::pretension_n, 0.0, 1.0e5},
    {"joint_inertia_kgm2", &P::joint_inertia_kgm2, 1.0e-12, 10.0},
    {"joint_viscous_nms_per_rad", &P::joint_viscous_nms_per_rad, 0.0, 100.0},
    {"joint_coulomb_nm", &P::joint_coulomb_nm, 0.0, 100.0},
    {"stop_low_rad", &P::stop_low_rad, -1.0e3, 1.0e3},
    {"stop_high_rad", &P::stop_high_rad, -1.0e3, 1.0e3},
    {"stop_stiffness_nm_per_rad", &P::stop_stiffness_nm_per_rad, 0.0, 1.0e6},
    {"encoder_counts_per_turn", &P::encoder_counts_per_turn, 1.0, 1.0e8},
    {"encoder_start_counts", &P::encoder_start_counts, -2147483648.0, 2147483647.0},
    {"current_noise_a", &P::current_noise_a, 0.0, 100.0},
    {"current_offset_a", &P::current_offset_a, -100.0, 100.0},
    {"current_adc_step_a", &P::current_adc_step_a, 0.0, 10.0},
    {"current_full_scale_a", &P::current_full_scale_a, 1.0e-6, 1.0e4},
    {"sample_delay_s", &P::sample_delay_s, 0.0, 0.1},
    {"camera_noise_rad", &P::camera_noise_rad, 0.0, 1.0},
    {"camera_rate_hz", &P::camera_rate_hz, 0.0, 1000.0},
    {"camera_delay_s", &P::camera_delay_s, 0.0, 10.0},
    {"joint_sensor", &P::joint_sensor, 0.0, 1.0},
    {"tip_length_m", &P::tip_length_m, 1.0e-5, 10.0},
    {"tip_force_noise_n", &P::tip_force_noise_n, 0.0, 1.0e3},
    {"ambient_c", &P::ambient_c, -100.0, 200.0},
    {"warming_k", &P::warming_k, 0.0, 200.0},
    {"thermometer_noise_k", &P::thermometer_noise_k, 0.0, 10.0},
});

constexpr std::array kEnvironmentFields = std::to_array<Field<Environment>>({
    {"stiffness", &Environment::stiffness, 0.0, 1.0e6},
    {"damping", &Environment::damping, 0.0, 1.0e6},
    {"angle_rad", &Environment::angle_rad, -100.0, 100.0},
    {"layer_depth_rad", &Environment::layer_depth_rad, 0.0, 100.0},
    {"deep_stiffness", &Environment::deep_stiffness, 0.0, 1.0e6},
    {"inclusion_stiffness", &Environment::inclusion_stiffness, 0.0, 1.0e6},
    {"inclusion_depth_rad", &Environment::inclusion_depth_rad, 0.0, 100.0},
    {"inclusion_site_m", &Environment::inclusion_site_m, -10.0, 10.0},
    {"inclusion_width_m", &Environment::inclusion_width_m, 1.0e-6, 10.0},
    {"site_m", &Environment::site_m, -10.0, 10.0},
    {"site_step_m", &Environment::site_step_m, -10.0, 10.0},
    {"site_period_s", &Environment::site_period_s, 0.0, kHuge},
});

constexpr std::array kEffectFields = std::to_array<EffectField>({
    {"transmission_viscous", "forward_ns_per_m", &E::transmission_viscous_forward_ns_per_m, 0.0, 1.0e7, true},
    {"transmission_viscous", "backward_ns_per_m", &E::transmission_viscous_backward_ns_per_m, 0.0, 1.0e7, true},
    {"play", "half_width_rad", &E::play_half_width_rad, 0.0, 1.0, true},
    {"transport_delay", "delay_s", &E::transport_delay_s, 0.0, 10.0, true},
    {"pretension", "change_n", &E::pretension_change_n, -1.0e5, 1.0e5, true},
    {"pretension", "at_s", &E::pretension_change_at_s, 0.0, kHuge, false},
    {"gravity", "torque_nm", &E::gravity_torque_nm, -100.0, 100.0, true},
    {"gravity", "angle_rad", &E::gravity_angle_rad, -10.0, 10.0, false},
    {"viscoelastic_creep", "ratio", &E::creep_ratio, 0.0, 10.0, true},
    {"viscoelastic_creep", "time_s", &E::creep_time_s, 0.01, kHuge, false},
    {"thermal_drift", "growth_m", &E::thermal_growth_m, -0.1, 0.1, true},
    {"thermal_drift", "time_s", &E::thermal_time_s, 0.01, kHuge, false},
    {"angle_periodic", "amplitude_rad", &E::angle_periodic_rad, -1.0, 1.0, true},
    {"angle_periodic", "per_turn", &E::angle_periodic_per_turn, 0.0, 1000.0, false},
    {"angle_periodic", "phase_rad", &E::angle_periodic_phase_rad, -10.0, 10.0, false},
    {"stiffness_hardening", "per_n", &E::hardening_per_n, 0.0, 100.0, true},
    {"load_inertia", "inertia_kgm2", &E::load_inertia_kgm2, 0.0, 10.0, true},
    {"axis_coupling", "angle_rad", &E::axis_coupling_rad, -10.0, 10.0, true},
    {"axis_coupling", "frequency_hz", &E::axis_coupling_hz, 0.0, 100.0, false},
    {"axis_coupling", "radius_m", &E::axis_coupling_radius_m, -1.0, 1.0, false},
    {"presliding", "torque_nm", &E::presliding_nm, 0.0, 100.0, true},
    {"presliding", "width_rad", &E::presliding_width_rad, 1.0e-6, 10.0, false},
    {"viscous_friction", "nms_per_rad", &E::viscous_friction_nms_per_rad, 0.0, 100.0, true},
    {"coulomb_friction", "torque_nm", &E::coulomb_friction_nm, 0.0, 100.0, true},
    {"friction_asymmetry", "share", &E::friction_asymmetry, -1.0, 1.0, true},
    {"stribeck_friction", "torque_nm", &E::stribeck_nm, 0.0, 100.0, true},
    {"stribeck_friction", "rate_rad_per_s", &E::stribeck_rad_per_s, 1.0e-4, 1.0e3, false},
    {"play_friction", "torque_nm", &E::play_friction_nm, 0.0, 100.0, true},
    {"play_friction", "width_rad", &E::play_friction_width_rad, 1.0e-6, 10.0, false},
    {"offset", "torque_nm", &E::offset_nm, -100.0, 100.0, true},
    {"wear", "per_rad", &E::wear_per_rad, -10.0, 10.0, true},
    {"sticky_spot", "torque_nm", &E::sticky_spot_nm, 0.0, 100.0, true},
    {"sticky_spot", "angle_rad", &E::sticky_spot_angle_rad, -100.0, 100.0, false},
    {"sticky_spot", "width_rad", &E::sticky_spot_width_rad, 1.0e-4, 10.0, false},
    {"magnetic_detent", "torque_nm", &E::magnetic_detent_nm, -100.0, 100.0, true},
    {"magnetic_detent", "per_turn", &E::magnetic_detent_per_turn, 0.0, 1000.0, false},
    {"pulley_slip", "angle_rad", &E::pulley_slip_rad, -10.0, 10.0, true},
    {"pulley_slip", "at_s", &E::pulley_slip_at_s, 0.0, kHuge, false},
    {"pulley_slip", "every_s", &E::pulley_slip_every_s, 0.0, kHuge, false},
    {"fraying", "share", &E::fraying_share, 0.0, 0.99, true},
    {"fraying", "at_s", &E::fraying_at_s, 0.0, kHuge, false},
    {"tremor", "torque_nm", &E::tremor_nm, -100.0, 100.0, true},
    {"tremor", "frequency_hz", &E::tremor_hz, 0.0, 400.0, false},
    {"sheath_bend", "per_rad", &E::sheath_bend_per_rad, -10.0, 10.0, true},
    {"torque_fade", "share", &E::torque_fade, -1.0, 1.0, true},
    {"torque_fade", "time_s", &E::torque_fade_time_s, 0.01, kHuge, false},
});

// Negated so that NaN is refused too.
void check_range(std::string_view name, double value, double low, double high) {
  if (value >= low && value <= high)
    return;
  std::ostringstream text;
  text << name << " is " << value << ", which is impossible; give a value from " << low << " to " << high;
  throw std::invalid_argument(text.str());
}

int checked_integer(std::string_view name, double value, int low, int high) {
  check_range(name, value, low, high);
  if (std::floor(value) != value)
    throw std::invalid_argument(std::string(name) + " is not whole; give an integer");
  return static_cast<int>(value);
}

template <class Owner>
bool set_field(std::span<const Field<Owner>> fields, Owner& owner, std::string_view name, double value) {
  for (const Field<Owner>& field : fields) {
    if (field.name != name)
      continue;
    check_range(name, value, field.low, field.high);
    owner.*field.member = value;
    return true;
  }
  return false;
}

[[noreturn]] void unknown(std::string_view what, std::string_view name, const std::string& known) {
  throw std::invalid_argument("there is no " + std::string(what) + " `" + std::string(name) + "`; known are: " + known);
}

// The part of a name before its unit.
std::string_view stem(std::string_view name) {
  for (const std::string_view unit : {"_nms_per_rad", "_n_per_m", "_nm_per_a", "_counts_per_turn", "_kgm2", "_counts",
                                      "_nm", "_rad", "_hz", "_a", "_m", "_n", "_s"}) {
    if (name.ends_with(unit))
      return name.substr(0, name.size() - unit.size());
  }
  return {};
}

// `input_radius_mm` or `input_radius` where `input_radius_m` is known: the quantity is right, its unit is not.
template <class Table>
void refuse_other_unit(const Table& table, std::string_view name) {
  for (const auto& field : table) {
    const std::string_view quantity = stem(field.name);
    if (quantity.empty() || !name.starts_with(quantity))
      continue;
    if (name.size() == quantity.size() || name[quantity.size()] == '_') {
      throw std::invalid_argument("`" + std::string(name) + "` is not in this file's unit; write `" +
                                  std::string(field.name) + "`, converted");
    }
  }
}

template <class Table>
std::string names(const Table& table) {
  std::string all;
  for (const auto& field : table)
    all += (all.empty() ? "" : ", ") + std::string(field.name);
  return all;
}

std::string effect_names() {
  std::string all;
  for (const EffectField& field : kEffectFields) {
    const std::string full = std::string(field.effect) + "." + std::string(field.key);
    all += (all.empty() ? "" : ", ") + full;
  }
  return all;
}

}  // namespace

std::span<const Field<PlantParameters>> plant_fields() {
  return kPlantFields;
}
std::span<const Field<Environment>> environment_fields() {
  return kEnvironmentFields;
}
std::span<const EffectField> effect_fields() {
  return kEffectFields;
}

void set_effect(Effects& effects, std::string_view name, double value) {
  Effects changed = effects;
  bool found = false;
  for (const EffectField& field : kEffectFields) {
    const bool short_form = field.primary && name == field.effect;
    const bool long_form = name.size() == field.effect.size() + 1 + field.key.size() &&
                           name.starts_with(field.effect) && name[field.effect.size()] == '.' &&
                           name.ends_with(field.key);
    if (!short_form && !long_form)
      continue;
    check_range(name, value, field.low, field.high);
    changed.*field.member = value;
    found = true;
  }
  if (!found)
    unknown("effect", name, effect_names());
  effects = changed;
}

void set_parameter(PlantParameters& parameters, std::string_view name, double value) {
  if (name == "element_count") {
    parameters.element_count = checked_integer(name, value, 2, 512);
  } else if (name == "substeps") {
    parameters.substeps = checked_integer(name, value, 1, 1000);
  } else if (!set_field(plant_fields(), parameters, name, value)) {
    refuse_other_unit(kPlantFields, name);
    unknown("plant parameter", name, names(kPlantFields) + ", element_count, substeps");
  }
}

void set_environment(Environment& environment, std::string_view name, double value) {
  if (!set_field(environment_fields(), environment, name, value)) {
    refuse_other_unit(kEnvironmentFields, name);
    unknown("environment parameter", name, "kind, " + names(kEnvironmentFields));
  }
}

EnvironmentKind environment_kind(std::string_view name) {
  constexpr std::array kKinds =
      std::to_array<std::pair<std::string_view, EnvironmentKind>>({{"free", EnvironmentKind::kFree},
                                                                   {"locked", EnvironmentKind::kLocked},
                                                                   {"spring", EnvironmentKind::kSpring},
                                                                   {"kelvin_voigt", EnvironmentKind::kKelvinVoigt},
                                                                   {"hunt_crossley", EnvironmentKind::kHuntCrossley},
                                                                   {"layered", EnvironmentKind::kLayered}});
  for (const auto& [known, kind] : kKinds) {
    if (known == name)
      return kind;
  }
  unknown("environment", name, "free, locked, spring, kelvin_voigt, hunt_crossley, layered");
}

bool plays_a_part(EnvironmentKind kind, std::string_view name) {
  switch (kind) {
    case EnvironmentKind::kFree:
    case EnvironmentKind::kLocked:
      return false;
    case EnvironmentKind::kSpring:
      return name == "stiffness" || name == "angle_rad";
    case EnvironmentKind::kKelvinVoigt:
    case EnvironmentKind::kHuntCrossley:
      return name == "stiffness" || name == "angle_rad" || name == "damping";
    case EnvironmentKind::kLayered:
      break;
  }
  return true;
}

SolverMode solver_mode(std::string_view name) {
  if (name == "quasi_static")
    return SolverMode::kQuasiStatic;
  if (name == "dynamic")
    return SolverMode::kDynamic;
  unknown("solver mode", name, "quasi_static, dynamic");
}

void validate(const PlantParameters& parameters) {
  for (const auto& field : kPlantFields)
    check_range(field.name, parameters.*field.member, field.low, field.high);
  for (const auto& field : kEnvironmentFields) {
    check_range(std::string("environment.") + std::string(field.name), parameters.environment.*field.member, field.low,
                field.high);
  }
  for (const auto& field : kEffectFields) {
    check_range(std::string(field.effect) + "." + std::string(field.key), parameters.effects.*field.member, field.low,
                field.high);
  }
  checked_integer("element_count", static_cast<double>(parameters.element_count), 2, 512);
  checked_integer("substeps", static_cast<double>(parameters.substeps), 1, 1000);
  if (parameters.stop_low_rad >= parameters.stop_high_rad) {
    throw std::invalid_argument("stop_low_rad is not below stop_high_rad; give the end stops in order");
  }
  if (parameters.pretension_n + parameters.effects.pretension_change_n < 0.0) {
    throw std::invalid_argument("pretension: the change leaves less than nothing; make pretension.change_n smaller");
  }
}

}  // namespace capstan::sim
