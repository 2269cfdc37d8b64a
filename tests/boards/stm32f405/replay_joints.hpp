// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

#include "capstan/firmware/parameters/parameters.hpp"

/// The joints of the replayed run: every law and every effect of them is on somewhere.
namespace capstan::stm32f405 {

/// What the joints have beside every effect of a law of motion.
enum class Joints {
  kEverything,  ///< laws of efforts with every effect, half of them as feedforward; force laws of three kinds
  kMotion,      ///< no laws of efforts; each its Preisach model
};

inline constexpr std::size_t kTendonAxis = 1;

/// Preisach's relays are spread evenly: f_ab is the area below a and b.
inline void give_force_law(ForceConfig& force, ForceLawKind kind) {
  force.law = static_cast<std::int32_t>(kind);
  force.pull_weight = Q24::from_double(0.5904);
  force.pull_push_weight = Q24::from_double(0.4686);
  force.eta_top = Q24::from_double(1.1414);
  force.eta_bottom = Q24::from_double(1.1404);
  force.pretension_nm = Q24::from_double(0.072);
  force.ratio = Q24::from_double(0.923);
  force.friction_nm = Q24::from_double(0.01);
  force.grid.levels = ForceConfig::kLevels;
  for (std::int32_t a = 0; a < 11; ++a) {
    force.grid.inputs[static_cast<std::size_t>(a)] = Q24::from_double(0.05 * (a - 5));
    for (std::int32_t b = 0; b <= a; ++b) {
      force.grid.set_force(static_cast<std::size_t>(a), static_cast<std::size_t>(b),
                           Q24::from_double(0.002 * (2 * a * b - b * b)));
    }
  }
}

/// Every effect of an effort, of the size that this plant's motor has them. On every second axis they are the
/// feedforward too.
template <typename Set>
void give_effort_law(std::size_t axis, Set&& set) {
  set("effort_inertia.inertia", 0.02);
  set("effort_viscous_friction.drag", 0.002);
  set("effort_coulomb_friction.level", 0.01);
  set("effort_friction_asymmetry.level", 0.002);
  set("effort_stribeck_friction.excess", 0.003);
  set("effort_stribeck_friction.speed", 0.2);
  set("effort_play_friction.slider", 0.005);
  set("effort_play_friction.half_width", 0.05);
  set("effort_play_friction_2.bristle", 0.004);
  set("effort_play_friction_2.half_width", 0.3);
  set("effort_offset.offset", 0.001 * static_cast<double>(axis));
  set("effort_gravity.sine", 0.004);
  set("effort_angle_periodic.sine", 0.002);
  set("effort_angle_periodic.order", 5.0);
  set("effort_angle_periodic_2.cosine", 0.001);
  set("effort_angle_periodic_2.order", 12.0);
  set("effort_angle_periodic_3.cosine", 0.001);
  set("effort_angle_periodic_3.order", 30.0);
  set("effort_thermal_drift.warm_up", 0.003);
  set("effort_thermal_drift.time", 1.0);
  set("effort_power_law_friction.level", 0.004);
  set("effort_power_law_friction.exponent", 0.4);
  set("effort_power_law_friction.speed", 2.0);
  set("effort_spring.linear", 0.01);
  set("effort_spring.cubic", 0.002);
  set("effort_spring.span", 1.0);
  set("effort_load_friction.spring", 0.002);
  set("effort_load_friction.span", 1.0);
  set("effort_load_friction_2.weight_driven", 0.002);
  set("effort.window", 0.04 + 0.02 * static_cast<double>(axis));
}

/// What stretches: the tendons themselves on the second axis, their steady elongation on the others. No law has both.
template <typename Set>
void give_tendons(std::size_t axis, Set&& set) {
  if (axis != kTendonAxis) {
    set("tendon_elongation.top", -0.11);
    set("tendon_elongation.bottom", -0.09);
    return;
  }
  set("tendon.compliance", -0.4);
  set("tendon.eta_top", 0.7);
  set("tendon.eta_bottom", 0.9);
  set("tendon.pretension", 0.08);
  set("tendon.top_share", 0.45);
  set("tendon.friction", 0.002);
  set("tendon.viscous", 0.0005);
  set("tendon.inertia", 0.02);
  set("tendon.free_share", 0.1);
}

/// Pull-push on the even axes, Preisach on the odd ones.
inline auto force_law_of(std::size_t axis, Joints joints) -> ForceLawKind {
  if (axis % 2 == 1 || joints == Joints::kMotion) {
    return ForceLawKind::kPreisach;
  }
  return axis == 0 ? ForceLawKind::kBlend : ForceLawKind::kPullPush;
}

/// A law with every effect of the catalogue on, a little different for each axis; each feels the one before it.
inline auto lively_config(std::size_t axis, Joints joints) -> AxisConfig {
  AxisConfig config;
  const auto set = [&config](const char* name, double value) {
    const ParameterInfo* parameter = find_parameter(name);
    if (parameter == nullptr) {
      std::fprintf(stderr, "%s: the firmware has no such parameter any more; change replay_joints.hpp\n", name);
      std::exit(1);
    }
    set_raw_value(config, *parameter, Q24::from_double(value).raw());
  };
  if (joints == Joints::kEverything) {
    give_effort_law(axis, set);
    config.effort.feedforward = axis % 2 == 0 ? 1 : 0;
  }
  set("motor_angle.beta", 0.97 + 0.02 * static_cast<double>(axis));
  set("joint_offset.offset", 0.012);
  give_tendons(axis, set);
  set("transmission_viscous.top", -0.004);
  set("transmission_viscous.bottom", -0.006);
  set("pretension_offset.contrast", 0.008);
  set("play.gain", 0.05);
  set("play.half_width", 0.01);
  set("transport_delay.delay", 0.03);
  set("reversal_memory.top", 0.002);
  set("reversal_memory.bottom", 0.003);
  set("slip_propagation.a", -0.04);
  set("slip_propagation.top", 0.01);
  set("slip_propagation.bottom", -0.01);
  set("presliding.gain", 0.03);
  set("gravity.sine", 0.004);
  set("gravity.cosine", -0.003);
  set("viscoelastic_creep.creep", -0.02);
  set("thermal_drift.warm_up", 0.005);
  set("thermal_drift.temperature", 0.0002);
  set("angle_periodic.sine", 0.002);
  set("angle_periodic.cosine", 0.001);
  set("stiffness_hardening.top", 0.05);
  set("stiffness_hardening.bottom", 0.04);
  set("load_inertia.lag", -0.05);
  set("curved_ratio.square", 0.01);
  set("curved_ratio.cube", -0.02);
  set("curved_ratio.centre", 0.1);
  set("curved_ratio.span", 3.0);
  for (const std::string slot : {"", "_2", "_3"}) {
    set(("axis_coupling" + slot + ".angle").c_str(), 0.02);
    set(("axis_coupling" + slot + ".top").c_str(), -0.003);
    set(("axis_coupling" + slot + ".bottom").c_str(), -0.002);
    set(("coupled_hysteresis" + slot + ".angle").c_str(), 0.01);
    set(("coupled_hysteresis" + slot + ".lost").c_str(), -0.02);
    set(("coupled_hysteresis" + slot + ".half_width").c_str(), 0.01);
  }
  constexpr int kKnots = static_cast<int>(Table<Q24>::kKnots);
  for (int play = 1; play <= 6; ++play) {
    set(("hysteresis.half_width_" + std::to_string(play)).c_str(), 0.004 * play);
    set(("hysteresis.weight_" + std::to_string(play)).c_str(), 0.02);
  }
  for (int knot = 0; knot < kKnots; ++knot) {
    set(("table.forward_" + std::to_string(knot)).c_str(), 0.0001 * (1 + knot % 5));
    set(("table.backward_" + std::to_string(knot)).c_str(), -0.0001 * (1 + knot % 7));
  }
  set("table.knots", kKnots);
  set("table.signal", static_cast<double>(axis));
  set("table.factor", static_cast<double>((axis + 1) % kTableFactors));
  set("table.low", -1.0);
  set("table.high", 1.0);
  set("monitor.torque_rms", 0.002);
  give_force_law(config.force, force_law_of(axis, joints));
  for (std::size_t slot = 0; slot < config.coupled_to.size(); ++slot) {
    config.coupled_to[slot] = static_cast<std::int32_t>((axis + kAxes - 1 - slot) % kAxes);
  }
  const auto off = std::count(config.law.coefficients.begin(), config.law.coefficients.end(), Q24{});
  if (off != (axis == kTendonAxis ? 2 : 1)) {  // the two of the elongation, or that of the tendons
    std::fprintf(stderr, "the catalogue has an effect that this law leaves off; add it to replay_joints.hpp\n");
    std::exit(1);
  }
  set("control.torque_forward", 0.05);
  set("control.torque_backward", -0.04);
  return config;
}

}  // namespace capstan::stm32f405
