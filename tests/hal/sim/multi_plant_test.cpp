// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/multi_plant.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "capstan/hal/sim/deterministic_math.hpp"
#include "capstan/hal/sim/scenario.hpp"
#include "capstan/tests/hal/sim/support.hpp"

namespace capstan::sim {
namespace {

using test::quiet;

std::vector<InstrumentAxis> wrist() {
  std::vector<InstrumentAxis> axes = parse_instrument(built_in_instrument("da_vinci_wrist"), "wrist").axes;
  for (InstrumentAxis& axis : axes)
    axis.plant.camera_noise_rad = axis.plant.tip_force_noise_n = 0.0;
  return axes;
}

double command(int step, int axis) {
  return 0.9 * det_sin(0.003 * static_cast<double>(step) + static_cast<double>(axis));
}

// The largest difference between the joints of `count` uncoupled axes and as many plants of their own.
double difference_from_plants(const PlantParameters& p, int count) {
  std::vector<Plant> plants;
  std::vector<InstrumentAxis> axes;
  for (int i = 0; i < count; ++i) {
    plants.emplace_back(p, 1);
    axes.push_back({"a", p, {}});
  }
  MultiPlant together(axes, 1);
  double worst = 0.0;
  for (int step = 0; step < 4000; ++step) {
    std::vector<MotorCommand> commands;
    for (int i = 0; i < count; ++i) {
      commands.push_back({command(step, i), true});
      plants[static_cast<std::size_t>(i)].step(command(step, i), true);
    }
    together.step(commands);
    for (std::size_t i = 0; i < plants.size(); ++i)
      worst = std::max(worst, std::fabs(together.truth(i).q2_rad - plants[i].truth().q2_rad));
  }
  return worst;
}

TEST(MultiPlant, UncoupledAxesMoveAsPlantsOfTheirOwn) {
  // Two solvers of the same equations, each exact to 1e-10 N m per step.
  EXPECT_LT(difference_from_plants(quiet(), 1), 1.0e-7);
  EXPECT_LT(difference_from_plants(quiet(), 3), 1.0e-7);
  PlantParameters loaded = quiet();
  loaded.effects.play_half_width_rad = 0.02;
  loaded.effects.gravity_torque_nm = 0.01;
  loaded.effects.transmission_viscous_forward_ns_per_m = 800.0;
  EXPECT_LT(difference_from_plants(loaded, 2), 1.0e-6);
}

TEST(MultiPlant, TheSameSeedGivesTheSameBits) {
  MultiPlant a(wrist(), 3);
  MultiPlant b(wrist(), 3);
  for (int step = 0; step < 1500; ++step) {
    const std::array<MotorCommand, 3> commands = {
        {{command(step, 0), true}, {command(step, 1), true}, {command(step, 2), step % 100 < 90}}};
    a.step(commands);
    b.step(commands);
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_EQ(a.truth(i).q2_rad, b.truth(i).q2_rad);
      ASSERT_EQ(a.readings(i).current_a, b.readings(i).current_a);
    }
  }
  EXPECT_NE(a.readings(0).current_a, a.readings(1).current_a);
}

// Steps the pitch motor to `pitch` and back to 0, jaws' motors held; returns the truth at the far end.
std::array<Truth, 3> turn_pitch(MultiPlant& plant, double pitch) {
  std::array<Truth, 3> far;
  for (int step = 1; step <= 4000; ++step) {
    const double share = static_cast<double>(step <= 2000 ? step : 4000 - step) / 2000.0;
    plant.step_kinematic(std::array{pitch * share, 0.0, 0.0});
    if (step == 2000)
      far = {plant.truth(0), plant.truth(1), plant.truth(2)};
  }
  return far;
}

TEST(MultiPlant, ThePitchCarriesTheJawsAlongByTheRatiosOfTable61) {
  MultiPlant plant(wrist(), 1);
  const std::array<Truth, 3> far = turn_pitch(plant, 0.6);
  // Friction of the jaws' tendons holds them back a little: the thesis saw hysteresis in the coupling too (fig. 6.4).
  EXPECT_NEAR(far[1].q2_rad / far[0].q2_rad, 0.674, 0.06);
  EXPECT_NEAR(far[2].q2_rad / far[0].q2_rad, 0.664, 0.06);
  EXPECT_GT(far[1].q2_rad, 0.3);
}

TEST(MultiPlant, TheJawsHardlyMoveThePitch) {
  MultiPlant plant(wrist(), 1);
  double moved = 0.0;
  double jaw = 0.0;
  for (int step = 1; step <= 2000; ++step) {
    plant.step_kinematic(std::array{0.0, 0.5 * static_cast<double>(step) / 2000.0, 0.0});
    moved = std::max(moved, std::fabs(plant.truth(0).q2_rad));
    jaw = plant.truth(1).q2_rad;
  }
  EXPECT_GT(jaw, 0.3);
  EXPECT_LT(moved, 0.05 * jaw);
}

TEST(MultiPlant, TheCoupledTendonsPullOnThePitchWithTheirRadius) {
  // All joints locked but the pitch, which is held by a spring: the spring carries carried_radius times the jaw's
  // tension difference, and what the pitch's own tendons give.
  std::vector<InstrumentAxis> axes = wrist();
  axes[0].plant.joint_coulomb_nm = 0.0;
  axes[0].plant.joint_viscous_nms_per_rad = 0.0;
  axes[0].plant.environment = {.kind = EnvironmentKind::kSpring, .stiffness = 0.2};
  axes[1].plant.environment.kind = EnvironmentKind::kLocked;
  axes[2].plant.environment.kind = EnvironmentKind::kLocked;
  MultiPlant plant(axes, 1);
  for (int step = 1; step <= 1000; ++step)
    plant.step_kinematic(std::array{0.0, 0.4 * static_cast<double>(step) / 1000.0, 0.0});
  const double jaw_difference_n = plant.truth(1).tau_out_nm / axes[1].plant.output_radius_m;
  const double left_difference_n = plant.truth(2).tau_out_nm / axes[2].plant.output_radius_m;
  const double expected = plant.truth(0).tau_out_nm - axes[1].carried_radius_m[0] * jaw_difference_n -
                          axes[2].carried_radius_m[0] * left_difference_n;
  EXPECT_GT(std::fabs(jaw_difference_n), 10.0);
  EXPECT_NEAR(0.2 * plant.truth(0).q2_rad, expected, 1.0e-6);
}

TEST(MultiPlant, StaysStableWhenCoupledTendonsAreVeryStiff) {
  for (const double stiffness : {1.0e2, 1.0e6, 1.0e8}) {
    std::vector<InstrumentAxis> axes = wrist();
    for (InstrumentAxis& axis : axes)
      axis.plant.stiffness_top_n_per_m = axis.plant.stiffness_bottom_n_per_m = stiffness;
    MultiPlant plant(axes, 1);
    for (int step = 0; step < 1000; ++step) {
      const std::array<MotorCommand, 3> commands = {{{command(step, 0) - 5.0 * plant.truth(0).q1_rad, true},
                                                     {command(step, 1) - 5.0 * plant.truth(1).q1_rad, true},
                                                     {command(step, 2) - 5.0 * plant.truth(2).q1_rad, true}}};
      plant.step(commands);
      for (std::size_t i = 0; i < 3; ++i)
        ASSERT_LT(std::fabs(plant.truth(i).q2_rad), 3.0) << stiffness;
    }
    EXPECT_LT(plant.drivetrain().relaxations(), 5U) << stiffness;
  }
}

TEST(MultiPlant, AFaultHitsItsAxisOnly) {
  Scenario scenario = parse_scenario(
      "instrument = \"da_vinci_wrist\"\n[[faults]]\naxis = \"left_jaw\"\ntarget = \"encoder\"\nkind = \"off\"\n"
      "time_s = 0.01\n",
      "x.toml");
  MultiPlant plant(scenario);
  const std::vector<MotorCommand> commands(3);
  for (int step = 0; step < 20; ++step)
    plant.step(commands);
  EXPECT_TRUE(plant.readings(0).encoder_ok && plant.readings(1).encoder_ok);
  EXPECT_FALSE(plant.readings(2).encoder_ok);
}

TEST(MultiPlant, WrongNumbersOfAxesAreRefused) {
  EXPECT_THROW(MultiPlant({}, 1), std::invalid_argument);
  std::vector<InstrumentAxis> axes = wrist();
  axes[1].plant.substeps = 8;
  EXPECT_THROW(MultiPlant(axes, 1), std::invalid_argument);
  MultiPlant plant(wrist(), 1);
  EXPECT_THROW(plant.step(std::vector<MotorCommand>(2)), std::invalid_argument);
  EXPECT_THROW(plant.step(std::vector<MotorCommand>(3, {std::numeric_limits<double>::quiet_NaN(), true})),
               std::runtime_error);
  EXPECT_THROW(plant.schedule({.axis = 3}), std::invalid_argument);
}

}  // namespace
}  // namespace capstan::sim
