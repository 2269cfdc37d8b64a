// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/instrument.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "capstan/hal/sim/multi_plant.hpp"
#include "capstan/hal/sim/scenario.hpp"

namespace capstan::sim {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(CAPSTAN_SOURCE_DIR) / "hal/sim/instruments";

void expect_refused(const std::string& text, int line, const std::string& about) {
  try {
    static_cast<void>(parse_instrument(text, "bad.toml"));
    ADD_FAILURE() << "accepted: " << text;
  } catch (const ScenarioError& error) {
    const std::string said = error.what();
    EXPECT_TRUE(said.starts_with("bad.toml:" + std::to_string(line) + ": ")) << said;
    EXPECT_NE(said.find(about), std::string::npos) << said;
    EXPECT_NE(said.find("; "), std::string::npos) << "no cure in: " << said;
  }
}

TEST(Instrument, EveryFileIsBuiltInUnderItsName) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(kFolder)) {
    std::ifstream stream(entry.path());
    const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    EXPECT_EQ(built_in_instrument(entry.path().stem().string()), text) << entry.path();
    EXPECT_EQ(built_in_instrument(entry.path().filename().string()), text) << entry.path();
    EXPECT_FALSE(parse_instrument(text, entry.path()).name.empty());
    ++count;
  }
  EXPECT_EQ(count, 4);
  EXPECT_TRUE(built_in_instrument("lute").empty());
}

TEST(Instrument, TheWristHasTheRatiosOfTable61) {
  const Instrument wrist = parse_instrument(built_in_instrument("da_vinci_wrist"), "wrist");
  ASSERT_EQ(wrist.axes.size(), 3U);
  const std::array<double, 3> beta = {0.996, 1.109, 1.138};
  const std::array<double, 3> top = {-0.424, -1.907, -1.047};
  const std::array<double, 3> bottom = {-2.828, -1.054, -0.541};
  for (std::size_t i = 0; i < 3; ++i) {
    const PlantParameters& p = wrist.axes[i].plant;
    EXPECT_NEAR(p.input_radius_m / p.output_radius_m, beta[i], 1.0e-3);
    const auto alpha = [&](double eta, double stiffness) {
      return -(1.0 - std::exp(-eta)) / (p.input_radius_m * p.output_radius_m * eta * stiffness);
    };
    EXPECT_NEAR(alpha(p.eta_top, p.stiffness_top_n_per_m), top[i], 0.002 * std::fabs(top[i]));
    EXPECT_NEAR(alpha(p.eta_bottom, p.stiffness_bottom_n_per_m), bottom[i], 0.002 * std::fabs(bottom[i]));
  }
  EXPECT_NEAR(wrist.axes[1].carried_radius_m[0] / wrist.axes[1].plant.output_radius_m, 0.674, 1.0e-3);
  EXPECT_NEAR(wrist.axes[2].carried_radius_m[0] / wrist.axes[2].plant.output_radius_m, 0.664, 1.0e-3);
}

TEST(Instrument, RavensElbowHasTheDriveRatioOfItsGearAndRadii) {
  const Instrument raven = parse_instrument(built_in_instrument("raven2"), "raven2");
  ASSERT_EQ(raven.axes.size(), 3U);
  EXPECT_EQ(raven.axes[1].name, "elbow");
  const PlantParameters& elbow = raven.axes[1].plant;
  EXPECT_NEAR(elbow.input_radius_m / elbow.output_radius_m, 0.8098, 1.0e-4);
  EXPECT_NEAR(elbow.input_radius_m, 56.298e-3 / 12.25, 1.0e-8);
}

TEST(Instrument, EveryBuiltInMovesUnderItsOwnMotors) {
  for (const char* name : {"micro_forceps", "da_vinci_wrist", "raven2", "robot_finger"}) {
    const Instrument instrument = parse_instrument(built_in_instrument(name), name);
    MultiPlant plant(instrument.axes, 1);
    std::vector<MotorCommand> commands(plant.axis_count());
    for (int i = 0; i < 1500; ++i) {
      for (std::size_t a = 0; a < commands.size(); ++a) {
        const Truth& t = plant.truth(a);
        const double limit = plant.parameters(a).current_limit_a;
        const double wanted = 0.4 * std::sin(0.004 * static_cast<double>(i));
        commands[a] = {
            std::clamp(8.0 * limit * (wanted - t.q1_rad) - 0.05 * limit * t.q1_rate_rad_per_s, -limit, limit), true};
      }
      plant.step(commands);
    }
    for (std::size_t a = 0; a < commands.size(); ++a) {
      const double ratio = plant.parameters(a).input_radius_m / plant.parameters(a).output_radius_m;
      EXPECT_GT(std::fabs(plant.truth(a).q1_rad), 0.02) << name << a;
      EXPECT_LT(std::fabs(plant.truth(a).q1_rad), 0.6) << name << a;
      EXPECT_GT(std::fabs(plant.truth(a).q2_rad), 0.02 * ratio) << name << a;
    }
  }
}

TEST(Instrument, MistakesAreRefusedWhereTheyStand) {
  expect_refused("[plant]\ninput_radius_mm = 2.6\n", 2, "`input_radius_m`");
  expect_refused("[plant]\ninput_radius = 2.6\n", 2, "`input_radius_m`");
  expect_refused("[plant]\nstiffness_top_n_per_mm = 50\n", 2, "`stiffness_top_n_per_m`");
  expect_refused("[plant]\njoint_inertia_gcm2 = 50\n", 2, "`joint_inertia_kgm2`");
  expect_refused("[plant]\ncurrent_limit_ma = 50\n", 2, "`current_limit_a`");
  expect_refused("[plant]\nstiffness_top_n_per_m = -1.0\n", 2, "-1");
  expect_refused("[plant]\ninput_radius_m = 0\n", 2, "input_radius_m");
  expect_refused("name = 3\n", 1, "name");
  expect_refused("nam = \"x\"\n", 1, "`nam`");
  expect_refused("[motion]\n", 1, "`motion`");
  expect_refused("[[axes]]\n[axes.plant]\neta_top = 1\n", 1, "name");
  expect_refused("[[axes]]\nname = \"a\"\n[[axes]]\nname = \"a\"\n", 3, "two axes `a`");
  expect_refused("[[axes]]\nname = \"a\"\ncarried_radius_m = { b = 0.001 }\n", 3, "`b`");
  expect_refused("[[axes]]\nname = \"a\"\ncarried_radius_m = { a = 0.001 }\n", 3, "`a`");
  expect_refused("[[axes]]\nname = \"a\"\n[[axes]]\nname = \"b\"\ncarried_radius_m = { a = 2.0 }\n", 5, "in m");
  expect_refused("[[axes]]\nname = \"a\"\n[[axes]]\nname = \"b\"\n[axes.plant]\nsubsteps = 8\n", 3, "substeps");
  expect_refused("[plant]\neta_top = 1\n[[axes]]\nname = \"a\"\n", 1, "`plant`");
  expect_refused("axes = []\n", 1, "axes");
}

TEST(Instrument, ScenariosSpeakOfEachAxis) {
  const Scenario s = parse_scenario(
      "instrument = \"da_vinci_wrist\"\n[effects]\nplay = 0.01\n[[axes]]\naxis = \"left_jaw\"\n[axes.effects]\nplay = "
      "0.02\n"
      "[axes.motion]\n[[axes.motion.segments]]\nkind = \"hold\"\nduration_s = 7\noffset_rad = 0.2\n",
      "x.toml");
  EXPECT_EQ(s.axis_name, "pitch");
  ASSERT_EQ(s.other_axes.size(), 2U);
  EXPECT_EQ(s.plant.effects.play_half_width_rad, 0.01);
  EXPECT_EQ(s.other_axes[0].joint.plant.effects.play_half_width_rad, 0.0);
  EXPECT_EQ(s.other_axes[1].joint.plant.effects.play_half_width_rad, 0.02);
  EXPECT_NEAR(s.other_axes[1].motion.reference_rad(3.0), 0.2, 1.0e-12);
  EXPECT_NEAR(s.duration_s, 7.5, 1.0e-12);
  for (const char* bad :
       {"[[axes]]\naxis = \"thumb\"\n", "[[axes]]\n[axes.effects]\nplay = 0.1\n",
        "[[axes]]\naxis = \"pitch\"\ncolour = 3\n", "[[axes]]\naxis = \"pitch\"\n[axes.plant]\neta_top = -1\n"}) {
    EXPECT_THROW(static_cast<void>(parse_scenario("instrument = \"da_vinci_wrist\"\n" + std::string(bad), "x.toml")),
                 ScenarioError)
        << bad;
  }
}

}  // namespace
}  // namespace capstan::sim
