// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "capstan/tests/tools/plant/independent_joint.hpp"

namespace capstan::tools::plant {
namespace {

/// A switch, and where it is in the plant.
struct IndependentSwitch {
  Switchable what;
  double independent::Effects::*size;
  bool told;  ///< the diagnosis tells its size in the switch's unit
};

auto all_switches() -> const std::vector<IndependentSwitch>& {
  using E = independent::Effects;
  static const std::vector<IndependentSwitch> kAll = {
      {{"drag", "transmission_viscous", 20.0, 2000.0}, &E::drag_ns_per_m, false},
      {{"play", "play", 0.01, 0.3}, &E::play_rad, true},
      {{"camera_delay", "transport_delay", 0.01, 0.2}, &E::camera_delay_s, true},
      {{"pretension", "pretension_offset", 8.0, 60.0}, &E::pretension_n, true},
      {{"weight", "gravity", 0.02, 0.1}, &E::weight_nm, true},
      {{"growth", "thermal_drift", 5e-5, 1e-3}, &E::growth_m, false},
      {{"gear_error", "angle_periodic", 0.01, 0.2}, &E::gear_error_rad, false},
      {{"hardening", "stiffness_hardening", 0.01, 0.5}, &E::hardening_per_n, false},
      {{"load_inertia", "load_inertia", 2e-4, 5e-3}, &E::load_inertia_kgm2, true},
      {{"presliding", "presliding", 0.01, 0.1}, &E::presliding_nm, true},
      {{"wear", "", 0.002, 0.05}, &E::wear_per_rad, false},
      {{"bend", "", 0.3, 3.0}, &E::bend_per_rad, false},
      {{"sticky_spot", "", 0.02, 0.08}, &E::sticky_nm, false},
      {{"detent", "", 0.01, 0.05}, &E::detent_nm, false},
      {{"slip", "", 0.02, 0.3}, &E::slip_rad, false},
      {{"tremor", "", 0.01, 0.05}, &E::tremor_nm, false}};
  return kAll;
}

class IndependentJoint final : public SwitchedJoint {
 public:
  explicit IndependentJoint(std::uint64_t seed)
      : joint_(independent_joint(seed)), experiment_(drawn_experiment(seed)) {}

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
    independent::Parameters joint = joint_;
    joint.effects.*all_switches()[which].size = size;
    LabExperiment experiment = experiment_;
    experiment.noise_seed += again ? 1 : 0;
    return log_of(joint, experiment, keep);
  }
  [[nodiscard]] auto true_size(std::size_t which, double size) const -> double override {
    const IndependentSwitch& one = all_switches()[which];
    if (one.what.name == "pretension") {
      return 1.0 + size / joint_.pretension_n;
    }
    if (one.what.name == "weight") {
      return size * std::cos(joint_.effects.weight_angle_rad);  // told is what goes with sin q2
    }
    return one.told ? size : 0.0;
  }
  [[nodiscard]] auto other_motion() const -> std::optional<AxisLog> override {
    return log_of(joint_, other_experiment(experiment_));
  }

 private:
  independent::Parameters joint_;
  LabExperiment experiment_;
};

}  // namespace

auto switched_independent_joint(std::uint64_t seed) -> std::unique_ptr<SwitchedJoint> {
  return std::make_unique<IndependentJoint>(seed);
}

}  // namespace capstan::tools::plant
