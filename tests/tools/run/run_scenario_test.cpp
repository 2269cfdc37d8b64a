// SPDX-License-Identifier: Apache-2.0
// What a run records: every axis of the instrument, what the laboratory sees, and runs on the bench.
#include "capstan/tools/run/run.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/hal/sim/multi_plant.hpp"
#include "capstan/tools/apply/force_lines.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/replay/force_replay.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

struct Recorded {
  RunSummary summary;
  CsvLog log;
};

auto record(const sim::Scenario& scenario, const std::vector<std::string>& model = {}) -> Recorded {
  std::ostringstream text;
  FileBanks banks = FileBanks::temporary();
  RunSummary summary = run_scenario(scenario, model, banks, &text);
  return {std::move(summary), CsvLog::parse(text.str(), "log")};
}

auto scenario_of(const std::string& text) -> sim::Scenario {
  return sim::parse_scenario(text, "test.toml");
}

auto sine(const std::string& section, const char* amplitude) -> std::string {
  return "[[" + section + ".segments]]\nkind = \"sine\"\nduration_s = 4\nfrequency_hz = 0.5\n" + amplitude + "\n";
}

auto swing(const Eigen::VectorXd& angle) -> double {
  return angle.maxCoeff() - angle.minCoeff();
}

TEST(RunScenario, EveryAxisIsMovedByTheFirmwareAndLogged) {
  const Recorded run =
      record(scenario_of("instrument = \"da_vinci_wrist\"\n[[axes]]\naxis = \"left_jaw\"\n[axes.motion]\n" +
                         sine("axes.motion", "amplitude_rad = 0.4")));
  ASSERT_EQ(run.summary.fault, "");
  ASSERT_EQ(run.summary.joints.size(), 3U);
  // Only the left jaw is asked to move; its firmware brings the joint there, the others hold theirs.
  EXPECT_NEAR(swing(run.log.column("axis2/q2_rad")), 0.8, 0.25);
  EXPECT_LT(swing(run.log.column("axis0/q1_rad")), 0.03);
  EXPECT_LT(swing(run.log.column("axis1/q1_rad")), 0.03);
  const Eigen::VectorXd wanted = run.log.column("axis2/q2_ref_rad");
  EXPECT_LT(run.summary.joints[2].tracking_rmse_rad, 0.3 * swing(wanted));
}

TEST(RunScenario, PullOfTheCoupledAxisIsInTheLogAsThePlantMakesIt) {
  // The pitch moves, the jaws' motors hold: the jaws' joints follow by the ratio of table 6.1, and their log shows it.
  const Recorded run =
      record(scenario_of("instrument = \"da_vinci_wrist\"\n[motion]\n" + sine("motion", "amplitude_rad = 0.4")));
  const double pitch = swing(run.log.column("axis0/q2_rad"));
  EXPECT_NEAR(swing(run.log.column("axis1/q2_rad")) / pitch, 0.674, 0.1);
  EXPECT_NEAR(swing(run.log.column("axis2/q2_rad")) / pitch, 0.664, 0.1);
}

TEST(RunScenario, MotorsOfAnotherMakeAreMeasuredInTheirUnits) {
  // 4000 counts and 0.0302 N m/A instead of the firmware's defaults of 40960 and 0.1.
  const sim::Scenario scenario =
      scenario_of("instrument = \"raven2\"\n[torque]\n" + sine("torque", "amplitude_nm = 0.16"));
  const Recorded run = record(scenario);
  sim::MultiPlant plant(scenario);
  const auto current = [&](long i) { return scenario.motion.reference_rad(0.001 * static_cast<double>(i)) / 0.0302; };
  const Eigen::VectorXd q1 = run.log.column("axis0/q1_rad");
  const Eigen::VectorXd tau = run.log.column("axis0/tau_Nm");
  double swings = 0.0;
  // The board lived some cycles before the run, without current: the plant has not moved.
  for (long i = 0; i < q1.size(); ++i) {
    ASSERT_NEAR(q1[i], plant.truth(0).q1_rad, 2.0 * 2.0 * 3.1416 / 4000.0) << i;
    ASSERT_NEAR(tau[i], 0.0302 * plant.truth(0).current_a, 0.0302 * (0.002 + 6.0 * 0.005 + 0.004)) << i;
    swings = std::max(swings, std::abs(q1[i]));
    plant.step(std::vector<sim::MotorCommand>{{current(i), true}, {0.0, true}, {0.0, true}});
  }
  EXPECT_GT(swings, 0.1);
}

TEST(RunScenario, OnTheBenchTheMotorGivesTheTorqueOfTheScenarioAndTheFirmwareStaysDisarmed) {
  const Recorded run =
      record(scenario_of("[environment]\nkind = \"locked\"\n[torque]\n" + sine("torque", "amplitude_nm = 0.2")));
  EXPECT_EQ(run.summary.fault, "");
  EXPECT_EQ(run.summary.joints[0].tracking_rmse_rad, 0.0);
  const Eigen::VectorXd wanted = run.log.column("axis0/tau_ref_Nm");
  const Eigen::VectorXd measured = run.log.column("axis0/tau_Nm");
  EXPECT_NEAR(swing(wanted), 0.4, 1e-4);
  // Current sensor: offset 2 mA, noise 3 mA, at 0.1 N m/A.
  EXPECT_LT((measured - wanted).cwiseAbs().maxCoeff(), 0.1 * (0.002 + 6.0 * 0.003 + 0.01));
  // A locked tip feels what friction leaves of it: less than e^-eta, more than nothing, with the torque's sign at its
  // peaks.
  const Eigen::VectorXd felt = run.log.column("axis0/tau_out_Nm");
  EXPECT_NEAR(felt.maxCoeff() / (0.2 - 0.003), std::exp(-1.1414) * 2.4 / 2.6, 0.02);
  EXPECT_LT(swing(run.log.column("axis0/q2_rad")), 0.03);  // the camera's noise
}

TEST(RunScenario, JointTorqueThatTheFirmwareEstimatesIsInTheLogAndReplaysFromIt) {
  const std::string law =
      "[force]\nmodel = \"pull_push\"\neta_top = { value = 1.1414 }\neta_bottom = { value = 1.1404 }\n"
      "pretension = { value = 0.072 }\nratio = { value = 0.923 }\nfriction = { value = 0.003 }\n"
      "offset = { value = 0.0 }\nstiffness_top = { value = 0.3425 }\nstiffness_bottom = { value = 0.3436 }\n";
  const Recorded run = record(scenario_of("[environment]\nkind = \"spring\"\nstiffness = 0.5\n[motion]\n" +
                                          sine("motion", "amplitude_rad = 0.2")),
                              force_lines(law, "joint.toml", 0));
  EXPECT_EQ(run.summary.fault, "");
  const Eigen::VectorXd estimated = run.log.column("axis0/tau_out_est_Nm");
  const Eigen::VectorXd measured = run.log.column("axis0/tau_out_Nm");
  EXPECT_GT(swing(estimated), 0.05);
  EXPECT_LT(rms(estimated - measured), 0.1 * swing(measured));
  const ReplayedForce replayed =
      replay_force(run.log.column("axis0/tau_Nm"), read_board_force_law(law, "joint.toml"), Arithmetic::kFixed);
  // The firmware asks its law for what the motor was told; the log has what was measured.
  EXPECT_LT(rms(replayed.torque_nm - estimated), 0.02 * swing(estimated));
}

TEST(RunScenario, ThermometerIsLoggedWhereTheInstrumentHasOne) {
  const std::string motion = "[motion]\n" + sine("motion", "amplitude_rad = 0.2");
  EXPECT_FALSE(record(scenario_of(motion)).log.has("temperature_C"));
  const Recorded run = record(scenario_of("[plant]\nwarming_k = 8\n[effects.thermal_drift]\ntime_s = 2.0\n" + motion));
  const Eigen::VectorXd t = run.log.column("temperature_C");
  EXPECT_NEAR(t[0], 25.0, 0.4);
  EXPECT_NEAR(t[2000], 25.0 + 8.0 * (1.0 - std::exp(-1.0)), 0.4);
}

// Both tendons taut and sliding: Ttl = Ttr e^eta, Tbl = Tbr e^-eta and I = (Ttr (e^eta - 1) + Tbr (1 - e^-eta)) / eta
// with Ttr - Tbr = F give Ttl - Tbl = I eta + F: the tendons' own friction and, undiminished, the load of the joint.
// The motor adds its own.
TEST(SteadyTorque, IsTheSumOfTheFrictionsOfTendonsJointAndMotor) {
  constexpr double kSpeed = 0.5;  // of the joint, rad/s
  const Recorded run = record(scenario_of(
      "[motion]\nrepeat = 3\n[[motion.segments]]\nkind = \"triangle\"\nduration_s = 8\namplitude_rad = 0.5\n"
      "frequency_hz = 0.25\n"));
  const std::vector<AxisLog> logs = {read_axis(run.log, {.needs_torque = true})};
  LawForm form;
  form.terms = terms_of_model("pseudo_kinematic");
  const auto steady = identify(logs, form).joint.steady_torque;
  ASSERT_TRUE(steady.has_value());
  const sim::PlantParameters p;
  const double eta = 0.5 * (p.eta_top + p.eta_bottom);
  const double load_n = (p.joint_coulomb_nm + p.joint_viscous_nms_per_rad * kSpeed) / p.output_radius_m;
  const double motor_nm = p.motor_coulomb_nm + p.motor_viscous_nms_per_rad * kSpeed;
  const double friction = p.input_radius_m * (p.pretension_n * eta + load_n) + motor_nm;
  const double offset = p.torque_constant_nm_per_a * p.current_offset_a;
  const double resolution = p.torque_constant_nm_per_a * p.current_adc_step_a;
  EXPECT_NEAR(steady->forward_nm, friction + offset, 1.5 * resolution);
  EXPECT_NEAR(steady->backward_nm, -friction + offset, 1.5 * resolution);
}

TEST(RunScenario, PlantThatDivergesEndsTheRunWithTimeAndCause) {
  sim::Scenario scenario = scenario_of("[plant]\ncurrent_limit_a = 900\ntorque_constant_nm_per_a = 100\n[torque]\n" +
                                       sine("torque", "amplitude_nm = 99"));
  FileBanks banks = FileBanks::temporary();
  try {
    run_scenario(scenario, {}, banks, nullptr);
    FAIL() << "the run went on";
  } catch (const Refusal& refusal) {
    EXPECT_NE(std::string(refusal.what()).find(" s: the plant diverged: "), std::string::npos) << refusal.what();
  }
}

TEST(RunScenario, FaultOfTheCameraIsInTheLogAndTakesNoPartInTheErrors) {
  sim::Scenario scenario = scenario_of("[motion]\n" + sine("motion", "amplitude_rad = 0.3"));
  scenario.faults.push_back(sim::parse_fault("camera nan at 1 for 0.5"));
  std::ostringstream text;
  FileBanks banks = FileBanks::temporary();
  const RunSummary summary = run_scenario(scenario, {}, banks, &text);
  EXPECT_TRUE(std::isfinite(summary.joints[0].estimation_rmse_rad));
  EXPECT_GT(summary.joints[0].estimation_rmse_rad, 0.0);
  EXPECT_NE(text.str().find("\n1.100,"), std::string::npos);
  EXPECT_THROW(static_cast<void>(CsvLog::parse(text.str(), "log").column("axis0/q2_rad")), BadInput);
}

TEST(RunScenario, SensorThatJumpsBeyondAllMeasureIsLoggedWithAllItsDigits) {
  sim::Scenario scenario = scenario_of("[motion]\n" + sine("motion", "amplitude_rad = 0.3"));
  scenario.faults.push_back(sim::parse_fault("tip_force jump at 1 for 0.5 amount 1e300"));
  const Recorded run = record(scenario);
  EXPECT_EQ(run.log.column("axis0/tau_out_Nm")[1200], 1e300 * 0.01);
}

TEST(RunScenario, InstrumentWithMoreAxesThanABoardIsRefused) {
  sim::Scenario scenario;
  scenario.other_axes.resize(4);
  FileBanks banks = FileBanks::temporary();
  EXPECT_THROW(run_scenario(scenario, {}, banks, nullptr), std::runtime_error);
}

}  // namespace
}  // namespace capstan::tools
