// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/plant_joint.hpp"

#include <fstream>
#include <sstream>

#include "capstan/boards/common/file_banks.hpp"
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

}  // namespace

auto switches() -> const std::vector<Switch>& {
  using E = sim::Effects;
  // Foreign are also those that the catalogue has and a log of this joint alone can not show: the other joint's angle.
  static const std::vector<Switch> kAll = {
      {"transmission_viscous", "transmission_viscous", &E::transmission_viscous_forward_ns_per_m, 20.0, 2000.0},
      {"play", "play", &E::play_half_width_rad, 0.02, 0.3},
      {"transport_delay", "transport_delay", &E::transport_delay_s, 0.01, 0.2},
      {"pretension_change", "pretension_offset", &E::pretension_change_n, 8.0, 60.0},
      {"gravity", "gravity", &E::gravity_torque_nm, 0.02, 0.1},
      {"creep", "viscoelastic_creep", &E::creep_ratio, 0.1, 2.0},
      {"thermal_growth", "thermal_drift", &E::thermal_growth_m, 5e-5, 1e-3},
      {"angle_periodic", "angle_periodic", &E::angle_periodic_rad, 0.01, 0.2},
      {"hardening", "stiffness_hardening", &E::hardening_per_n, 0.01, 0.5},
      {"load_inertia", "load_inertia", &E::load_inertia_kgm2, 2e-4, 5e-3},
      {"axis_coupling", "", &E::axis_coupling_rad, 0.05, 1.0},
      {"presliding", "presliding", &E::presliding_nm, 0.01, 0.1},
      {"wear", "", &E::wear_per_rad, 0.002, 0.05},
      {"sticky_spot", "", &E::sticky_spot_nm, 0.02, 0.08},
      {"magnetic_detent", "", &E::magnetic_detent_nm, 0.01, 0.05},
      {"pulley_slip", "", &E::pulley_slip_rad, 0.02, 0.3},
      {"tremor", "", &E::tremor_nm, 0.01, 0.05},
      {"sheath_bend", "", &E::sheath_bend_per_rad, 0.3, 3.0},
      {"torque_fade", "", &E::torque_fade, 0.1, 0.5}};
  return kAll;
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
