// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/sensors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <set>
#include <stdexcept>
#include <vector>

#include "capstan/hal/sim/plant.hpp"
#include "capstan/tests/hal/sim/support.hpp"

namespace capstan::sim {
namespace {

using test::quiet;

TEST(Encoder, CountsDownwardAndWrapsAt32Bits) {
  PlantParameters p;
  p.encoder_start_counts = 2147483640.0;
  const Encoder encoder(p);
  const double count_rad = 2.0 * std::numbers::pi / p.encoder_counts_per_turn;
  EXPECT_EQ(encoder.counts(0.0, 0.0), 2147483640);
  EXPECT_EQ(encoder.counts(7.5 * count_rad, 0.0), std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(encoder.counts(8.5 * count_rad, 0.0), std::numeric_limits<std::int32_t>::min());
  EXPECT_EQ(encoder.counts(-0.5 * count_rad, 0.0), 2147483639);
}

TEST(CurrentSensor, NoiseHasItsMeanAndSpread) {
  PlantParameters p;
  p.current_noise_a = 0.01;
  p.current_offset_a = 0.05;
  p.current_adc_step_a = 0.0;
  CurrentSensor sensor(p, 4);
  constexpr int kSamples = 100000;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double x = sensor.sample(0.5) - 0.55;
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / kSamples, 0.0, 4.0 * 0.01 / std::sqrt(kSamples));
  EXPECT_NEAR(std::sqrt(squares / kSamples), 0.01, 1.0e-4);
}

TEST(CurrentSensor, QuantisesAndStopsAtFullScale) {
  PlantParameters p = quiet();
  p.current_adc_step_a = 0.25;
  p.current_full_scale_a = 2.0;
  CurrentSensor sensor(p, 1);
  EXPECT_DOUBLE_EQ(sensor.sample(0.6), 0.5);
  EXPECT_DOUBLE_EQ(sensor.sample(-0.65), -0.75);
  EXPECT_DOUBLE_EQ(sensor.sample(7.0), 2.0);
}

TEST(SampleDelay, EncoderAndCurrentLagByExactlyIt) {
  // At a constant speed an angle that is late by d is short by speed times d, whole steps or not.
  for (const double delay : {0.0, 0.0004, 0.001, 0.0025, 0.02}) {
    PlantParameters p = quiet();
    p.sample_delay_s = delay;
    p.encoder_counts_per_turn = 2.0 * std::numbers::pi * 1.0e7;  // a count is 0.1 urad
    Plant plant(p, 1);
    for (int i = 1; i <= 300; ++i)
      plant.step_kinematic(0.002 * i);
    EXPECT_NEAR(plant.readings().encoder_counts, 1.0e7 * (0.6 - 2.0 * delay), 1.5) << delay;
  }
  PlantParameters p = quiet();
  p.sample_delay_s = 0.003;
  Plant late(p, 1);
  Plant prompt(quiet(), 1);
  std::vector<double> shown;
  for (int i = 0; i < 50; ++i) {
    late.step(i < 10 ? 0.0 : 1.0, true);
    prompt.step(i < 10 ? 0.0 : 1.0, true);
    shown.push_back(prompt.readings().current_a);
    if (i >= 3) {
      ASSERT_DOUBLE_EQ(late.readings().current_a, shown[static_cast<std::size_t>(i) - 3]) << i;
    }
  }
}

TEST(Camera, HoldsItsFramesAndDeliversThemLate) {
  PlantParameters p;
  p.camera_noise_rad = 0.0;
  p.camera_rate_hz = 25.0;
  p.camera_delay_s = 0.01;
  Camera camera(p, 1);
  std::set<double> seen;
  for (int i = 0; i < 1000; ++i) {
    const double value = camera.sample(static_cast<double>(i));
    if (i < 10)
      continue;
    // The frame in force 10 ms ago; frames are taken at multiples of 40 ms.
    ASSERT_DOUBLE_EQ(value, static_cast<double>((i - 10) / 40 * 40)) << i;
    seen.insert(value);
  }
  EXPECT_EQ(seen.size(), 25U);
}

class Faults : public ::testing::Test {
 protected:
  // Runs one second with the fault from 0.5 s to 0.7 s; the input pulley turns steadily.
  void run(FaultTarget target, FaultKind kind, double amount) {
    Plant plant(quiet(), 2);
    plant.schedule({.time_s = 0.5, .target = target, .kind = kind, .amount = amount, .duration_s = 0.2});
    Plant healthy(quiet(), 2);
    for (int i = 1; i <= 1000; ++i) {
      plant.step(1.2, true);
      healthy.step(1.2, true);
      if (i == 499)
        before_ = plant.readings();
      if (i == 600)
        faulty_ = plant.readings(), good_ = healthy.readings();
      if (i == 560)
        good_earlier_ = healthy.readings();
      if (i == 800)
        after_ = plant.readings(), good_after_ = healthy.readings();
    }
  }

  Readings before_, faulty_, good_, good_earlier_, after_, good_after_;
};

TEST_F(Faults, OffSaysSo) {
  run(FaultTarget::kEncoder, FaultKind::kOff, 0.0);
  EXPECT_FALSE(faulty_.encoder_ok);
  EXPECT_TRUE(faulty_.current_ok);
  EXPECT_EQ(faulty_.current_a, good_.current_a);
  EXPECT_TRUE(after_.encoder_ok);
  EXPECT_EQ(after_.encoder_counts, good_after_.encoder_counts);
}

TEST_F(Faults, StuckHoldsTheLastGoodValueAndLooksHealthy) {
  run(FaultTarget::kEncoder, FaultKind::kStuck, 0.0);
  EXPECT_TRUE(faulty_.encoder_ok);
  EXPECT_EQ(faulty_.encoder_counts, before_.encoder_counts);
  EXPECT_NE(faulty_.encoder_counts, good_.encoder_counts);
}

TEST_F(Faults, JumpAddsItsAmount) {
  run(FaultTarget::kEncoder, FaultKind::kJump, 5000.0);
  EXPECT_EQ(faulty_.encoder_counts, good_.encoder_counts + 5000);
  run(FaultTarget::kCurrent, FaultKind::kJump, -0.4);
  EXPECT_DOUBLE_EQ(faulty_.current_a, good_.current_a - 0.4);
}

TEST_F(Faults, NanReachesTheBoard) {
  run(FaultTarget::kCurrent, FaultKind::kNan, 0.0);
  EXPECT_TRUE(std::isnan(faulty_.current_a));
  EXPECT_EQ(faulty_.encoder_counts, good_.encoder_counts);
  run(FaultTarget::kEncoder, FaultKind::kNan, 0.0);
  EXPECT_FALSE(faulty_.encoder_ok);
}

TEST_F(Faults, SignIsReversed) {
  run(FaultTarget::kEncoder, FaultKind::kSign, 0.0);
  EXPECT_EQ(faulty_.encoder_counts, -good_.encoder_counts);
  EXPECT_NE(good_.encoder_counts, 0);
}

TEST_F(Faults, DelayedGivesTheOlderValue) {
  run(FaultTarget::kEncoder, FaultKind::kDelayed, 0.04);
  EXPECT_EQ(faulty_.encoder_counts, good_earlier_.encoder_counts);
  EXPECT_NE(good_earlier_.encoder_counts, good_.encoder_counts);
}

TEST_F(Faults, AnAmplifierThatIsOffDrivesNothing) {
  run(FaultTarget::kAmplifier, FaultKind::kOff, 0.0);
  EXPECT_EQ(faulty_.current_a, 0.0);
  EXPECT_NEAR(after_.current_a, 1.2, 1.0e-6);
}

TEST_F(Faults, GarbageIsNotTheValue) {
  run(FaultTarget::kEncoder, FaultKind::kGarbage, 0.0);
  EXPECT_NE(faulty_.encoder_counts, good_.encoder_counts);
  EXPECT_TRUE(faulty_.encoder_ok);
}

TEST_F(Faults, ImpossibleFaultsAreRefused) {
  FaultSchedule schedule(1);
  EXPECT_THROW(schedule.add({.time_s = -1.0}), std::invalid_argument);
  EXPECT_THROW(schedule.add({.kind = FaultKind::kDelayed, .amount = 60.0}), std::invalid_argument);
  EXPECT_THROW(schedule.add({.target = FaultTarget::kAmplifier, .kind = FaultKind::kNan}), std::invalid_argument);
}

}  // namespace
}  // namespace capstan::sim
