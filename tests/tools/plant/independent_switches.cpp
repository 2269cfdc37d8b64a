// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "capstan/tests/tools/plant/independent_joint.hpp"
#include "capstan/tests/tools/plant/lab_joint.hpp"

namespace capstan::tools::plant {
namespace {

using P = independent::Parameters;

auto of_pretension(const P& healthy, double size) -> double {
  return 1.0 + size / healthy.pretension_n;
}

/// Told is what goes with sin q2.
auto of_weight(const P& healthy, double size) -> double {
  return size * std::cos(healthy.effects.weight_angle_rad);
}

auto all_switches() -> const std::vector<LabSwitch<P>>& {
  using E = independent::Effects;
  static const std::vector<LabSwitch<P>> kAll = {
      {{"drag", "transmission_viscous", 20.0, 2000.0}, &E::drag_ns_per_m},
      {{"play", "play", 0.01, 0.3}, &E::play_rad, own_size<P>},
      {{"camera_delay", "transport_delay", 0.01, 0.2}, &E::camera_delay_s, own_size<P>},
      {{"pretension", "pretension_offset", 8.0, 60.0}, &E::pretension_n, of_pretension},
      {{"weight", "gravity", 0.02, 0.1}, &E::weight_nm, of_weight},
      {{"growth", "thermal_drift", 5e-5, 1e-3}, &E::growth_m},
      {{"gear_error", "angle_periodic", 0.01, 0.2}, &E::gear_error_rad},
      {{"hardening", "stiffness_hardening", 0.01, 0.5}, &E::hardening_per_n},
      {{"load_inertia", "load_inertia", 2e-4, 5e-3}, &E::load_inertia_kgm2, own_size<P>},
      {{"presliding", "presliding", 0.01, 0.1}, &E::presliding_nm, own_size<P>},
      {{"wear", "", 0.002, 0.05}, &E::wear_per_rad},
      {{"bend", "", 0.3, 3.0}, &E::bend_per_rad},
      {{"sticky_spot", "", 0.02, 0.08}, &E::sticky_nm},
      {{"detent", "", 0.01, 0.05}, &E::detent_nm},
      {{"slip", "", 0.02, 0.3}, &E::slip_rad},
      {{"tremor", "", 0.01, 0.05}, &E::tremor_nm}};
  return kAll;
}

}  // namespace

auto switched_independent_joint(std::uint64_t seed) -> std::unique_ptr<SwitchedJoint> {
  return std::make_unique<LabJoint<P>>(independent_joint(seed), seed, all_switches());
}

}  // namespace capstan::tools::plant
