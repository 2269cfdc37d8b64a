// SPDX-License-Identifier: Apache-2.0
// Force within a corridor of motion (thesis 8.2.1) on the simulated instrument: the law of tendons says angle and
// torque whatever the tip touches, the force law turns the torque round.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/tests/tools/plant/hybrid.hpp"
#include "capstan/tests/tools/run/force_rig.hpp"
#include "capstan/tests/tools/run/recipe_log.hpp"
#include "capstan/tools/apply/force_lines.hpp"
#include "capstan/tools/apply/model_lines.hpp"
#include "capstan/tools/identify/force_section.hpp"

namespace capstan::tools {
namespace {

/// A law of tendons: angle and torque, whatever the tip touches.
auto motion_law(const sim::PlantParameters& instrument) -> test::Lines {
  test::Lines lines = model_lines(plant::hybrid_law(instrument, 9031), 0);
  std::erase_if(lines, [](const std::string& line) { return !line.starts_with("set "); });  // 'begin' and 'commit'
  return lines;
}

/// Of the microforceps. Their friction lets a motor feel a third of what presses on the tip.
auto laws() -> const test::Lines& {
  static const test::Lines lines = [] {
    test::Lines all = motion_law({});
    const std::string section = force_section(fit_pull_push({test::record("recipe_pull_push.toml")}));
    for (const std::string& line : force_lines(with_force_section("", section), "joint.toml", 0)) {
      all.push_back(line);
    }
    return all;
  }();
  return lines;
}

auto spring(double nm_per_rad) -> sim::Environment {
  return {.kind = sim::EnvironmentKind::kSpring, .stiffness = nm_per_rad};
}

struct Guarded : test::ForceRig {
  using ForceRig::ForceRig;
  /// Lets it go on, and notes the furthest true angle, the largest step of the current and every change of control.
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      application.rt_tick();
      furthest_rad = std::max(furthest_rad, std::abs(plant.truth().q2_rad));
      const double drive_a = joint().drive_a.to_double();
      largest_step_a = std::max(largest_step_a, std::abs(drive_a - last_a));
      last_a = drive_a;
      changes += joint().mode != last_mode ? 1 : 0;
      last_mode = joint().mode;
      ASSERT_TRUE(energised(application.telemetry().state)) << i;
    }
  }
  [[nodiscard]] auto held_at_edge() const -> bool {
    return joint().mode == ControlMode::kPosition && (joint().limits & bit(Limit::kCorridor)) != 0 && !joint().moving;
  }
  double furthest_rad = 0.0;
  double largest_step_a = 0.0;
  double last_a = 0.0;
  int changes = 0;
  ControlMode last_mode = ControlMode::kPosition;
};

// A free tip runs under any torque beyond its friction.
TEST(ForceCorridor, BringsAJointThatRunsToItsEdgeAndToTheOtherWhenTheOtherWayIsWanted) {
  Guarded rig(sim::Environment{}, laws());
  rig.say("move joint0 force=0.03Nm rate=0.05Nm/s corridor=0.15rad");
  rig.run(5000);
  EXPECT_TRUE(rig.held_at_edge());
  EXPECT_NEAR(rig.plant.truth().q2_rad, 0.15, 0.01);
  rig.say("move joint0 force=-0.03Nm rate=0.2Nm/s corridor=0.15rad");
  rig.run(5000);
  EXPECT_TRUE(rig.held_at_edge());
  EXPECT_NEAR(rig.plant.truth().q2_rad, -0.15, 0.01) << "about where the corridor was laid, not where it was asked for";
  std::printf("a free tip in a corridor of 0.15 rad to either side went to %.3f rad\n", rig.furthest_rad);
  EXPECT_LT(rig.furthest_rad, 0.15 + 0.05) << "limits.fault_travel";
  EXPECT_LE(rig.changes, 6);
}

// Soft tissue takes 0.03 Nm at 0.3 rad. In a narrower corridor the joint presses less, in a wider one as wanted.
TEST(ForceCorridor, PressesLessThanWantedAtItsEdgeAndAsWantedWhereThereIsRoom) {
  Guarded rig(spring(0.1), laws());
  rig.say("move joint0 force=0.03Nm rate=0.02Nm/s corridor=0.15rad");
  rig.run(6000);
  EXPECT_TRUE(rig.held_at_edge());
  EXPECT_NEAR(rig.plant.truth().q2_rad, 0.15, 0.015);
  EXPECT_LT(rig.furthest_rad, 1.2 * 0.15);
  EXPECT_NEAR(rig.plant.truth().tau_out_nm, 0.015, 0.004);
  rig.say("move joint0 force=0.03Nm rate=0.02Nm/s corridor=0.5rad");
  rig.run(6000);
  EXPECT_EQ(rig.joint().mode, ControlMode::kForce);
  EXPECT_NEAR(rig.plant.truth().tau_out_nm, 0.03, 0.03 * 0.03);
  EXPECT_EQ(rig.joint().limits & bit(Limit::kCorridor), 0);
  EXPECT_LE(rig.changes, 4);
}

// A spring whose end comes nearer. Tendons with next to no friction, so that the motor feels the tip.
TEST(ForceCorridor, GivesWayToWhatPressesItBackAndStopsAtTheOtherEdge) {
  sim::PlantParameters instrument;
  instrument.eta_top = instrument.eta_bottom = 0.05;
  instrument.motor_coulomb_nm = 0.0005;
  instrument.environment = spring(0.3);
  const double pretension_nm = instrument.pretension_n * instrument.input_radius_m / 2.0;
  test::Lines law = motion_law(instrument);
  law.insert(law.end(),
             {"set joint0.force.law 2", "set joint0.force.eta_top 0.05", "set joint0.force.eta_bottom 0.05",
              "set joint0.force.pretension " + std::to_string(pretension_nm) + " Nm",
              "set joint0.force.ratio " + std::to_string(instrument.output_radius_m / instrument.input_radius_m)});
  Guarded rig(instrument, law);
  double angle = 0.0;
  const auto come_nearer = [&](double way_rad) {
    for (int i = 0; i < 4000; ++i) {
      angle -= way_rad / 4000.0;
      rig.plant.move_environment(angle);
      rig.run(1);
    }
    rig.run(1000);
  };
  rig.say("move joint0 force=0.03Nm rate=0.05Nm/s corridor=0.05rad");
  rig.run(3000);
  ASSERT_TRUE(rig.held_at_edge());
  EXPECT_LT(rig.plant.truth().tau_out_nm, 0.02);
  come_nearer(0.1);  // at the edge it would take 0.3 * 0.15 Nm; 0.03 Nm are at 0 rad
  EXPECT_EQ(rig.joint().mode, ControlMode::kForce);
  EXPECT_NEAR(rig.plant.truth().tau_out_nm, 0.03, 0.005);
  EXPECT_NEAR(rig.plant.truth().q2_rad, 0.0, 0.02);
  EXPECT_LE(rig.changes, 4);
  come_nearer(0.15);  // 0.03 Nm would let it go to -0.15 rad
  EXPECT_TRUE(rig.held_at_edge());
  EXPECT_GT(rig.plant.truth().q2_rad, -0.05 - 0.03);
  EXPECT_GT(rig.plant.truth().tau_out_nm, 0.045);
  EXPECT_LE(rig.changes, 6) << "no to and fro between the two";
}

TEST(ForceCorridor, IsLiftedByHoldAndRefusedBelowZero) {
  Guarded rig(spring(0.1), laws());
  rig.say("move joint0 force=0.03Nm rate=0.02Nm/s corridor=0.1rad");
  rig.run(4000);
  ASSERT_NE(rig.joint().limits & bit(Limit::kCorridor), 0);
  EXPECT_NE(rig.say("status").find("the corridor of force control"), std::string::npos);
  rig.say("hold joint0");
  rig.run(500);
  EXPECT_EQ(rig.joint().mode, ControlMode::kPosition);
  EXPECT_EQ(rig.joint().limits & bit(Limit::kCorridor), 0);
  for (const char c : std::string("move joint0 force=0.03Nm corridor=-1rad\n")) {
    rig.shell.receive(c);
  }
  rig.shell.poll();
  EXPECT_NE(rig.sink.take().find("error range: a corridor is an angle to either side"), std::string::npos);
}

}  // namespace
}  // namespace capstan::tools
