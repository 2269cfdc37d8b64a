// SPDX-License-Identifier: Apache-2.0
// What the firmware has to reach on the simulated instruments: cross-coupling of the wrist, the monitor of the law, and
// palpation that tells stiffness at the prompt. Truth is the plant's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/tests/tools/run/board_rig.hpp"
#include "capstan/tests/tools/run/recipe_log.hpp"
#include "capstan/tools/apply/force_lines.hpp"
#include "capstan/tools/apply/model_lines.hpp"
#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/run/run.hpp"

namespace capstan::tools {
namespace {

using Lines = std::vector<std::string>;
constexpr double kPerDegree = 180.0 / std::numbers::pi;
const std::string kScenarios = CAPSTAN_SOURCE_DIR "/tools/scenarios/";

/// The law of one axis of the wrist, from a run in which all of them move.
auto wrist_law(const std::string& log, int axis, const std::string& model) -> JointFile {
  LawForm form;
  form.terms = terms_of_model(model);
  return identify({read_axis(CsvLog::parse(log, "run.csv"), {.axis = axis, .needs_torque = true, .other_axes = {0}})},
                  form)
      .joint;
}

/// How far the jaw goes with the pitch while it is to stand, degrees RMS over the last whole swings.
auto swing_of_jaw(const Lines& laws) -> double {
  sim::Scenario scenario = sim::load_scenario(kScenarios + "recipe_axis_coupling.toml");
  scenario.seed = 99;
  sim::Segment still;
  still.duration_s = 10.0;
  scenario.other_axes[0].motion = sim::Motion({still}, 1, 0.1);
  scenario.duration_s = 45.0;
  std::ostringstream text;
  FileBanks banks = FileBanks::temporary();
  const RunSummary summary = run_scenario(scenario, laws, banks, &text);
  EXPECT_EQ(summary.fault, "");
  const CsvLog log = CsvLog::parse(text.str(), "run.csv");
  const Eigen::VectorXd jaw = log.column("axis1/q2_rad").tail(40'000);
  const Eigen::VectorXd pitch = log.column("axis0/q2_rad").tail(40'000);
  EXPECT_GT(pitch.maxCoeff(), 0.3);
  const double noise = 0.0017;  // the camera's, not the jaw's
  return kPerDegree * std::sqrt(std::max(0.0, jaw.squaredNorm() / 40'000.0 - noise * noise));
}

TEST(Wrist, CouplingLawKeepsTheJawWithinThreeTenthsOfADegreeWhileThePitchSwings) {
  std::ostringstream text;
  FileBanks banks = FileBanks::temporary();
  static_cast<void>(run_scenario(sim::load_scenario(kScenarios + "recipe_axis_coupling.toml"), {}, banks, &text));
  const auto lines_with = [&text](const std::string& model) {
    Lines lines = model_lines(wrist_law(text.str(), 0, "pseudo_kinematic"), 0);
    const Lines jaw = model_lines(wrist_law(text.str(), 1, model), 1);
    lines.insert(lines.end(), jaw.begin(), jaw.end());
    return lines;
  };
  const double alone = swing_of_jaw(lines_with("pseudo_kinematic"));
  const double coupled = swing_of_jaw(lines_with("multi_dof"));
  std::printf(
      "jaw that is to stand while the pitch swings 23 deg: %.2f deg RMS alone, %.3f deg with the coupling law\n", alone,
      coupled);
  EXPECT_LT(coupled, 0.3);
  EXPECT_GT(alone, 3.0 * coupled) << "there is a coupling to speak of";
}

auto forceps_law() -> const Lines& {
  static const Lines lines = [] {
    std::ostringstream text;
    FileBanks banks = FileBanks::temporary();
    static_cast<void>(run_scenario(sim::load_scenario(kScenarios + "identify.toml"), {}, banks, &text));
    LawForm form;
    form.terms = terms_of_model("pseudo_kinematic");
    return model_lines(identify({read_axis(CsvLog::parse(text.str(), "run.csv"), {.needs_torque = true})}, form).joint,
                       0);
  }();
  return lines;
}

struct Watch {
  double warned_s = -1.0;  ///< when a warning came
  WarningSet warnings = 0;
  double most = 0.0;  ///< of the level until then
};

/// The joint swings and the monitor watches. `change`: what happens to the plant, at 60 s or slowly.
auto watch(const std::string& change, bool joint_sensor, double seconds) -> Watch {
  sim::Scenario scenario;
  scenario.seed = 21;
  scenario.plant.joint_sensor = joint_sensor ? 1.0 : 0.0;
  if (!change.empty()) {
    sim::override_effect(scenario, change);
  }
  if (scenario.plant.effects.pretension_change_n != 0.0) {
    scenario.plant.effects.pretension_change_at_s = 60.0;
  }
  scenario.plant.effects.pulley_slip_at_s = 60.0;
  test::BoardRig rig(scenario);
  rig.say(forceps_law());
  if (joint_sensor) {
    rig.say("set joint0.monitor.joint_rms 0.6 deg");
  }
  rig.say("arm");
  Watch result;
  for (long i = 0; i < std::lround(seconds * 1000.0); ++i) {
    const double t = 0.001 * static_cast<double>(i);
    // Swings whose amplitude and middle wander, so that a stretch is not like the one before.
    const double amplitude = 0.45 + 0.15 * std::sin(0.11 * t);
    const std::array<double, 1> reference = {0.1 * std::sin(0.037 * t) + amplitude * std::sin(2.0 * t)};
    rig.board.tick(reference);
    result.most = std::max(result.most, rig.joint().misfit.to_double());
    if (rig.joint().warnings != 0) {
      result.warned_s = t;
      result.warnings = rig.joint().warnings;
      EXPECT_NE(rig.say("status").find("  warning "), std::string::npos);
      EXPECT_NE(rig.say("faults").find("  warning "), std::string::npos);
      EXPECT_TRUE(energised(rig.board.machine().telemetry().state)) << "a warning stops nothing";
      break;
    }
  }
  EXPECT_EQ(rig.board.machine().telemetry().first_fault, Fault::kNone);
  std::printf("%-32s %s: %s at %.0f s, level before %.2f\n", change.empty() ? "nothing changes" : change.c_str(),
              joint_sensor ? "joint sensor" : "motor torque", result.warnings == 0 ? "no warning" : "warning",
              result.warned_s, result.most);
  return result;
}

TEST(LawMonitorOnPlant, SaysNothingWhileNothingChanges) {
  for (const bool joint_sensor : {true, false}) {
    const Watch result = watch("", joint_sensor, 300.0);
    EXPECT_EQ(result.warnings, 0);
    EXPECT_LT(result.most, 0.5);
  }
}

TEST(LawMonitorOnPlant, LostPretensionIsSaidWithinAMinuteOfMotion) {
  const Watch result = watch("pretension.change_n=-15", false, 180.0);
  EXPECT_EQ(result.warnings, bit(Warning::kFrictionLower));
  EXPECT_GT(result.warned_s, 60.0);
  EXPECT_LT(result.warned_s, 120.0);
}

TEST(LawMonitorOnPlant, WearIsSaidBeforeFrictionHasGrownByAFifth) {
  // eta grows by a thousandth for every radian that the motor travels: a fifth after 200 rad.
  const Watch result = watch("wear.per_rad=0.001", false, 400.0);
  EXPECT_EQ(result.warnings, bit(Warning::kFrictionHigher));
  EXPECT_LT(result.warned_s, 200.0 / (2.0 * 2.0 * 0.45 / std::numbers::pi));  // rad over mean speed
}

TEST(LawMonitorOnPlant, PulleyThatSlippedIsSaidByTheJointSensorWithinAMinuteOfMotion) {
  const Watch result = watch("pulley_slip.angle_rad=0.05", true, 180.0);
  EXPECT_EQ(result.warnings, bit(Warning::kLawMisfit));
  EXPECT_GT(result.warned_s, 60.0);
  EXPECT_LT(result.warned_s, 120.0);
}

TEST(PalpationOnBoard, TellsStiffnessWithItsIntervalAtThePromptAndKeepsAMap) {
  const Lines law = force_lines(
      with_force_section("", force_section(fit_pull_push({test::record("recipe_pull_push.toml")}))), "joint.toml", 0);
  double last = 0.0;
  for (const double stiffness : {0.08, 0.25}) {
    sim::Scenario scenario;
    scenario.seed = 5;
    scenario.plant.environment = {.kind = sim::EnvironmentKind::kSpring, .stiffness = stiffness};
    test::BoardRig rig(scenario);
    rig.say("begin");
    rig.say(law);
    rig.say(Lines{"commit", "arm"});
    const std::string answer = rig.say("palpate joint0 site=4 amplitude=0.2Nm rates=0.05 cycles=2 every=10");
    const std::size_t at = answer.find("# site 4 stiffness ");
    ASSERT_NE(at, std::string::npos) << answer.substr(answer.size() > 300 ? answer.size() - 300 : 0);
    double value = 0.0, half = 0.0;
    ASSERT_EQ(std::sscanf(answer.c_str() + at, "# site 4 stiffness %lf +- %lf", &value, &half), 2);
    std::printf("plant %.3f N m/rad, board %.4f +- %.4f\n", stiffness, value, half);
    EXPECT_NEAR(value, stiffness, half);
    EXPECT_LT(half, 0.06 * stiffness);
    // Two swings of 16 s, a row every 10 ms, though every cycle counts.
    EXPECT_NEAR(static_cast<double>(std::count(answer.begin(), answer.end(), '\n')), 3200.0, 20.0);
    EXPECT_GT(value, last);
    last = value;
    EXPECT_NE(rig.say("palpate map").find("# site 4 stiffness "), std::string::npos);
    EXPECT_EQ(rig.say("palpate clear").find("# site"), std::string::npos);
  }
}

}  // namespace
}  // namespace capstan::tools
