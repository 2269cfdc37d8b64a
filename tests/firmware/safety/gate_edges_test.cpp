// SPDX-License-Identifier: Apache-2.0
// What mutants of gate and monitors (tools/mutants) survived: edges, single signs, and which limit is named.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/firmware/safety/gate.hpp"
#include "capstan/firmware/safety/monitors.hpp"
#include "capstan/firmware/safety/motor_observer.hpp"
#include "capstan/tests/firmware/loop/axis_bench.hpp"

namespace capstan {
namespace {

using namespace test;

auto motor_at(Q24 q1_rad) -> MotorState {
  MotorState motor;
  motor.q1_rad = q1_rad;
  return motor;
}

/// A current that nobody wanted, a little beyond what may differ.
auto wrong_current(const AxisConfig& config) -> MotorState {
  MotorState motor;
  motor.current_a = config.limits.current_mismatch_a + q(0.1);
  return motor;
}

TEST(Gate, ExactlyAtTheEndOfTheTravelThereIsNoTorqueOutwards) {
  const AxisConfig config = config_without_rate_limit();
  Gate gate(config);
  const Q24 torque = q(0.05);
  EXPECT_EQ(gate.rt_step(config.limits, motor_at(config.limits.motor_max_rad), torque, true).current_a, Q24{});
  EXPECT_EQ(gate.rt_step(config.limits, motor_at(config.limits.motor_min_rad), -torque, true).current_a, Q24{});
  EXPECT_GT(gate.rt_step(config.limits, motor_at(config.limits.motor_min_rad), torque, true).current_a, Q24{});
}

// A joint that presses wants more than it gets, and a look below the wish would not show.
TEST(Gate, ALookTakesTorqueAwayFromTheLimitAndNotFromTheWish) {
  const AxisConfig config = config_without_rate_limit();
  const double peak = config.limits.current_a.to_double();
  for (const double side : {1.0, -1.0}) {
    Gate gate(config);
    const Q24 wish = q(side * 2.0 * peak) * config.motor.torque_per_current_nm_per_a;
    const auto current = [&](double look_a) {
      return gate.rt_step(config.limits, motor_at(Q24{}), wish, true, Q24{}, q(look_a)).current_a.to_double();
    };
    EXPECT_NEAR(current(-side * 0.5), side * (peak - 0.5), 1e-4);
    EXPECT_NEAR(current(side * 0.5), side * peak, 1e-4);
  }
}

// The servo's own torque keeps to the rate before the dither is added, so only a dither shows the limit of the sum.
TEST(Gate, AnExperimentsDitherKeepsToTheRateInBothDirections) {
  const AxisConfig config;
  const double rate = config.limits.current_rate_a_per_cycle.to_double();
  Gate gate(config);
  double last = 0.0;
  for (const double wanted : {4.0, -4.0, 4.0}) {  // rates
    const Q24 dither = q(wanted * rate) * config.motor.torque_per_current_nm_per_a;
    for (int i = 0; i < 10; ++i) {
      const double drive = gate.rt_step(config.limits, motor_at(Q24{}), Q24{}, true, dither).current_a.to_double();
      const double expected = last + std::clamp(wanted * rate - last, -rate, rate);
      EXPECT_NEAR(drive, expected, 1e-4) << wanted << ", cycle " << i;
      EXPECT_EQ(has(gate.limits(), Limit::kRate), std::abs(wanted * rate - last) > rate + 1e-4);
      last = drive;
    }
  }
}

TEST(Gate, AtThePeakTheCurrentIsNamedInBothDirectionsAndTheRateIsNot) {
  for (const double side : {1.0, -1.0}) {
    AxisBench axis(AxisConfig{});
    for (int i = 0; i < 10; ++i) {  // 0.5 A a cycle
      static_cast<void>(axis.gated(0.0, 0.0, side * 50.0));
    }
    EXPECT_EQ(axis.gated(0.0, 0.0, side * 50.0), side * 3.0);
    EXPECT_TRUE(has(axis.telemetry().limits, Limit::kCurrent));
    EXPECT_FALSE(has(axis.telemetry().limits, Limit::kRate));
  }
}

TEST(Gate, ACommissionedObserverMakesTheRateSlowEnoughToBeWatched) {
  AxisConfig config = config_without_rate_limit();
  config.observer = {.inertia_gm2 = q(0.02), .coulomb_nm = q(0.003), .against_nm = q(0.01), .noise_a = q(0.003)};
  ASSERT_EQ(MotorObserver::check(config), nullptr);
  ASSERT_LT(MotorObserver::slew_limit(config), q(2.0));
  AxisBench axis(config);
  EXPECT_EQ(q(axis.gated(0.0, 0.0, 2.9)), MotorObserver::slew_limit(config));
  EXPECT_TRUE(has(axis.telemetry().limits, Limit::kRate));
}

TEST(Monitors, ACurrentThatIsSometimesRightByChanceIsStillAMismatch) {
  const AxisConfig config;
  Monitors monitors;
  const MotorState wrong = wrong_current(config);
  FaultSet faults = 0;
  for (int i = 0; i < 300 && faults == 0; ++i) {  // two wrong, one right: the count gains one in three cycles
    faults = monitors.rt_watch_power(config.limits, i % 3 == 2 ? MotorState{} : wrong, Q24{});
  }
  EXPECT_EQ(faults, bit(Fault::kCurrentMismatch));
}

TEST(Monitors, ACurrentThatIsMostlyRightIsNoMismatch) {
  const AxisConfig config;
  Monitors monitors;
  const MotorState wrong = wrong_current(config);
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(monitors.rt_watch_power(config.limits, i % 3 == 0 ? wrong : MotorState{}, Q24{}), 0U);
  }
}

}  // namespace
}  // namespace capstan
