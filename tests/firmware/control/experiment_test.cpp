// SPDX-License-Identifier: Apache-2.0
// The recipes' references against the formulas in double.
#include "capstan/firmware/control/experiment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

namespace capstan {
namespace {

constexpr double kPi = std::numbers::pi;

auto q(double value) -> Q24 {
  return Q24::from_double(value);
}

auto tones(Recipe recipe, double amplitude, const std::vector<double>& frequencies) -> ExperimentSetup {
  ExperimentSetup setup{.recipe = recipe, .amplitude = q(amplitude), .rung_count = frequencies.size()};
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    setup.rungs[i] = q(frequencies[i]);
  }
  setup.length_ms = 20'000;
  setup.cycles = 3;
  return setup;
}

/// Rises over one blend, falls over another: 3 s^2 - 2 s^3.
auto envelope(double t_s, double length_s, double blend_s) -> double {
  const double s = std::min(1.0, std::min(t_s, length_s - t_s) / blend_s);
  return s * s * (3.0 - 2.0 * s);
}

TEST(Experiment, ARungOfTheSineLadderIsTheSineUnderItsEnvelope) {
  const ExperimentSetup setup = tones(Recipe::kSineLadder, 0.3, {0.25, 1.6});
  for (const auto& [rung, frequency] : {std::pair{std::size_t{0}, 0.25}, {std::size_t{1}, 1.6}}) {
    const std::uint32_t length = rt_rung_ms(setup, rung);
    EXPECT_EQ(length, static_cast<std::uint32_t>(4000 / frequency)) << "one period more than the three asked for";
    for (std::uint32_t t = 0; t <= length; ++t) {
      const double time = 0.001 * t;
      const double wanted =
          0.3 * envelope(time, 0.001 * length, 1.0 / frequency) * std::sin(2.0 * kPi * frequency * time);
      ASSERT_NEAR(rt_tone(setup, rung, t).to_double(), wanted, 3e-7) << frequency << " Hz at " << t << " ms";
    }
  }
}

TEST(Experiment, ADecayingSineDecaysExponentially) {
  ExperimentSetup setup = tones(Recipe::kDecayingSine, 0.4, {0.5});
  setup.decay_per_s = q(0.15);
  for (std::uint32_t t = 0; t <= 20'000; ++t) {
    const double time = 0.001 * t;
    const double wanted = 0.4 * envelope(time, 20.0, 2.0) * std::exp(-0.15 * time) * std::sin(2.0 * kPi * 0.5 * time);
    ASSERT_NEAR(rt_tone(setup, 0, t).to_double(), wanted, 5e-7) << t;
  }
}

TEST(Experiment, AMultisineHasItsPeakAtTheAmplitudeAndSchroedersPhases) {
  ExperimentSetup setup = tones(Recipe::kMultisine, 0.2, {0.1, 0.3, 0.7});
  scale_tones(setup);
  const auto sum = [](double time) {
    double value = 0.0;
    for (int k = 1; k <= 3; ++k) {
      value += std::sin(2.0 * kPi * std::array{0.1, 0.3, 0.7}[static_cast<std::size_t>(k - 1)] * time -
                        kPi * k * (k - 1) / 3.0);
    }
    return value;
  };
  double peak = 0.0;
  for (int t = 0; t <= 20'000; t += 2) {
    peak = std::max(peak, std::fabs(sum(0.001 * t)));
  }
  double largest = 0.0;
  for (std::uint32_t t = 0; t <= 20'000; ++t) {
    const double time = 0.001 * t;
    const double value = rt_tone(setup, 0, t).to_double();
    largest = std::max(largest, std::fabs(value));
    ASSERT_NEAR(value, 0.2 / peak * sum(time) * envelope(time, 20.0, 1.429), 1e-6)
        << t << "; frequencies of 2^-24 Hz give 7.5e-7 in 20 s";
  }
  EXPECT_NEAR(largest, 0.2, 0.001);
}

TEST(Experiment, WhatTheCheckLetsThroughKeepsSpeedAndAccelerationOfTheJoint) {
  const AxisConfig config;
  for (const Recipe recipe : {Recipe::kSineLadder, Recipe::kMultisine, Recipe::kDecayingSine}) {
    for (const double frequency : {0.2, 0.5, 1.0, 2.0, 5.0}) {
      ExperimentSetup setup = tones(recipe, 1.0, {frequency});
      while (check_experiment(setup, config) != nullptr) {
        setup.amplitude = setup.amplitude * q(0.99);
      }
      scale_tones(setup);
      const auto at = [&](std::uint32_t t) { return rt_tone(setup, 0, t).to_double(); };
      for (std::uint32_t t = 1; t < rt_rung_ms(setup, 0); ++t) {
        ASSERT_LE(std::fabs(at(t) - at(t - 1)) * 1e3, 2.0 * 1.001) << frequency;
        ASSERT_LE(std::fabs(at(t + 1) - 2.0 * at(t) + at(t - 1)) * 1e6, 10.0 + 0.3) << frequency << " with rounding";
      }
    }
  }
}

TEST(Experiment, EveryRungBeginsAndEndsAtTheOffset) {
  for (const Recipe recipe : {Recipe::kSineLadder, Recipe::kMultisine, Recipe::kDecayingSine}) {
    ExperimentSetup setup = tones(recipe, 0.2, {0.37});
    scale_tones(setup);
    EXPECT_EQ(rt_tone(setup, 0, 0), Q24{});
    EXPECT_EQ(rt_tone(setup, 0, rt_rung_ms(setup, 0)), Q24{});
  }
}

TEST(Experiment, WhatAJointCanNotDoIsRefusedWithSentenceAndCure) {
  const AxisConfig config;
  ExperimentSetup sine = tones(Recipe::kSineLadder, 0.2, {0.5});
  ASSERT_EQ(check_experiment(sine, config), nullptr);
  const auto refused = [&config](ExperimentSetup setup, const char* about) {
    const char* problem = check_experiment(setup, config);
    return problem != nullptr && std::strstr(problem, about) != nullptr && std::strstr(problem, "; ") != nullptr;
  };
  const auto with = [&sine](auto&& change) {
    ExperimentSetup setup = sine;
    change(setup);
    return setup;
  };
  EXPECT_TRUE(refused(with([](auto& s) { s.amplitude = q(2.1); }), "limits.joint_min"));
  EXPECT_TRUE(refused(with([](auto& s) { s.offset_rad = q(-1.9); }), "limits.joint_min"));
  EXPECT_TRUE(refused(with([](auto& s) { s.amplitude = q(-0.2); }), "above 0"));
  EXPECT_TRUE(refused(with([](auto& s) { s.amplitude = Q24{}; }), "above 0"));
  EXPECT_TRUE(refused(with([](auto& s) { s.rungs[0] = q(1.5); }), "limits.joint_"));
  EXPECT_TRUE(refused(with([](auto& s) { s.rungs[0] = q(25.0); }), "20 Hz"));
  EXPECT_TRUE(refused(with([](auto& s) { s.rungs[0] = Q24{}; }), "above 0"));
  EXPECT_TRUE(refused(with([](auto& s) { s.rung_count = 0; }), "above 0"));
  EXPECT_TRUE(refused(with([](auto& s) { s.rung_count = ExperimentSetup::kMostRungs + 1; }), "at most 8"));
  EXPECT_TRUE(refused(with([](auto& s) { s.cycles = 0; }), "cycles"));
  EXPECT_TRUE(refused(with([](auto& s) { s.repeats = 1001; }), "repeats"));
  EXPECT_TRUE(refused(with([](auto& s) { s.recipe = Recipe::kMultisine, s.length_ms = 3'999; }), "two periods"));
  EXPECT_TRUE(refused(with([](auto& s) { s.recipe = Recipe::kTriangle, s.rungs[0] = q(2.1); }), "limits.joint_speed"));
  EXPECT_TRUE(refused(with([](auto& s) { s.recipe = Recipe::kReversals, s.levels = 1; }), "levels"));
  EXPECT_TRUE(
      refused(with([](auto& s) { s.recipe = Recipe::kTorqueTriangle, s.amplitude = q(0.31); }), "limits.current"));
}

TEST(Experiment, ADitherBeyondTheContinuousCurrentIsRefused) {
  const AxisConfig config;
  const double most =
      config.limits.continuous_current_a.to_double() * config.motor.torque_per_current_nm_per_a.to_double() / 2.0;
  ExperimentSetup setup{
      .recipe = Recipe::kDither, .amplitude = q(0.3), .rungs = {q(0.4)}, .rung_count = 1, .dither_nm = q(0.99 * most)};
  EXPECT_EQ(check_experiment(setup, config), nullptr);
  for (const double dither_nm : {1.01 * most, 100.0}) {
    setup.dither_nm = q(dither_nm);
    ASSERT_NE(check_experiment(setup, config), nullptr) << dither_nm;
    EXPECT_NE(std::string(check_experiment(setup, config)).find("limits.continuous_current"), std::string::npos);
  }
}

}  // namespace
}  // namespace capstan
