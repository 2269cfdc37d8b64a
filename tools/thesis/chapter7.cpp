// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "capstan/tools/thesis/study.hpp"
#include "capstan/tools/thesis/thesis.hpp"

namespace capstan::tools {
namespace {

// Stiffness and the elbow's Coulomb friction with which identification on signal III returns the printed alphas
// (-5.302, -1.002) and KM of the sine of 0.1 Hz: three numbers to three, 24 Nov 2026, left to 0.1 %.
constexpr double kTopNPerM = 1442.5;
constexpr double kBottomNPerM = 3574.9;
constexpr double kJointCoulombNm = 1.4263e-3;
// "Low (close to zero)" in 7.3.1.
constexpr double kPretensionN = 0.2;
// Weight of the forearm about the elbow. Not printed: as much as leaves the loop as it is, so that what is taken out of
// the torque can be seen in alpha alone.
constexpr double kGravityNm = 0.004;

auto elbow() -> Study {
  // One axis alone: the first three axes of RAVEN II do not pull on each other.
  Study study{{built_in("raven2")[1]}, 0, {}};
  auto& plant = study.instrument[0].plant;
  plant.stiffness_top_n_per_m = kTopNPerM;
  plant.stiffness_bottom_n_per_m = kBottomNPerM;
  plant.joint_coulomb_nm = kJointCoulombNm;
  plant.pretension_n = kPretensionN;
  plant.effects.gravity_torque_nm = kGravityNm;
  study.gravity_out = true;
  return study;
}

/// @param periods  of the sines, which are not printed
auto signals_of(const sim::PlantParameters& plant, int periods = 2) -> std::vector<Signal> {
  return {sine_signal("I sine 0.1 Hz", 0.1, periods / 0.1, {1.2546, 73.1}, {0.5073, 89.1}, plant),
          sine_signal("II sine 0.2 Hz", 0.2, periods / 0.2, {1.5927, 67.6}, {0.7749, 84.3}, plant),
          multisine_signal("III multisine", {0.05, 0.07, 0.09}, 100.0, {1.4977, 84.7}, {0.7830, 92.0}, plant),
          multisine_signal("IV multisine", {0.05, 0.075, 0.1, 0.125, 0.15, 0.16}, 200.0, {1.5680, 61.2}, {0.9106, 77.5},
                           plant),
          multisine_signal("V multisine", {0.08, 0.1, 0.12, 0.14}, 50.0, {1.2557, 75.9}, {0.6239, 88.0}, plant)};
}

auto identified_study() -> Study {
  Study study = elbow();
  study.identification_signals = {signals_of(study.instrument[0].plant)[2]};
  return study;
}

auto with_file_tendons(Study study) -> Study {
  const sim::PlantParameters file = built_in("raven2")[1].plant;
  auto& plant = study.instrument[0].plant;
  plant.stiffness_top_n_per_m = file.stiffness_top_n_per_m;
  plant.stiffness_bottom_n_per_m = file.stiffness_bottom_n_per_m;
  plant.joint_coulomb_nm = file.joint_coulomb_nm;
  return study;
}

auto elbow_trials(const Study& study) -> std::vector<StudyTrial> {
  Study late = study;
  late.late_s = 0.05;
  late.extra_terms = {"transport_delay"};
  Study light = study;
  light.instrument[0].plant.effects.gravity_torque_nm = 0.0;
  Study sticky = study;  // by KM of signals II and IV of table 7.2
  sticky.instrument[0].plant.joint_coulomb_nm *= 1.25;
  return {
      {{"late encoder", "the joint's angle 50 ms late", "on time",
        "the joint's encoder comes through an Arduino and ROS, and what is late errs more the faster it goes."},
       late},
      {{"no weight", "no weight on the forearm", "4 mN m of it, taken out of the torque",
        "weight stretches a slack drive's tendon too, and taking it out of the torque hides that from the law."},
       light},
      {{"more friction", "a quarter more friction in the elbow", "the fitted one",
        "the loop of a slack drive is as wide as the joint's friction stretches a tendon, and friction differs from "
        "run to run.",
        fitted_places("km", {1, 3})},
       sticky},
      {{"file", "stiffness by (5.29) and 0.01 N m of friction, as in the instrument file", "the fitted ones",
        "(5.29) leaves out the motor's own friction, which the logged torque holds."},
       with_file_tendons(study)}};
}

}  // namespace

auto elbow_of_chapter_7() -> Instrument {
  return elbow().instrument;
}

auto table_7_1() -> ThesisTable {
  const Study study = identified_study();
  const std::vector<StudyTrial> tried = elbow_trials(study);
  ThesisTable table{"7.1", "RAVEN II elbow (ch. 7): identified on signal III", {}, {}, {}};
  std::vector<std::string> groups = {"printed", "simulated"};
  std::vector<std::array<double, 3>> values = {{-5.302, -1.002, 0.839}};
  values.push_back(thesis_parameters(run_study(study, {}).laws.thesis));
  for (const StudyTrial& t : tried) {
    groups.push_back(t.trial.group);
    table.trials.push_back(t.trial);
    values.push_back(thesis_parameters(run_study(t.study, {}).laws.thesis));
  }
  ThesisTable::Row row{"elbow", {}, {"alpha_t", "alpha_b"}};
  for (std::size_t g = 0; g < groups.size(); ++g) {
    add_parameter_columns(groups[g], table);
    row.values.insert(row.values.end(), values[g].begin(), values[g].end());
  }
  table.rows.push_back(std::move(row));
  table.conditions = {
      "Fitted (f): the two stiffnesses, 1443 and 3575 N/m, to the alphas; the elbow's friction, 1.43 mN m, to KM of "
      "signal I in table 7.2. beta is predicted; r1 / r2 is 0.8098 by the printed gear and radii. Pretension 0.2 N: "
      "the "
      "thesis measured with next to none."};
  return table;
}

auto table_7_2() -> ThesisTable {
  const Study study = identified_study();
  const auto& plant = study.instrument[0].plant;
  std::vector<StudyTrial> tried = elbow_trials(study);
  tried.push_back({{"longer", "sines of four periods", "two",
                    "a run begins from rest inside the loop, where no law is at home, and the longer it is the less of "
                    "it that is."},
                   study,
                   {0, 1},
                   signals_of(plant, 4)});
  ThesisTable table =
      estimation_table("7.2", "RAVEN II elbow (ch. 7): joint angle from motor angle and torque, RMSE", tried, false);
  add_rows(table, signals_of(plant), study, tried);
  table.rows[0].fitted = fitted_keys("km");
  table.conditions = {
      "Gravity is in the plant (4 mN m, hanging down) and taken out of the torque, as chapter 7 does. Stiffness and "
      "the "
      "elbow's friction are fitted to table 7.1 and to KM of signal I (f); the rest is predicted."};
  return table;
}

}  // namespace capstan::tools
