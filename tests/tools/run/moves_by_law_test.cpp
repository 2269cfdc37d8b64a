// SPDX-License-Identifier: Apache-2.0
// From a recipe's log to a joint that moves and holds by the law that was made of it, as its user goes. Truth is the
// plant's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "capstan/tests/tools/run/board_rig.hpp"
#include "capstan/tools/apply/model_lines.hpp"
#include "capstan/tools/apply/plausible_law.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/run/run.hpp"

namespace capstan::tools {
namespace {

auto scenario_of(const std::string& name, std::uint64_t seed) -> sim::Scenario {
  sim::Scenario scenario = sim::load_scenario(CAPSTAN_SOURCE_DIR "/tools/scenarios/" + name);
  scenario.seed = seed;
  return scenario;
}

auto record(const sim::Scenario& scenario) -> CsvLog {
  std::ostringstream text;
  FileBanks banks = FileBanks::temporary();
  EXPECT_EQ(run_scenario(scenario, {}, banks, &text).fault, "");
  return CsvLog::parse(text.str(), "run.csv");
}

/// The true joint during a move and the hold behind it.
struct Hold {
  double fastest_rad = 0.0;  ///< within 8 ms
  double low = 1e9;          ///< from 3 s after the move was asked for
  double high = -1e9;
};

auto move_and_hold(test::BoardRig& rig, int joint, double to_rad, double hold_s) -> Hold {
  for (const char c : "move joint" + std::to_string(joint) + " " + std::to_string(to_rad) + "\n") {
    rig.board.shell().receive(c);
  }
  Hold hold;
  std::vector<double> way;
  for (long ms = 0; ms < std::lround(hold_s * 1e3); ++ms) {
    rig.board.tick();
    rig.board.shell().poll();
    way.push_back(rig.board.truth(static_cast<std::size_t>(joint)).q2_rad);
    if (ms >= 8) {
      hold.fastest_rad = std::max(hold.fastest_rad, std::abs(way.back() - way[way.size() - 9]));
    }
    if (ms >= 3000) {
      hold.low = std::min(hold.low, way.back());
      hold.high = std::max(hold.high, way.back());
    }
  }
  EXPECT_EQ(rig.sink.take().find("error "), std::string::npos);
  EXPECT_EQ(rig.board.machine().telemetry().first_fault, Fault::kNone) << "move to " << to_rad;
  return hold;
}

/// A log of the scenario, the law that `diagnose` makes of it, and moves by it on the same plant.
void expect_moves(const std::string& name, std::uint64_t seed) {
  const sim::Scenario scenario = scenario_of(name, seed);
  const JointFile law = diagnose({read_axis(record(scenario), {.needs_torque = true})}, {}).law;
  EXPECT_EQ(implausible(law), "");
  test::BoardRig rig(scenario);
  rig.say(model_lines(law, 0));
  rig.say(std::vector<std::string>{"maintenance open", "arm"});
  for (const double to_rad : {0.3, -0.3, 0.2, 0.3, -0.3}) {
    const Hold hold = move_and_hold(rig, 0, to_rad, 60.0);
    EXPECT_LT(hold.fastest_rad, 0.02) << "limits.joint_speed allows 0.016";
    EXPECT_LT(hold.high - hold.low, 0.001) << "it stands";
    EXPECT_NEAR(hold.low, to_rad, 0.005);
  }
}

TEST(MovesByLaw, OfAHealthyJointByItsRecipeNeedNoForceAndEndInNoFault) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    expect_moves("identify.toml", seed);
  }
}

TEST(MovesByLaw, OfAJointWithPlayEndInNoFaultHoweverLongItHeld) {
  expect_moves("identify_play.toml", 1);
}

TEST(MovesByLaw, OfAWristHoldWithoutHunting) {
  const sim::Scenario scenario = scenario_of("recipe_multi_dof.toml", 5);
  const CsvLog log = record(scenario);
  test::BoardRig rig(scenario);
  for (const int axis : {0, 1, 2}) {
    LawForm form;
    form.terms = terms_of_model(axis == 0 ? "pseudo_kinematic" : "multi_dof");  // the pitch pulls at the jaws
    const AxisRequest columns{.axis = axis, .needs_torque = true, .other_axes = {0}};
    rig.say(model_lines(identify({read_axis(log, columns)}, form).joint, axis));
  }
  rig.say(std::vector<std::string>{"maintenance open", "arm"});
  for (const double to_rad : {0.2, -0.2}) {
    const Hold hold = move_and_hold(rig, 2, to_rad, 80.0);
    EXPECT_LT(hold.high - hold.low, 0.001) << "it stands";
    EXPECT_NEAR(hold.low, to_rad, 0.01);
  }
}

}  // namespace
}  // namespace capstan::tools
