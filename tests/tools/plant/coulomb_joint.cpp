// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/coulomb_joint.hpp"

#include <cmath>

#include "capstan/tools/support/random.hpp"

namespace capstan::tools::plant {
namespace {

/// A switch, and where it is in the plant.
struct CoulombSwitch {
  Switchable what;
  double coulomb::Effects::*size;
  bool told;  ///< the diagnosis tells its size in the switch's unit
};

auto all_switches() -> const std::vector<CoulombSwitch>& {
  using E = coulomb::Effects;
  static const std::vector<CoulombSwitch> kAll = {
      {{"drag", "transmission_viscous", 0.005, 0.1}, &E::drag_nms, false},
      {{"play", "play", 0.002, 0.1}, &E::play_rad, true},
      {{"camera_delay", "transport_delay", 0.003, 0.1}, &E::camera_delay_s, true},
      {{"pretension", "pretension_offset", 1.0, 40.0}, &E::pretension_n, true},
      {{"weight", "gravity", 0.01, 0.3}, &E::weight_nm, true},
      {{"load_inertia", "load_inertia", 1e-4, 5e-3}, &E::load_inertia_kgm2, true},
      {{"growth", "thermal_drift", 0.005, 0.2}, &E::growth_rad, false},
      {{"dial_error", "angle_periodic", 0.003, 0.1}, &E::dial_error_rad, false},
      {{"hardening", "stiffness_hardening", 0.1, 1.0}, &E::hardening, false},
      {{"presliding", "presliding", 0.005, 0.1}, &E::presliding_nm, true},
      {{"creep", "viscoelastic_creep", 2e-6, 1e-4}, &E::creep_per_n, false},
      {{"wear", "", 0.2, 2.0}, &E::wear, false},
      {{"sticky_spot", "", 0.3, 4.0}, &E::sticky, false},
      {{"detent", "", 0.005, 0.1}, &E::detent_nm, false},
      {{"slip", "", 0.003, 0.2}, &E::slip_rad, false},
      {{"tremor", "", 0.005, 0.1}, &E::tremor_nm, false}};
  return kAll;
}

class CoulombJoint final : public SwitchedJoint {
 public:
  explicit CoulombJoint(std::uint64_t seed) : joint_(coulomb_joint(seed)), experiment_(drawn_experiment(seed)) {}

  [[nodiscard]] auto motion() const -> std::string override { return name_of(experiment_.motion); }
  [[nodiscard]] auto camera_noise_rad() const -> double override { return joint_.camera_noise_rad; }
  [[nodiscard]] auto switches() const -> std::vector<Switchable> override {
    std::vector<Switchable> all;
    for (const auto& one : all_switches()) {
      all.push_back(one.what);
    }
    return all;
  }
  [[nodiscard]] auto log(std::size_t which, double size, bool again, const std::string& keep) const
      -> AxisLog override {
    coulomb::Parameters joint = joint_;
    joint.effects.*all_switches()[which].size = size;
    LabExperiment experiment = experiment_;
    experiment.noise_seed += again ? 1 : 0;
    return log_of(joint, experiment, keep);
  }
  [[nodiscard]] auto true_size(std::size_t which, double size) const -> double override {
    const CoulombSwitch& one = all_switches()[which];
    return one.what.name == "pretension" ? 1.0 + size / joint_.tension_n : (one.told ? size : 0.0);
  }
  [[nodiscard]] auto other_motion() const -> std::optional<AxisLog> override {
    return log_of(joint_, other_experiment(experiment_));
  }

 private:
  coulomb::Parameters joint_;
  LabExperiment experiment_;
};

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
  return std::make_unique<CoulombJoint>(seed);
}

}  // namespace capstan::tools::plant
