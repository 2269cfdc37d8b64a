// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/plant_joint.hpp"

#include <fstream>
#include <sstream>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/hal/sim/step.hpp"
#include "capstan/tools/run/run.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools::plant {
namespace {

const std::string kScenarios = CAPSTAN_SOURCE_DIR "/tools/scenarios/";

auto scenario_of(PlantMotion motion) -> std::string {
  switch (motion) {
    case PlantMotion::kIdentify:
      return "identify.toml";
    case PlantMotion::kDecaying:
      return "recipe_decaying.toml";
    case PlantMotion::kLadder:
      return "recipe_dynamic.toml";
    case PlantMotion::kPull:
      return "recipe_pull_push.toml";
  }
  return {};
}

/// A switch, and where it is in the plant.
struct PlantSwitch {
  Switchable what;
  double sim::Effects::*size;
};

auto plant_switches() -> const std::vector<PlantSwitch>& {
  using E = sim::Effects;
  // Foreign are also those that the catalogue has and a log of this joint alone can not show: the other joint's angle.
  static const std::vector<PlantSwitch> kAll = {
      {{"transmission_viscous", "transmission_viscous", 20.0, 2000.0}, &E::transmission_viscous_forward_ns_per_m},
      {{"play", "play", 0.02, 0.3}, &E::play_half_width_rad},
      {{"transport_delay", "transport_delay", 0.01, 0.2}, &E::transport_delay_s},
      {{"pretension_change", "pretension_offset", 8.0, 60.0}, &E::pretension_change_n},
      {{"gravity", "gravity", 0.02, 0.1}, &E::gravity_torque_nm},
      {{"creep", "viscoelastic_creep", 0.1, 2.0}, &E::creep_ratio},
      {{"thermal_growth", "thermal_drift", 5e-5, 1e-3}, &E::thermal_growth_m},
      {{"angle_periodic", "angle_periodic", 0.01, 0.2}, &E::angle_periodic_rad},
      {{"hardening", "stiffness_hardening", 0.01, 0.5}, &E::hardening_per_n},
      {{"load_inertia", "load_inertia", 2e-4, 5e-3}, &E::load_inertia_kgm2},
      {{"axis_coupling", "", 0.05, 1.0}, &E::axis_coupling_rad},
      {{"presliding", "presliding", 0.01, 0.1}, &E::presliding_nm},
      {{"wear", "", 0.002, 0.05}, &E::wear_per_rad},
      {{"sticky_spot", "", 0.02, 0.08}, &E::sticky_spot_nm},
      {{"magnetic_detent", "", 0.01, 0.05}, &E::magnetic_detent_nm},
      {{"pulley_slip", "", 0.02, 0.3}, &E::pulley_slip_rad},
      {{"tremor", "", 0.01, 0.05}, &E::tremor_nm},
      {{"sheath_bend", "", 0.3, 3.0}, &E::sheath_bend_per_rad},
      {{"torque_fade", "", 0.1, 0.5}, &E::torque_fade}};
  return kAll;
}

class PlantJoint final : public SwitchedJoint {
 public:
  PlantJoint(std::uint64_t seed, PlantMotion motion) : plant_(drawn_plant(seed)), motion_(motion), seed_(seed) {}

  [[nodiscard]] auto motion() const -> std::string override { return name_of(motion_); }
  [[nodiscard]] auto camera_noise_rad() const -> double override { return plant_.camera_noise_rad; }
  [[nodiscard]] auto switches() const -> std::vector<Switchable> override {
    std::vector<Switchable> all;
    for (const auto& one : plant_switches()) {
      all.push_back(one.what);
    }
    return all;
  }
  [[nodiscard]] auto log(std::size_t which, double size, bool again, const std::string& keep) const
      -> AxisLog override {
    sim::PlantParameters plant = plant_;
    const PlantSwitch& one = plant_switches()[which];
    plant.effects.*one.size = size;
    if (one.what.name == "transmission_viscous") {
      plant.effects.transmission_viscous_backward_ns_per_m = size;
    }
    return log_of(plant, motion_, seed_ + (again ? 1 : 0), keep);
  }
  [[nodiscard]] auto true_size(std::size_t which, double size) const -> double override {
    const std::string& name = plant_switches()[which].what.name;
    if (name == "pretension_change") {
      return 1.0 + size / plant_.pretension_n;
    }
    if (name == "transport_delay") {
      return sim::kStepS * static_cast<double>(sim::steps(size));  // the camera's value is late by whole steps
    }
    return name == "gravity" || name == "load_inertia" || name == "presliding" || name == "play" ? size : 0.0;
  }

 private:
  sim::PlantParameters plant_;
  PlantMotion motion_;
  std::uint64_t seed_;
};

}  // namespace

auto switched_joint(std::uint64_t seed, PlantMotion motion) -> std::unique_ptr<SwitchedJoint> {
  return std::make_unique<PlantJoint>(seed, motion);
}

auto name_of(PlantMotion motion) -> std::string {
  const std::string file = scenario_of(motion);
  return file.substr(0, file.find('.'));
}

auto drawn_plant(std::uint64_t seed) -> sim::PlantParameters {
  Random random(seed);
  sim::PlantParameters plant;
  const auto times = [&](double least, double most) { return least * std::pow(most / least, random.uniform()); };
  const double eta = times(0.3, 1.5);
  plant.eta_top = eta * times(0.85, 1.18);
  plant.eta_bottom = eta * times(0.85, 1.18);
  const double stiffness = times(2.5e4, 1e5);
  plant.stiffness_top_n_per_m = stiffness * times(0.85, 1.18);
  plant.stiffness_bottom_n_per_m = stiffness * times(0.85, 1.18);
  plant.pretension_n = times(6.0, 30.0);
  plant.input_radius_m *= times(0.8, 1.5);
  plant.output_radius_m *= times(0.8, 1.5);
  plant.motor_inertia_kgm2 *= times(0.5, 1.5);
  plant.motor_coulomb_nm *= times(0.5, 2.0);
  plant.joint_coulomb_nm *= times(0.3, 1.5);
  return plant;
}

auto csv_of(const sim::PlantParameters& plant, PlantMotion motion, std::uint64_t seed, const std::string& keep)
    -> CsvLog {
  sim::Scenario scenario = sim::load_scenario(kScenarios + scenario_of(motion));
  scenario.plant = plant;
  scenario.seed = seed;
  if (motion == PlantMotion::kPull) {
    sim::Segment pull;
    pull.kind = sim::SegmentKind::kTriangle;
    pull.duration_s = 20.0;
    pull.amplitude_rad = pull_of(plant);
    pull.frequency_hz = 0.1;
    pull.corner_s = 0.2;
    scenario.motion = sim::Motion({pull}, 3, 0.5);
  }
  std::ostringstream text;
  FileBanks banks = FileBanks::temporary();
  const RunSummary summary = run_scenario(scenario, {}, banks, &text);
  if (!summary.fault.empty()) {
    throw Refusal("the firmware stopped: " + summary.fault);
  }
  if (!keep.empty()) {
    std::ofstream(keep) << text.str();
  }
  return CsvLog::parse(text.str(), name_of(motion));
}

auto log_of(const sim::PlantParameters& plant, PlantMotion motion, std::uint64_t seed, const std::string& keep)
    -> AxisLog {
  return read_axis(csv_of(plant, motion, seed, keep), {.needs_torque = true});
}

auto pull_of(const sim::PlantParameters& plant) -> double {
  constexpr double kPullNm = 0.15;
  const double stiffness = 0.5 * (plant.stiffness_top_n_per_m + plant.stiffness_bottom_n_per_m);
  return std::min(0.25, kPullNm / (1.5 * stiffness * plant.input_radius_m * plant.input_radius_m));
}

}  // namespace capstan::tools::plant
