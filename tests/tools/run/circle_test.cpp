// SPDX-License-Identifier: Apache-2.0
// The main job in closed loop: log, identify, diagnose, put into the firmware, measure again. Every number is against
// the plant, which shares no code with the laws.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/tools/apply/model_lines.hpp"
#include "capstan/tools/apply/plausible_law.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/run/run.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

constexpr double kDegree = 0.017453292519943295;
const std::string kScenarios = CAPSTAN_SOURCE_DIR "/tools/scenarios/";

struct Recorded {
  RunSummary summary;
  std::vector<AxisLog> logs;
};

auto record(const std::string& scenario, const std::vector<std::string>& model) -> Recorded {
  std::ostringstream text;
  FileBanks banks = FileBanks::temporary();
  Recorded result;
  result.summary = run_scenario(sim::load_scenario(kScenarios + scenario), model, banks, &text);
  result.logs.push_back(read_axis(CsvLog::parse(text.str(), scenario), {.needs_torque = true}));
  return result;
}

auto identified(const Recorded& recording, const std::string& model) -> JointFile {
  LawForm form;
  form.terms = terms_of_model(model);
  return identify(recording.logs, form).joint;
}

TEST(Circle, IdentifiedLawHalvesAndBetterTheErrorOfTheRatioAloneOnUnseenMotion) {
  const Recorded recorded = record("identify.toml", {});
  ASSERT_EQ(recorded.summary.fault, "");
  const Recorded by_ratio = record("validate.toml", model_lines(identified(recorded, "kinematic"), 0));
  const Recorded by_law = record("validate.toml", model_lines(identified(recorded, "pseudo_kinematic"), 0));
  EXPECT_GT(by_ratio.summary.joints[0].estimation_rmse_rad, 1.5 * kDegree);  // there is a hysteresis to speak of
  EXPECT_LT(by_law.summary.joints[0].estimation_rmse_rad, 0.4 * by_ratio.summary.joints[0].estimation_rmse_rad);
}

TEST(Circle, TheAxisThatPullsIsSetOnTheBoard) {
  JointFile joint;
  const std::size_t alone = model_lines(joint, 1).size();
  joint.coupled_to = {2};
  const auto lines = model_lines(joint, 1);
  EXPECT_EQ(lines.size(), alone) << "every slot is set, also those that no joint has";
  EXPECT_NE(std::find(lines.begin(), lines.end(), "set joint1.axis_coupling.joint 2"), lines.end());
}

TEST(Circle, UndeclaredPlayIsNamedAndTheCorrectedFirmwareTracksBetter) {
  const Recorded recorded = record("identify_play.toml", {});
  const JointFile base = identified(recorded, "pseudo_kinematic");
  const Diagnosis diagnosis = diagnose(recorded.logs, {});
  ASSERT_FALSE(diagnosis.effects.empty()) << diagnosis.reason;
  std::vector<std::string> named = {diagnosis.effects.front().name};
  const auto& alternatives = diagnosis.effects.front().alternatives;
  named.insert(named.end(), alternatives.begin(), alternatives.end());
  EXPECT_NE(std::find(named.begin(), named.end(), "play"), named.end());

  const Recorded before = record("validate_play.toml", model_lines(base, 0));
  const Recorded after = record("validate_play.toml", model_lines(diagnosis.law, 0));
  ASSERT_EQ(after.summary.fault, "");
  EXPECT_LT(after.summary.joints[0].estimation_rmse_rad, 0.25 * before.summary.joints[0].estimation_rmse_rad);
  EXPECT_LT(after.summary.joints[0].tracking_rmse_rad, 0.5 * before.summary.joints[0].tracking_rmse_rad);

  const Recorded again = record("identify_play.toml", model_lines(diagnosis.law, 0));
  EXPECT_LT(again.summary.joints[0].estimation_rmse_rad, 0.25 * recorded.summary.joints[0].estimation_rmse_rad);
  DiagnoseOptions corrected;
  corrected.base_model = "corrected.toml";
  corrected.base_law = diagnosis.law;
  const Diagnosis second = diagnose(again.logs, corrected);
  EXPECT_EQ(second.verdict, Verdict::kNothingMissing) << second.reason;
}

TEST(Circle, ReplayOfTheLogGivesTheFirmwaresOwnEstimatesToTheBit) {
  std::ostringstream text;
  FileBanks banks = FileBanks::temporary();
  JointFile law;
  law.parameters.coefficients[0] = 1.0625;  // exact in both formats
  static_cast<void>(run_scenario(sim::load_scenario(kScenarios + "validate.toml"), model_lines(law, 0), banks, &text));
  const CsvLog log = CsvLog::parse(text.str(), "log");
  const Eigen::VectorXd q1 = log.column("axis0/q1_rad");
  const Eigen::VectorXd tau = log.column("axis0/tau_Nm");
  const Eigen::VectorXd logged = log.column("axis0/q2_est_rad");
  MotionLaw<Q24> replayed(SamplePeriod<Q24>(1000), to_fixed(motion_parameters(law)));
  for (Eigen::Index i = 0; i < q1.size(); ++i) {
    const Estimate<Q24> estimate = replayed.update(Q24::from_double(q1[i]), Q24::from_double(tau[i]));
    ASSERT_EQ(estimate.q2_reported, Q24::from_double(logged[i])) << "sample " << i;
  }
}

TEST(RunScenario, LineThatTheShellRefusesStopsTheRunWithItsAnswer) {
  sim::Scenario scenario = sim::load_scenario(kScenarios + "validate.toml");
  scenario.shell = {"set joint0.control.kp 1000"};
  FileBanks banks = FileBanks::temporary();
  try {
    run_scenario(scenario, {}, banks, nullptr);
    FAIL() << "the run went on";
  } catch (const BadInput& error) {
    EXPECT_NE(std::string(error.what()).find("control.kp"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("0 to 20"), std::string::npos);
  }
}

TEST(RunScenario, SensorThatGivesNoNumberEndsTheRunWithCauseAndCure) {
  sim::Scenario scenario = sim::load_scenario(kScenarios + "validate.toml");
  scenario.faults.push_back({.time_s = 2.0, .target = sim::FaultTarget::kCurrent, .kind = sim::FaultKind::kNan});
  FileBanks banks = FileBanks::temporary();
  const RunSummary summary = run_scenario(scenario, {}, banks, nullptr);
  EXPECT_EQ(summary.fault.substr(0, 14), "sensor_invalid");
  EXPECT_LT(summary.seconds, 2.1);
}

/// A law with the ranges of its logs: the motor from -1 to 2 rad, the joint 3 rad in all.
auto law_with_ranges() -> JointFile {
  JointFile joint;
  joint.fit = FitSummary{.rmse = 0.01, .motor_range = Interval{-1.0, 2.0}, .joint_range = 3.0, .logs = {}};
  return joint;
}
auto coefficient(JointFile& joint, const std::string& term, std::size_t i = 0) -> double& {
  return joint.parameters.coefficients[catalogue_term(term).first_coefficient + i];
}

TEST(PlausibleLaw, IsOneThatFollowsItsMotorAsFarAsItsLogsDid) {
  JointFile joint = law_with_ranges();
  EXPECT_EQ(implausible(joint), "");
  coefficient(joint, "motor_angle") = -1.0;
  EXPECT_EQ(implausible(joint), "") << "a crossed transmission is one";
  coefficient(joint, "motor_angle") = 9.0;
  EXPECT_EQ(implausible(joint), "") << "nine times as far is still taken";
  coefficient(joint, "motor_angle") = 11.0;
  EXPECT_NE(implausible(joint).find("the joint would go 33 rad, and in the logs it went 3"), std::string::npos)
      << implausible(joint);
  joint.fit.reset();  // a file written by hand
  EXPECT_NE(implausible(joint).find("without [fit]"), std::string::npos) << implausible(joint);
  coefficient(joint, "motor_angle") = 9.0;
  EXPECT_EQ(implausible(joint), "");
}

TEST(PlausibleLaw, IsNoneThatPutsTheJointFarFromItsZero) {
  JointFile joint = law_with_ranges();
  coefficient(joint, "joint_offset") = 40.0;
  EXPECT_EQ(implausible(joint), "") << "the joint goes 3 rad and its motor 2 from zero";
  coefficient(joint, "joint_offset") = 100.0;
  EXPECT_NE(implausible(joint).find("be as far as 102 rad from zero, and move over 3 there"), std::string::npos)
      << implausible(joint);
}

TEST(PlausibleLaw, IsNoneWhoseFrictionPushes) {
  JointFile joint = law_with_ranges();
  joint.steady_torque = SteadyTorque{0.3, 0.1};  // a weight, and less friction
  EXPECT_EQ(implausible(joint), "");
  joint.steady_torque = SteadyTorque{-0.1, 0.1};
  EXPECT_NE(implausible(joint).find("so friction would push the joint on"), std::string::npos) << implausible(joint);
}

TEST(PlausibleLaw, IsNoneThatRunsAgainstItsMotor) {
  JointFile joint = law_with_ranges();
  const auto& table = catalogue_term("table");
  joint.parameters.shapes[table.first_shape + 1] = 3.0;
  joint.parameters.shapes[table.first_shape + 2] = -1.0;
  joint.parameters.shapes[table.first_shape + 3] = 2.0;
  for (const std::size_t direction : {0U, 33U}) {
    coefficient(joint, "table", direction) = 1.3;  // falls by 2.6 while the ratio rises by 1.5, then rises again
    coefficient(joint, "table", direction + 1) = -1.3;
  }
  EXPECT_NE(implausible(joint).find("the joint would run against its motor for 1.1 rad"), std::string::npos)
      << implausible(joint);
  coefficient(joint, "table", 0) = coefficient(joint, "table", 33) = 0.2;
  coefficient(joint, "table", 1) = coefficient(joint, "table", 34) = -0.2;
  EXPECT_EQ(implausible(joint), "");
}

// A joint that is turned round as a whole has strokes like any other.
TEST(PlausibleLaw, IsNoneWhoseRatioWasTurnedRoundAfterItsFit) {
  JointFile joint = law_with_ranges();
  auto& ci95 = joint.coefficient_ci95[catalogue_term("motor_angle").first_coefficient];
  for (const double ratio : {1.0, -1.0}) {
    ci95 = Interval{ratio - 0.01, ratio + 0.01};
    coefficient(joint, "motor_angle") = ratio;
    EXPECT_EQ(implausible(joint), "");
    coefficient(joint, "motor_angle") = -ratio;
    EXPECT_NE(implausible(joint).find("would move in the other direction than in the logs"), std::string::npos)
        << implausible(joint);
  }
}

TEST(ModelLines, SetEveryParameterOfTheLawInOneTransaction) {
  JointFile joint;
  joint.steady_torque = SteadyTorque{0.08, -0.08};
  const auto lines = model_lines(joint, 0);
  constexpr std::size_t kConditionerTorqueAndMonitor = 6;
  constexpr std::size_t kErrorBar = 6;
  constexpr std::size_t kPretension = 3;
  constexpr std::size_t kCouplingAndStatus = kMostOthers + 1;
  EXPECT_EQ(lines.size(), kCoefficientCount + kShapeCount + kConditionerTorqueAndMonitor + kPretension + kErrorBar +
                              kCouplingAndStatus + 2);
  EXPECT_EQ(lines.front(), "begin");
  EXPECT_EQ(lines.back(), "commit");
  EXPECT_NE(std::find(lines.begin(), lines.end(), "set joint0.control.torque_backward -0.08000000 Nm"), lines.end());
}

TEST(ModelLines, TellTheMonitorWhatErrorTheFitLeftAndSwitchItOffWhereThereWasNoFit) {
  JointFile joint;
  const auto has = [&joint](const char* line) {
    const auto lines = model_lines(joint, 2);
    return std::find(lines.begin(), lines.end(), line) != lines.end();
  };
  EXPECT_TRUE(has("set joint2.monitor.joint_rms 0.00000000 rad"));
  joint.fit = FitSummary{.rmse = 0.0125, .gof_percent = 90.0, .samples = 5, .logs = {}};
  EXPECT_TRUE(has("set joint2.monitor.joint_rms 0.01250000 rad"));
  joint.fit->rmse = 7.0;  // of a hopeless fit
  EXPECT_TRUE(has("set joint2.monitor.joint_rms 1.00000000 rad"));
}

TEST(ModelLines, TellTheGaugeOfPretensionWhatTheFileKnowsAndABoardHolds) {
  JointFile joint;
  const auto has = [&joint](const char* line) {
    const auto lines = model_lines(joint, 0);
    return std::find(lines.begin(), lines.end(), line) != lines.end();
  };
  EXPECT_TRUE(has("set joint0.monitor.pretension 0.00000000 N"));
  joint.fit = FitSummary{};
  joint.fit->pretension = PretensionNumbers{{0.05, 0.004, 0.0625, 1e-3, 0.8, 0.02, 2.5e-3, 25.0, 0.75}};
  EXPECT_TRUE(has("set joint0.monitor.pretension 25.00000000 N"));
  EXPECT_TRUE(has("set joint0.monitor.pretension_error 1.25000000 N")) << "3 % of its own and 4 % for its change";
  EXPECT_TRUE(has("set joint0.monitor.tendon_friction 0.05000000 Nm"));
  joint.fit->pretension->values[7] = 200.0;
  EXPECT_TRUE(has("set joint0.monitor.pretension 0.00000000 N"));
  joint.fit->pretension = PretensionNumbers{{0.05, 0.01}};
  EXPECT_TRUE(has("set joint0.monitor.tendon_friction 0.00000000 Nm")) << "a free tip does not know it well";
}

TEST(ModelLines, TellTheMonitorHowFarFrictionGoesAndSwitchItOffWhereNobodyKnows) {
  JointFile joint;
  const auto has = [&joint](const char* line) {
    const auto lines = model_lines(joint, 0);
    return std::find(lines.begin(), lines.end(), line) != lines.end();
  };
  joint.steady_torque = SteadyTorque{0.05, -0.03};
  EXPECT_TRUE(has("set joint0.monitor.torque_rms 0.00000000 Nm"));
  joint.fit = FitSummary{.rmse = 0.01, .gof_percent = 90.0, .samples = 5, .logs = {}};
  EXPECT_TRUE(has("set joint0.monitor.torque_rms 0.00000000 Nm")) << "too few stretches";
  joint.fit->friction_rms = 0.0003;  // and 1 % of 0.04 Nm: 3, 4, 5
  EXPECT_TRUE(has("set joint0.monitor.torque_rms 0.00050000 Nm"));
  joint.steady_torque.reset();
  EXPECT_TRUE(has("set joint0.monitor.torque_rms 0.00000000 Nm"));
}

}  // namespace
}  // namespace capstan::tools
