// SPDX-License-Identifier: Apache-2.0
// An effort law on its way: from a log of the simulated joint, which shares no code with it, onto the board, and what
// the board then says of free motion and of a contact.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/firmware/parameters/effort_rows.hpp"
#include "capstan/tests/tools/run/board_rig.hpp"
#include "capstan/tools/apply/effort_lines.hpp"
#include "capstan/tools/replay/effort_replay.hpp"
#include "capstan/tools/run/run.hpp"
#include "capstan/tools/select/effort_catalogue.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using Lines = std::vector<std::string>;
const std::string kScenarios = CAPSTAN_SOURCE_DIR "/tools/scenarios/";

auto free_run() -> const std::string& {
  static const std::string log = [] {
    std::ostringstream text;
    FileBanks banks = FileBanks::temporary();
    static_cast<void>(run_scenario(sim::load_scenario(kScenarios + "identify.toml"), {}, banks, &text));
    return text.str();
  }();
  return log;
}

auto plants_law() -> const EffortLaw& {
  static const EffortLaw law =
      select_effort_law({read_axis(CsvLog::parse(free_run(), "run.csv"), {.target = "axis0/tau_Nm", .effort = true})})
          .law;
  return law;
}

struct Felt {
  double rms_nm = 0.0, torque_rms_nm = 0.0, most_nm = 0.0;
};

/// The joint swings slowly about 0.
auto swing(const sim::Scenario& scenario, int feedforward) -> Felt {
  test::BoardRig rig(scenario);
  rig.say(effort_lines(plants_law(), "law.toml", 0));
  rig.say(Lines{"set joint0.effort.feedforward " + std::to_string(feedforward), "arm"});
  Felt felt;
  constexpr int kSettle = 3000;
  constexpr int kCycles = 12000;
  for (int i = 0; i < kCycles; ++i) {
    const double t = 0.001 * i;
    const std::array<double, 1> reference = {0.4 * std::sin(1.5 * t)};
    rig.board.tick(reference);
    if (i >= kSettle) {
      const double said = rig.joint().disturbance_nm.to_double();
      felt.rms_nm += said * said / (kCycles - kSettle);
      felt.torque_rms_nm += std::pow(rig.joint().tau_nm.to_double(), 2) / (kCycles - kSettle);
      felt.most_nm = std::abs(said) > std::abs(felt.most_nm) ? said : felt.most_nm;
    }
  }
  EXPECT_EQ(rig.board.machine().telemetry().first_fault, Fault::kNone);
  felt.rms_nm = std::sqrt(felt.rms_nm);
  felt.torque_rms_nm = std::sqrt(felt.torque_rms_nm);
  return felt;
}

TEST(EffortOnBoard, ContactStandsOutOfFreeMotion) {
  sim::Scenario free;
  free.seed = 31;
  sim::Scenario wall = free;
  wall.plant.environment = {
      .kind = sim::EnvironmentKind::kHuntCrossley, .stiffness = 0.6, .damping = 0.5, .angle_rad = 0.2};
  for (const int feedforward : {0, 1}) {
    const Felt nothing = swing(free, feedforward);
    const Felt contact = swing(wall, feedforward);
    std::printf("feedforward %d: disturbance %.2f mN m rms and %.2f at most in free motion of %.2f, %.2f at a wall\n",
                feedforward, 1e3 * nothing.rms_nm, 1e3 * nothing.most_nm, 1e3 * nothing.torque_rms_nm,
                1e3 * contact.most_nm);
    EXPECT_LT(nothing.rms_nm, 0.25 * nothing.torque_rms_nm);
    EXPECT_GT(contact.most_nm, 0.0) << "the motor pushes forward against the wall";
    EXPECT_GT(contact.most_nm, 2.0 * std::abs(nothing.most_nm));
  }
}

/// What play friction remembers of a motion before the log has to be forgotten for a comparison to the bit. A slider
/// forgets when it turns; a bristle is rounded at every step, and two that began apart may stay apart by the last bit.
auto without_bristles(EffortLaw law) -> EffortLaw {
  for (const auto& term : *law.joint.catalogue) {
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      if (std::string_view(term.coefficients[i].name) == "bristle") {
        law.joint.parameters.coefficients[term.first_coefficient + i] = 0.0;
      }
    }
  }
  return law;
}

TEST(EffortOnBoard, ReplayInFixedPointIsWhatTheBoardSaysToTheBit) {
  const EffortLaw told = without_bristles(plants_law());
  test::BoardRig rig(sim::Scenario{});
  rig.say(effort_lines(told, "law.toml", 0));
  const BoardEffortLaw law = board_effort_law(told, "law.toml");
  rig.say("arm");
  AxisLog log;
  log.name = "run";
  log.period_s = 0.001;
  constexpr int kCycles = 3000;
  log.time_s = log.q1_rad = log.effort = log.tau_nm = Eigen::VectorXd::Zero(kCycles);
  Eigen::VectorXd said(kCycles);
  for (int i = 0; i < kCycles; ++i) {
    const std::array<double, 1> reference = {0.3 * std::sin(0.002 * i)};
    rig.board.tick(reference);
    log.time_s[i] = 0.001 * i;
    log.q1_rad[i] = rig.joint().q1_rad.to_double();
    log.effort[i] = rig.joint().tau_nm.to_double();
    said[i] = rig.joint().law_torque_nm.to_double();
  }
  const BoardEffort replayed = run_board_effort(log, law, Arithmetic::kFixed);
  EXPECT_EQ(replayed.saturated, 0);
  // A play remembers what was before the log, so it has to turn first.
  for (Eigen::Index i = kCycles / 2; i < kCycles; ++i) {
    ASSERT_EQ(replayed.law[i - replayed.delay], said[i]) << i;
  }
}

TEST(EffortOnBoard, ReplayInFixedPointIsThatInDoubleAndNeedsTheBoardsRate) {
  const BoardEffortLaw law = board_effort_law(plants_law(), "law.toml");
  AxisLog log = read_axis(CsvLog::parse(free_run(), "run.csv"), {.target = "axis0/tau_Nm", .effort = true});
  const BoardEffort fixed = run_board_effort(log, law, Arithmetic::kFixed);
  const BoardEffort exact = run_board_effort(log, law, Arithmetic::kDouble);
  EXPECT_LT((fixed.law - exact.law).cwiseAbs().maxCoeff(), 2e-5);
  EXPECT_LT((fixed.disturbance - exact.disturbance).cwiseAbs().maxCoeff(), 2e-5);
  log.period_s = 0.005;
  EXPECT_THROW(run_board_effort(log, law, Arithmetic::kFixed), Refusal);
}

/// A law with a number in every place that a board has.
auto full_law() -> EffortLaw {
  EffortLaw law;
  law.joint = JointFile(effort_law_catalogue(AxisKind::kRotary));
  law.target = "axis0/tau_Nm";
  law.status = "provisional";
  law.view = {.window_s = 0.08, .averaged = true, .standstill = 0.03};
  double next = 0.01;
  TorqueTerms::for_each<double>([&]<typename Term>() {
    const CatalogueTerm& term = law.joint.catalogue->term(kTorqueTermName<Term>.data());
    law.joint.terms.push_back(term.name);
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      law.joint.parameters.coefficients[term.first_coefficient + i] = next += 0.01;
    }
  });
  return law;
}

TEST(EffortLines, SetEveryParameterOfTheLawAndTheBoardTakesThem) {
  const Lines lines = effort_lines(full_law(), "law.toml", 0);
  EXPECT_EQ(lines.size(), kEffortRows - 1 + 2);  // all but effort.feedforward, which is the user's; begin and commit
  EXPECT_EQ(lines.front(), "begin");
  EXPECT_EQ(lines.back(), "commit");
  test::BoardRig rig{sim::Scenario{}};
  rig.say(lines);
  const AxisConfig& config = rig.board.machine().config()[0];
  for (const Q24 coefficient : config.effort.law.coefficients) {
    EXPECT_NE(coefficient, Q24{});
  }
  // 0.02 kg m2 is 20 N m per krad/s2.
  EXPECT_NE(rig.say("get joint0.effort_inertia.inertia").find(" 20"), std::string::npos);
  EXPECT_EQ(config.effort.status, 1);
  EXPECT_NEAR(config.effort.view.window_s.to_double(), 0.08, 1e-7);
}

auto refusal_of(const EffortLaw& law) -> std::string {
  try {
    effort_lines(law, "law.toml", 0);
  } catch (const BadInput& bad) {
    return bad.what();
  }
  return {};
}

TEST(EffortLines, RefuseWhatNoBoardRunsWithACure) {
  const EffortLaw good = full_law();
  EXPECT_EQ(refusal_of(good), "");
  EffortLaw law = good;
  law.joint.terms.push_back("axis_coupling_axis2");
  EXPECT_NE(refusal_of(law).find("axis 2 brings"), std::string::npos) << refusal_of(law);
  EXPECT_NE(refusal_of(law).find("diagnose the log again with --alone"), std::string::npos) << refusal_of(law);
  law = good;
  law.joint.terms.push_back("transport_delay");
  EXPECT_NE(refusal_of(law).find("no board runs the term transport_delay; take its section out"), std::string::npos)
      << refusal_of(law);
  law = good;
  law.target = "axis0/current_A";
  EXPECT_NE(refusal_of(law).find("explains axis0/current_A"), std::string::npos) << refusal_of(law);
  law = good;
  law.joint.parameters.coefficients[law.joint.catalogue->term("offset").first_coefficient] = 250.0;
  EXPECT_NE(refusal_of(law).find("offset is 250"), std::string::npos) << refusal_of(law);
  EXPECT_NE(refusal_of(law).find("before the gear (of ratio N: --map \"axis0/q1_rad=axis0/q1_rad*N\" --map "
                                 "\"axis0/tau_Nm=axis0/tau_Nm/N\")"),
            std::string::npos)
      << refusal_of(law);
  law.joint.parameters.coefficients[law.joint.catalogue->term("offset").first_coefficient] = std::nan("");
  EXPECT_NE(refusal_of(law), "");
  law = good;
  law.joint = JointFile(gear_law_catalogue());
  EXPECT_NE(refusal_of(law).find("behind a gear"), std::string::npos) << refusal_of(law);
  law.joint = JointFile(effort_law_catalogue(AxisKind::kLinear));
  EXPECT_NE(refusal_of(law).find("linear axis"), std::string::npos) << refusal_of(law);
  EXPECT_NE(refusal_of(law).find("--map \"axis0/q1_rad=axis0/q1_m/R\" --map \"axis0/tau_Nm=axis0/tau_N*R\""),
            std::string::npos)
      << refusal_of(law);
}

TEST(EffortLines, FrictionByAReferenceSpeedBeyondTheBoardsIsTheSameByASlowerOne) {
  constexpr double kLevel = 0.23;
  constexpr double kExponent = 0.3;
  constexpr double kReference = 310.0;  // rad/s: a motor before a gear of 50
  EffortLaw law = full_law();
  const CatalogueTerm& term = law.joint.catalogue->term("power_law_friction");
  for (double& coefficient : law.joint.parameters.coefficients) {
    coefficient = 0.0;
  }
  law.joint.parameters.coefficients[term.first_coefficient] = kLevel;
  law.joint.parameters.shapes[term.first_shape] = kExponent;
  law.joint.parameters.shapes[term.first_shape + 1] = kReference;
  ASSERT_EQ(refusal_of(law), "");
  TorqueLaw<double> runs(SamplePeriod<double>(0.001), board_effort_law(law, "law.toml").law);
  for (const double speed : {0.5, 20.0, 127.0}) {
    Sample<double> sample;
    sample.dq1 = speed;
    EXPECT_NEAR(runs.update(sample).torque_nm, kLevel * std::pow(speed / kReference, kExponent), 1e-6) << speed;
  }
}

}  // namespace
}  // namespace capstan::tools
