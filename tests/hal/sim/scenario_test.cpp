// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/scenario.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "capstan/hal/sim/fields.hpp"
#include "capstan/hal/sim/plant.hpp"

namespace capstan::sim {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = CAPSTAN_SOURCE_DIR;

const char* const kGood = R"(seed = 5
instrument = "micro_forceps"
shell = ["set joint0.control.kp 4", "arm"]

[plant]
joint_coulomb_nm = 0.004
element_count = 24

[environment]
kind = "spring"
stiffness = 0.2

[effects]
play = { half_width_rad = 0.03 }
transport_delay = 0.02

[[faults]]
time_s = 3.0
target = "encoder"
kind = "jump"
amount = 400
duration_s = 0.5

[motion]
repeat = 2
blend_s = 0.25

[[motion.segments]]
kind = "sine"
duration_s = 4
amplitude_rad = 0.5
frequency_hz = 0.5

[[motion.segments]]
kind = "hold"
duration_s = 1.0
offset_rad = 0.2
)";

// What the reader says about the text, or "" if it accepts it.
std::string refusal(const std::string& text) {
  try {
    static_cast<void>(parse_scenario(text, "folder/bad.toml"));
    return "";
  } catch (const ScenarioError& error) {
    return error.what();
  }
}

void expect_refused(const std::string& text, int line, const std::string& about) {
  const std::string said = refusal(text);
  EXPECT_TRUE(said.starts_with(std::string("folder/bad.toml:").append(std::to_string(line)).append(": "))) << said;
  EXPECT_NE(said.find(about), std::string::npos) << said;
  EXPECT_NE(said.find("; "), std::string::npos) << "no cure in: " << said;
}

TEST(Scenario, ReadsEveryKindOfKey) {
  const Scenario s = parse_scenario(kGood, "folder/good.toml");
  EXPECT_EQ(s.name, "good");
  EXPECT_EQ(s.seed, 5U);
  ASSERT_EQ(s.shell.size(), 2U);
  EXPECT_EQ(s.shell[0], "set joint0.control.kp 4");
  EXPECT_EQ(s.plant.joint_coulomb_nm, 0.004);
  EXPECT_EQ(s.plant.element_count, 24);
  EXPECT_EQ(s.plant.environment.kind, EnvironmentKind::kSpring);
  EXPECT_EQ(s.plant.effects.play_half_width_rad, 0.03);
  EXPECT_EQ(s.plant.effects.transport_delay_s, 0.02);
  ASSERT_EQ(s.faults.size(), 1U);
  EXPECT_EQ(s.faults[0].kind, FaultKind::kJump);
  EXPECT_EQ(s.faults[0].amount, 400.0);
  EXPECT_NEAR(s.duration_s, 2.0 * 5.0 + 0.25, 1.0e-12);
  EXPECT_NEAR(s.motion.reference_rad(4.7), 0.2, 1.0e-12);
}

TEST(Scenario, UnknownKeysAreRefusedWhereTheyStand) {
  expect_refused("seed = 1\nsped = 2\n", 2, "`sped`");
  expect_refused("[plant]\n\nstifness_top_n_per_m = 5e4\n", 3, "stifness_top_n_per_m");
  expect_refused("[effects]\nflubber = 1.0\n", 2, "flubber");
  expect_refused("[effects]\nplay = { width = 1.0 }\n", 2, "play.width");
  expect_refused("[motion]\n[[motion.segments]]\nkind = \"hold\"\nduration_s = 1\nspeed = 3\n", 5, "`speed`");
  expect_refused("[environment]\nkind = \"honey\"\n", 2, "honey");
}

TEST(Scenario, WhatPlaysNoPartIsRefusedInsteadOfForgotten) {
  expect_refused("[environment]\nstiffness = 0.2\n", 2, "`stiffness` plays no part");
  expect_refused("[environment]\nkind = \"spring\"\nstiffness = 0.2\ndamping = 0.1\n", 4, "`damping` plays no part");
  expect_refused("[environment]\nstiffness = 0.2\nlayer_depth_rad = 0.1\nkind = \"hunt_crossley\"\n", 3,
                 "`layer_depth_rad` plays no part");
  const auto segment = [](const std::string& lines) { return "[motion]\n[[motion.segments]]\n" + lines + "\n"; };
  expect_refused(segment("kind = \"sine\"\nduration_s = 2\nfrequency_hz = 1\ndecay_per_s = 1"), 6, "`decay_per_s`");
  expect_refused(segment("kind = \"hold\"\nduration_s = 2\namplitude_rad = 1"), 5, "`amplitude_rad`");
  expect_refused(segment("frequency_hz = 1\nkind = \"multisine\"\nduration_s = 2"), 3, "`frequency_hz`");
  expect_refused(segment("kind = \"wobble\"\nduration_s = 2"), 3, "sine_ladder");
  expect_refused(segment("duration_s = 2"), 2, "lacks `kind`");
  // Of every environment its own numbers are taken.
  for (const char* good : {"kind = \"spring\"\nstiffness = 0.2\nangle_rad = 0.1",
                           "damping = 0.1\nstiffness = 0.2\nkind = \"kelvin_voigt\"",
                           "kind = \"layered\"\nstiffness = 0.2\ndeep_stiffness = 0.1\nsite_step_m = 0.01"}) {
    EXPECT_EQ(refusal(std::string("[environment]\n") + good + "\n"), "") << good;
  }
}

TEST(Scenario, TheSolversModeIsAWord) {
  EXPECT_EQ(parse_scenario("[plant]\nmode = \"dynamic\"\n", "x.toml").plant.mode, SolverMode::kDynamic);
  EXPECT_EQ(parse_scenario("seed = 2\n", "x.toml").plant.mode, SolverMode::kQuasiStatic);
  expect_refused("[plant]\nmode = \"fast\"\n", 2, "quasi_static, dynamic");
  expect_refused("[plant]\nmode = 2\n", 2, "mode");
}

TEST(Scenario, WrongTypesAreRefusedWhereTheyStand) {
  expect_refused("seed = \"one\"\n", 1, "seed");
  expect_refused("seed = 1\nshell = \"arm\"\n", 2, "shell");
  expect_refused("shell = [\"arm\",\n 3]\n", 2, "shell");
  expect_refused("[plant]\neta_top = \"big\"\n", 2, "eta_top");
  expect_refused("plant = 3\n", 1, "plant");
  expect_refused("[plant]\nelement_count = 16.5\n", 2, "element_count");
  expect_refused("[plant]\neta_top = nan\n", 2, "eta_top");
}

TEST(Scenario, ImpossibleNumbersAreRefusedWhereTheyStand) {
  expect_refused("[plant]\nstiffness_top_n_per_m = -5.0\n", 2, "stiffness_top_n_per_m is -5");
  expect_refused("[plant]\ninput_radius_m = 0.0\n", 2, "input_radius_m");
  expect_refused("[effects]\nplay = -0.1\n", 2, "play is -0.1");
  expect_refused("duration_s = -3\n", 1, "duration_s");
  for (const char* length : {"-1", "0", "1e308"}) {
    const std::string segment = "[[motion.segments]]\nkind = \"hold\"\nduration_s = " + std::string(length) + "\n";
    expect_refused("[motion]\n" + segment, 2, "duration_s must be above 0 and at most 1e6");
  }
  expect_refused("[[faults]]\ntime_s = 1\ntarget = \"amplifier\"\nkind = \"nan\"\n", 1, "amplifier");
  expect_refused("[[faults]]\ntime_s = 1\nkind = \"nan\"\n", 1, "lacks `target`");
  expect_refused("[motion]\n\n[[motion.segments]]\nkind = \"sine\"\nduration_s = 2\n", 3, "frequency_hz");
  expect_refused("[motion]\nrepeat = 0\n[[motion.segments]]\nkind = \"hold\"\nduration_s = 2\n", 1, "repeat");
}

TEST(Scenario, BrokenTomlAndMissingFilesAreRefused) {
  expect_refused("seed = 1\n[plant\n", 2, "TOML");
  expect_refused("instrument = \"nothing.toml\"\n", 1, "nothing.toml");
  EXPECT_THROW(static_cast<void>(load_scenario("no/such/file.toml")), ScenarioError);
}

TEST(Scenario, EffectsCanBeOverriddenFromTheCommandLine) {
  Scenario s = parse_scenario(kGood, "good.toml");
  override_effect(s, "play=0.01");
  EXPECT_EQ(s.plant.effects.play_half_width_rad, 0.01);
  override_effect(s, "transmission_viscous=900");
  EXPECT_EQ(s.plant.effects.transmission_viscous_forward_ns_per_m, 900.0);
  EXPECT_EQ(s.plant.effects.transmission_viscous_backward_ns_per_m, 900.0);
  override_effect(s, "transmission_viscous.backward_ns_per_m=100");
  EXPECT_EQ(s.plant.effects.transmission_viscous_forward_ns_per_m, 900.0);
  EXPECT_EQ(s.plant.effects.transmission_viscous_backward_ns_per_m, 100.0);
  for (const char* bad : {"play", "=1", "play=", "play=wide", "play=0.01x", "ply=0.01", "play=-1"}) {
    EXPECT_THROW(override_effect(s, bad), ScenarioError) << bad;
  }
  EXPECT_EQ(s.plant.effects.play_half_width_rad, 0.01);
}

TEST(Scenario, AFaultsNumberThatIsNoneIsWrittenAsItsOwn) {
  try {
    static_cast<void>(parse_fault("encoder stuck for nan"));
    FAIL();
  } catch (const ScenarioError& error) {
    EXPECT_NE(std::string(error.what()).find("`nan` is not a number; write it like for 3"), std::string::npos)
        << error.what();
  }
}

TEST(Scenario, TheInstrumentFileIsTheBuiltInInstrument) {
  const fs::path folder = kRoot / "hal/sim/instruments";
  ASSERT_TRUE(fs::exists(folder / "micro_forceps.toml"));
  const Scenario from_file = parse_scenario("instrument = \"micro_forceps.toml\"\n", "x.toml", folder);
  const PlantParameters built_in;
  for (const auto& field : plant_fields()) {
    EXPECT_EQ(from_file.plant.*field.member, built_in.*field.member) << field.name;
  }
  // A field that the file leaves out would agree by default: each must be there.
  std::ifstream stream(folder / "micro_forceps.toml");
  const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  for (const auto& field : plant_fields()) {
    EXPECT_NE(text.find(std::string("\n").append(field.name).append(" = ")), std::string::npos) << field.name;
  }
}

TEST(Scenario, ExampleScenariosLoadAndDifferOnlyInTheirEffect) {
  const fs::path folder = kRoot / "tools/scenarios";
  for (const std::string motion : {"identify", "validate"}) {
    const Scenario plain = load_scenario(folder / (motion + ".toml"), kRoot / "hal/sim/instruments");
    EXPECT_GT(plain.duration_s, 30.0);
    for (const std::string effect : {"play", "transmission_viscous", "transport_delay", "pretension"}) {
      const Scenario with = load_scenario(folder / (motion + "_" + effect + ".toml"), kRoot / "hal/sim/instruments");
      EXPECT_EQ(with.duration_s, plain.duration_s);
      EXPECT_EQ(with.seed, plain.seed);
      for (double t = 0.0; t < plain.duration_s; t += 0.37) {
        ASSERT_EQ(with.motion.reference_rad(t), plain.motion.reference_rad(t));
      }
      int changed = 0;
      for (const auto& field : effect_fields()) {
        if (with.plant.effects.*field.member == plain.plant.effects.*field.member)
          continue;
        ++changed;
        EXPECT_EQ(field.effect, effect);
      }
      EXPECT_GT(changed, 0) << effect;
    }
  }
}

TEST(Scenario, IdentificationMotionCoversADecadeOfSpeedsWithinTheJointsRange) {
  const Scenario s = load_scenario(kRoot / "tools/scenarios/identify.toml");
  EXPECT_EQ(s.motion.repeat(), 4);
  EXPECT_NEAR(s.motion.cycle_s(), 15.0, 1.0e-12);
  double fastest = 0.0;
  double furthest = 0.0;
  for (double t = 0.0; t < s.duration_s; t += 0.001) {
    fastest = std::max(fastest, std::fabs(s.motion.at(t).rate_rad_per_s));
    furthest = std::max(furthest, std::fabs(s.motion.reference_rad(t)));
  }
  EXPECT_LT(furthest, 0.75);
  EXPECT_GT(fastest, 1.5);
  EXPECT_LT(fastest, 4.0);
  // The slow triangle's flank: 0.12 rad/s.
  EXPECT_LT(std::fabs(s.motion.at(4.0 + 2.0).rate_rad_per_s), 0.15);
}

TEST(Scenario, EveryRecipeLoadsRepeatsAndStaysWithinTheJointsRange) {
  int recipes = 0;
  for (const auto& entry : fs::directory_iterator(kRoot / "tools/scenarios")) {
    if (!entry.path().stem().string().starts_with("recipe_"))
      continue;
    ++recipes;
    const Scenario s = load_scenario(entry.path());
    EXPECT_GE(s.motion.repeat(), 2) << entry.path();
    EXPECT_LT(s.duration_s, 150.0) << entry.path();
    std::vector<const Motion*> motions = {&s.motion};
    for (const OtherAxis& axis : s.other_axes)
      motions.push_back(&axis.motion);
    for (const Motion* motion : motions) {
      for (double t = 0.0; t < s.duration_s; t += 0.01) {
        ASSERT_LT(std::fabs(motion->at(t).angle_rad), 0.6) << entry.path() << t;
        ASSERT_LT(std::fabs(motion->at(t).rate_rad_per_s), 4.0) << entry.path() << t;
      }
    }
  }
  EXPECT_GE(recipes, 9);
}

TEST(Scenario, TorqueIsAMotionInNewtonMetresThatPutsTheInstrumentOnTheBench) {
  const std::string torque =
      "[torque]\n[[torque.segments]]\nkind = \"triangle\"\nduration_s = 20\nfrequency_hz = 0.1\n"
      "amplitude_nm = 0.2\n";
  const Scenario s = parse_scenario(torque, "folder/good.toml");
  EXPECT_TRUE(on_bench(s));
  EXPECT_NEAR(s.duration_s, 20.5, 1.0e-12);
  // The flank from peak to peak is straight but for the corners of 0.05 s.
  EXPECT_NEAR(s.motion.reference_rad(10.0 + 1.25), 0.2 * 1.25 / (2.5 - 0.0125), 1.0e-12);
  EXPECT_FALSE(on_bench(parse_scenario(kGood, "folder/good.toml")));
  expect_refused("[torque]\n[[torque.segments]]\nkind = \"hold\"\nduration_s = 1\noffset_rad = 3\n", 5, "`offset_rad`");
  expect_refused(torque + "[motion]\n[[motion.segments]]\nkind = \"hold\"\nduration_s = 1\n", 1, "[torque]");
  expect_refused("instrument = \"robot_finger\"\n" + torque +
                     "[[axes]]\naxis = \"outer\"\n[axes.motion]\n[[axes.motion.segments]]\nkind = \"hold\"\n"
                     "duration_s = 1\n",
                 1, "[torque]");
}

TEST(Scenario, ABaseThatLeadsInACircleIsRefused) {
  const fs::path folder = fs::path(::testing::TempDir());
  std::ofstream(folder / "capstan_circle.toml") << "base = \"capstan_circle.toml\"\n";
  EXPECT_THROW(static_cast<void>(load_scenario(folder / "capstan_circle.toml")), ScenarioError);
  fs::remove(folder / "capstan_circle.toml");
}

}  // namespace
}  // namespace capstan::sim
