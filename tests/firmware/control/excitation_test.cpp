// SPDX-License-Identifier: Apache-2.0
// What shakes a joint, against sums and sweeps in double.
#include "capstan/firmware/control/excitation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace capstan {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPeriod = ExcitationSetup::kPeriodMs;

auto q(double value) -> Q24 {
  return Q24::from_double(value);
}

auto setup_of(ExcitationSetup::Kind kind, double amplitude, double from_hz, double to_hz, std::uint32_t length_ms)
    -> ExcitationSetup {
  return {.kind = kind,
          .amplitude = q(amplitude),
          .from_khz = q(0.001 * from_hz),
          .to_khz = q(0.001 * to_hz),
          .length_ms = length_ms,
          .corridor_rad = q(0.1)};
}
auto multisine(double amplitude, double from_hz, double to_hz) -> ExcitationSetup {
  ExcitationSetup setup = setup_of(ExcitationSetup::Kind::kMultisine, amplitude, from_hz, to_hz, 20'480);
  prepare_excitation(setup);
  return setup;
}

auto values_of(const ExcitationSetup& setup) -> std::vector<double> {
  Excitation excitation;
  std::vector<double> values;
  for (std::uint32_t t = 0; t < setup.length_ms; ++t) {
    values.push_back(excitation.rt_next(setup, t).to_double());
  }
  return values;
}

/// |DFT| of one period, as an amplitude.
auto line_of(const std::vector<double>& values, std::size_t from, int harmonic) -> double {
  double re = 0.0;
  double im = 0.0;
  for (std::size_t i = 0; i < ExcitationSetup::kPeriodMs; ++i) {
    const double angle = 2.0 * kPi * harmonic * static_cast<double>(i) / kPeriod;
    re += values[from + i] * std::cos(angle);
    im += values[from + i] * std::sin(angle);
  }
  return 2.0 / kPeriod * std::hypot(re, im);
}

TEST(Excitation, AMultisineHasEqualPowerInItsOddLinesAndNothingElsewhere) {
  const ExcitationSetup setup = multisine(0.01, 1.0, 200.0);
  ASSERT_GE(setup.lines, 25U);
  const std::vector<double> values = values_of(setup);
  std::vector<bool> excited(512, false);
  for (std::size_t i = 0; i < setup.lines; ++i) {
    EXPECT_EQ(setup.harmonics[i] % 2, 1);
    EXPECT_GE(1000.0 * setup.harmonics[i] / kPeriod, 1.0 - 1000.0 / kPeriod);
    EXPECT_LE(1000.0 * setup.harmonics[i] / kPeriod, 200.0);
    excited[setup.harmonics[i]] = true;
  }
  EXPECT_GT(1000.0 * setup.harmonics[setup.lines - 1] / kPeriod, 180.0) << "up to the end of the range";
  const double one = line_of(values, 4096, setup.harmonics[0]);
  EXPECT_GT(one, 0.01 / static_cast<double>(setup.lines)) << "more than if all peaks fell together";
  for (int k = 1; k < 512; ++k) {
    EXPECT_NEAR(line_of(values, 4096, k), excited[static_cast<std::size_t>(k)] ? one : 0.0, 2e-7) << k;
  }
}

// The crest of independent phases is about sqrt(2 ln(2 P)) = 4.1 for so many samples; that of one sine is 1.41.
TEST(Excitation, SchroedersPhasesKeepThePeakOfAMultisineAtTheAmplitudeAndItsCrestLow) {
  for (const auto& [from, to] : {std::pair{1.0, 200.0}, {0.5, 100.0}, {2.0, 300.0}, {1.0, 20.0}}) {
    const ExcitationSetup setup = multisine(0.02, from, to);
    double peak = 0.0;
    double power = 0.0;
    for (std::uint32_t t = 0; t < ExcitationSetup::kPeriodMs; ++t) {
      const double value = rt_multisine(setup, t).to_double();
      peak = std::max(peak, std::fabs(value));
      power += value * value / kPeriod;
    }
    EXPECT_NEAR(peak, 0.02, 1e-6);
    EXPECT_LT(peak / std::sqrt(power), 3.3) << from << " to " << to << " Hz";
  }
}

TEST(Excitation, AMultisineIsPeriodicForTenMinutesAndBeginsAndEndsAtZero) {
  ExcitationSetup setup = multisine(0.01, 1.0, 200.0);
  setup.length_ms = 294 * ExcitationSetup::kPeriodMs;
  const std::vector<double> values = values_of(setup);
  EXPECT_EQ(values.front(), 0.0);
  EXPECT_LT(std::fabs(values.back()), 1e-4);
  for (std::size_t t = Excitation::kRampMs; t < ExcitationSetup::kPeriodMs; ++t) {
    ASSERT_EQ(values[t], values[t + std::size_t{292} * ExcitationSetup::kPeriodMs]) << t;
  }
}

TEST(Excitation, AChirpSweepsEveryOctaveInTheSameTimeAtItsAmplitude) {
  for (const std::uint32_t length : {5000U, 20'000U, 60'000U}) {
    ExcitationSetup setup = setup_of(ExcitationSetup::Kind::kChirp, 0.01, 0.5, 256.0, length);
    prepare_excitation(setup);
    const std::vector<double> values = values_of(setup);
    // 9 octaves: zero crossings so far are twice the turns, which are the integral of the frequency.
    int crossings = 0;
    for (std::uint32_t t = 1; t < length; ++t) {
      crossings += (values[t - 1] < 0.0) != (values[t] < 0.0) ? 1 : 0;
      if (t % 500 == 0) {
        const double share = static_cast<double>(t) / length;
        const double turns = 0.001 * length * 0.5 * (std::exp2(9.0 * share) - 1.0) / (9.0 * std::log(2.0));
        ASSERT_NEAR(crossings, 2.0 * turns, 1.5 + 0.002 * turns) << t << " of " << length;
      }
    }
    EXPECT_NEAR(*std::max_element(values.begin(), values.end()), 0.01, 2e-5);
  }
}

TEST(Excitation, WhatIsNotWithinTheJointsLimitsIsRefusedWithASentence) {
  const AxisConfig config;
  const auto refused = [&config](auto change) {
    ExcitationSetup setup = setup_of(ExcitationSetup::Kind::kMultisine, 0.01, 1.0, 200.0, 20'480);
    change(setup);
    const char* problem = check_excitation(setup, Q24{}, config);
    return problem != nullptr && std::string(problem).find("; ") != std::string::npos;
  };
  using Setup = ExcitationSetup;
  EXPECT_FALSE(refused([](Setup&) {}));
  EXPECT_TRUE(refused([](Setup& s) { s.amplitude = {}; }));
  EXPECT_TRUE(refused([](Setup& s) { s.amplitude = q(0.16); })) << "1.5 A are 0.15 N m";
  EXPECT_TRUE(refused([](Setup& s) { s.from_khz = q(0.001 * 0.1); }));
  EXPECT_TRUE(refused([](Setup& s) { s.to_khz = q(0.001 * 450.0); }));
  EXPECT_TRUE(refused([](Setup& s) { s.to_khz = q(0.001 * 1.5); })) << "less than an octave";
  EXPECT_TRUE(refused([](Setup& s) { s.length_ms = 1000; }));
  EXPECT_TRUE(refused([](Setup& s) { s.length_ms = 700'000; }));
  EXPECT_TRUE(refused([](Setup& s) {
    s.kind = Setup::Kind::kChirp;
    s.length_ms = 70'000;
  }));
  EXPECT_TRUE(refused([](Setup& s) { s.corridor_rad = {}; }));
  EXPECT_TRUE(refused([](Setup& s) { s.corridor_rad = q(2.1); })) << "beyond joint_max";
  EXPECT_TRUE(refused([](Setup& s) { s.travel_rad = q(0.2); })) << "without a speed";
  EXPECT_TRUE(refused([](Setup& s) {
    s.kind = Setup::Kind::kChirp;
    s.travel_rad = q(0.2);
    s.speed_rad_s = q(0.1);
  }));
  EXPECT_TRUE(refused([](Setup& s) { s.point = Setup::Point::kJointReference; })) << "200 Hz";
  EXPECT_TRUE(refused([](Setup& s) {
    s.point = Setup::Point::kJointReference;
    s.to_khz = q(0.001 * 10.0);
  })) << "0.01 rad at 10 Hz are 39 rad/s2";
  EXPECT_FALSE(refused([](Setup& s) {
    s.point = Setup::Point::kJointReference;
    s.to_khz = q(0.001 * 4.0);
  }));
}

}  // namespace
}  // namespace capstan
