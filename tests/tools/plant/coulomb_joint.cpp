// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/coulomb_joint.hpp"

#include <cmath>

#include "capstan/tests/tools/plant/lab_joint.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools::plant {
namespace {

using P = coulomb::Parameters;

auto of_pretension(const P& healthy, double size) -> double {
  return 1.0 + size / healthy.tension_n;
}

auto all_switches() -> const std::vector<LabSwitch<P>>& {
  using E = coulomb::Effects;
  static const std::vector<LabSwitch<P>> kAll = {
      {{"drag", "transmission_viscous", 0.005, 0.1}, &E::drag_nms},
      {{"play", "play", 0.002, 0.1}, &E::play_rad, own_size<P>},
      {{"camera_delay", "transport_delay", 0.003, 0.1}, &E::camera_delay_s, own_size<P>},
      {{"pretension", "pretension_offset", 1.0, 40.0}, &E::pretension_n, of_pretension},
      {{"weight", "gravity", 0.01, 0.3}, &E::weight_nm, own_size<P>},
      {{"load_inertia", "load_inertia", 1e-4, 5e-3}, &E::load_inertia_kgm2, own_size<P>},
      {{"growth", "thermal_drift", 0.005, 0.2}, &E::growth_rad},
      {{"dial_error", "angle_periodic", 0.003, 0.1}, &E::dial_error_rad},
      {{"hardening", "stiffness_hardening", 0.1, 1.0}, &E::hardening},
      {{"presliding", "presliding", 0.005, 0.1}, &E::presliding_nm, own_size<P>},
      {{"creep", "viscoelastic_creep", 2e-6, 1e-4}, &E::creep_per_n},
      {{"wear", "", 0.2, 2.0}, &E::wear},
      {{"sticky_spot", "", 0.3, 4.0}, &E::sticky},
      {{"detent", "", 0.005, 0.1}, &E::detent_nm},
      {{"slip", "", 0.003, 0.2}, &E::slip_rad},
      {{"tremor", "", 0.005, 0.1}, &E::tremor_nm}};
  return kAll;
}

}  // namespace

auto coulomb_joint(std::uint64_t seed) -> coulomb::Parameters {
  Random random(seed);
  const auto drawn = [&](double least, double most) { return least * std::pow(most / least, random.uniform()); };
  coulomb::Parameters joint;
  joint.motor_radius_m = drawn(0.006, 0.015);
  joint.joint_radius_m = joint.motor_radius_m * drawn(0.7, 1.3);
  joint.tension_n = drawn(5.0, 25.0);
  joint.stiffness_n_per_m = joint.tension_n / (joint.motor_radius_m * drawn(0.03, 0.12));
  joint.eta_top = drawn(0.3, 1.3);
  joint.eta_bottom = joint.eta_top * drawn(0.8, 1.25);
  joint.joint_inertia_kgm2 = drawn(3e-6, 3e-5);
  const double stiffness_nm = 2.0 * joint.stiffness_n_per_m * joint.joint_radius_m * joint.joint_radius_m;
  joint.joint_viscous_nms = drawn(0.03, 0.5) * std::sqrt(stiffness_nm * joint.joint_inertia_kgm2);
  joint.joint_friction_nm = joint.tension_n * joint.joint_radius_m * drawn(0.005, 0.04);
  joint.motor_inertia_kgm2 = drawn(1e-5, 5e-5);
  joint.motor_friction_nm = joint.tension_n * joint.motor_radius_m * drawn(0.01, 0.05);
  joint.motor_viscous_nms = 0.05 * joint.motor_friction_nm;
  joint.camera_noise_rad = drawn(2e-4, 8e-4);
  joint.torque_noise_nm = joint.tension_n * joint.motor_radius_m * drawn(0.002, 0.008);
  joint.camera_late_s = random.uniform() < 0.5 ? drawn(0.004, 0.02) : 0.0;
  return joint;
}

auto log_of(const coulomb::Parameters& joint, const LabExperiment& experiment, const std::string& keep) -> AxisLog {
  const auto course = lab_course(experiment, 0.0);
  const double beta = joint.motor_radius_m / joint.joint_radius_m;
  std::vector<independent::Row> rows;
  for (const auto& row : coulomb::moved(
           joint, [&](double time) { return course(time) / beta; }, kLabDurationS, experiment.rate_hz,
           experiment.noise_seed)) {
    rows.push_back({row.time_s, row.q1_rad, row.tau_nm, row.q2_rad, 0.0});
  }
  return lab_log(rows, false, experiment, keep);
}

auto switched_coulomb_joint(std::uint64_t seed) -> std::unique_ptr<SwitchedJoint> {
  return std::make_unique<LabJoint<P>>(coulomb_joint(seed), seed, all_switches());
}

}  // namespace capstan::tools::plant
