// SPDX-License-Identifier: Apache-2.0
// The monitor alone, on errors whose statistics are known. On the simulated plant:
// tests/tools/run/law_monitor_test.cpp.
#include "capstan/firmware/estimate/law_monitor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace capstan {
namespace {

constexpr double kRms = 0.01;
constexpr double kSteady = 0.05;

auto q(double value) -> Q24 {
  return Q24::from_double(value);
}

auto watching_sensor(double excess = 1.5) -> MonitorConfig {
  return {.joint_rms_rad = q(kRms), .excess = q(excess)};
}
auto watching_torque() -> MonitorConfig {
  return {.torque_rms_nm = q(0.002)};
}
auto steady() -> ControlConfig {
  ControlConfig control;
  control.torque_forward_nm = q(kSteady);
  control.torque_backward_nm = q(-kSteady);
  return control;
}

auto whole(const MonitorConfig& monitor) -> AxisConfig {
  AxisConfig config;
  config.monitor = monitor;
  config.control = steady();
  return config;
}

/// A motor that goes to and fro, one stride at a time.
class Motor {
 public:
  explicit Motor(const MonitorConfig& config) : monitor(config), config_(config) {}
  /// @param error  of the law against the sensor   @param more  torque beyond the steady one, forward and backward
  void stride(bool has_joint, double error, double more_forward = 0.0, double more_backward = 0.0) {
    if (q1_ >= 1.0 || q1_ <= -1.0) {
      forward_ = q1_ < 0.0;
      reversal_ = q1_;
    }
    q1_ += forward_ ? 1.01 / 256.0 : -1.01 / 256.0;
    const double torque = forward_ ? kSteady + more_forward : -kSteady + more_backward;
    monitor.rt_step(config_, steady(),
                    {.q1_rad = q(q1_),
                     .q1_reversal_rad = q(reversal_),
                     .tau_nm = q(torque),
                     .forward = forward_,
                     .joint_lead_rad = q(forward_ ? -0.02 : 0.02),
                     .has_joint = has_joint,
                     .joint_error_rad = q(error),
                     .crossed = false});
    monitor.rt_judge(whole(config_));
  }
  void stretch(double error) {
    for (int i = 0; i < LawMonitor::kStretch; ++i) {
      stride(true, error);
    }
  }
  LawMonitor monitor;

 private:
  MonitorConfig config_;
  double q1_ = 0.0;
  double reversal_ = 0.0;
  bool forward_ = true;
};

/// Mean number of stretches until the level first reaches a share of the threshold, errors alike within a stretch: the
/// widest tail there is. The threshold itself takes 3.3 million on average, so a share of it is what a test can wait
/// for.
auto mean_run(double share, double excess, int stretches) -> double {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, kRms);
  Motor motor(watching_sensor(excess));
  int crossings = 0;
  for (int i = 0; i < stretches; ++i) {
    motor.stretch(normal(random));
    if (motor.monitor.level() >= q(share)) {
      ++crossings;
      motor.monitor.rt_configure(watching_sensor(excess));
    }
  }
  return static_cast<double>(stretches) / std::max(crossings, 1);
}

TEST(LawMonitor, FalseWarningsAreAsRareAsTheirBoundSaysAtEveryShareOfTheThreshold) {
  for (const double excess : {1.3, 1.5, 2.0}) {
    for (const double share : {0.3, 0.45}) {
      const double bound = std::exp(share * LawMonitor::kLogStretches);
      const double run = mean_run(share, excess, 60'000);
      std::printf("excess %.1f, share %.2f: one in %.0f stretches, bound %.0f\n", excess, share, run, bound);
      EXPECT_GT(run, bound);
      EXPECT_LT(run, 60.0 * bound) << "a bound that far off would hide changes";
    }
  }
}

TEST(LawMonitor, ErrorTwiceAsLargeIsSaidWithinFiftyStretchesAndAnAllowedOneNever) {
  std::mt19937 random(5);
  for (const double factor : {1.2, 2.0, 4.0}) {
    std::normal_distribution<double> normal(0.0, factor * kRms);
    Motor motor(watching_sensor());
    int stretches = 0;
    while (motor.monitor.warnings() == 0 && stretches < 3000) {
      for (int i = 0; i < LawMonitor::kStretch; ++i) {
        motor.stride(true, normal(random));
      }
      ++stretches;
    }
    EXPECT_EQ(motor.monitor.warnings(), factor < 1.5 ? WarningSet{0} : bit(Warning::kLawMisfit)) << factor;
    std::printf("error %.1f times the expected: warning after %d stretches\n", factor, stretches);
    EXPECT_TRUE(factor < 1.5 || stretches <= 50);
  }
}

TEST(LawMonitor, WhatALawDoesNotKnowYetProvesNothing) {
  Motor motor(watching_sensor());
  for (int i = 0; i < LawMonitor::kUnsettled; ++i) {
    motor.stride(true, 0.9);
  }
  motor.stretch(0.0);
  EXPECT_EQ(motor.monitor.warnings(), 0);
  motor.monitor.rt_unsettle();  // a zero was set: its memory begins anew
  for (int i = 0; i < LawMonitor::kUnsettled; ++i) {
    motor.stride(true, 0.9);
  }
  motor.stretch(0.0);
  EXPECT_EQ(motor.monitor.warnings(), 0);
  motor.stretch(0.9);
  EXPECT_EQ(motor.monitor.warnings(), bit(Warning::kLawMisfit));
}

TEST(LawMonitor, SensorAndTorqueAreWatchedAtOnce) {
  MonitorConfig both = watching_sensor();
  both.torque_rms_nm = watching_torque().torque_rms_nm;
  Motor loose(both);
  for (int i = 0; i < 60'000; ++i) {
    loose.stride(true, 0.0, -0.02, 0.02);
  }
  EXPECT_EQ(loose.monitor.warnings(), bit(Warning::kFrictionLower));
  EXPECT_EQ(loose.monitor.tendons().health(), TendonHealth::kLoose);
  EXPECT_NEAR(loose.monitor.tendons().tension().to_double(), 0.6, 1e-3);
  Motor shifted(both);
  for (int i = 0; i < 60'000; ++i) {
    shifted.stride(true, 0.1);
  }
  EXPECT_EQ(shifted.monitor.warnings(), bit(Warning::kLawMisfit));
  EXPECT_EQ(shifted.monitor.tendons().health(), TendonHealth::kZeroMoved);
}

TEST(LawMonitor, JointAtRestProvesNothing) {
  Motor motor(watching_sensor());
  LawMonitor monitor(watching_sensor());
  for (int i = 0; i < 1'000'000; ++i) {
    const double noise = i % 2 == 0 ? 0.0015 : -0.0015;  // of the encoder
    monitor.rt_step(watching_sensor(), steady(),
                    {.q1_rad = q(0.3 + noise),
                     .q1_reversal_rad = q(0.0),
                     .tau_nm = q(0.0),
                     .forward = true,
                     .joint_lead_rad = q(0.0),
                     .has_joint = true,
                     .joint_error_rad = q(0.5),
                     .crossed = false});
    monitor.rt_judge(whole(watching_sensor()));
  }
  EXPECT_EQ(monitor.level(), Q24{});
}

TEST(LawMonitor, NothingIsWatchedUntilSomebodySaysWhatIsExpected) {
  Motor motor(MonitorConfig{});
  for (int i = 0; i < 100; ++i) {
    motor.stretch(0.9);
  }
  for (int i = 0; i < 100'000; ++i) {
    motor.stride(false, 0.0, 0.5, -0.5);
  }
  EXPECT_EQ(motor.monitor.warnings(), 0);
}

struct Change {
  const char* name;
  double forward, backward;  // of the torque, N m
  WarningSet warnings;
};
class LawMonitorTorque : public testing::TestWithParam<Change> {};

TEST_P(LawMonitorTorque, TellsFrictionFromLoad) {
  Motor motor(watching_torque());
  for (int i = 0; i < 60'000; ++i) {
    motor.stride(false, 0.0, GetParam().forward, GetParam().backward);
  }
  EXPECT_EQ(motor.monitor.warnings(), GetParam().warnings);
}
INSTANTIATE_TEST_SUITE_P(All, LawMonitorTorque,
                         testing::Values(Change{"nothing", 0.0, 0.0, 0}, Change{"load", 0.03, 0.03, 0},
                                         Change{"allowed", 0.002, -0.002, 0},
                                         Change{"worn", 0.01, -0.01, bit(Warning::kFrictionHigher)},
                                         Change{"loose", -0.01, 0.01, bit(Warning::kFrictionLower)},
                                         Change{"one_way", 0.02, 0.0, bit(Warning::kFrictionHigher)}),
                         [](const auto& change) { return change.param.name; });

TEST(LawMonitor, ACrossedTransmissionsLeadMayBeAtTheEndOfItsRange) {
  LawMonitor monitor(watching_torque());
  for (int i = 0; i < 10 * LawMonitor::kSteadyStretch; ++i) {
    const bool forward = i % 2 == 0;
    monitor.rt_step(watching_torque(), steady(),
                    {.q1_rad = q(forward ? 1.0 : -1.0),
                     .q1_reversal_rad = q(forward ? -1.0 : 1.0),
                     .tau_nm = q(forward ? kSteady : -kSteady),
                     .forward = forward,
                     .joint_lead_rad = Q24::lowest(),
                     .has_joint = false,
                     .joint_error_rad = {},
                     .crossed = true});  // the sanitizer of `host` watches the arithmetic
    monitor.rt_judge(whole(watching_torque()));
  }
  EXPECT_EQ(monitor.warnings(), 0U) << "its torque is the healthy one";
}

TEST(LawMonitor, WarningStaysUntilTheMonitorBeginsAnew) {
  Motor motor(watching_sensor());
  for (int i = 0; i < 20; ++i) {
    motor.stretch(0.1);
  }
  ASSERT_EQ(motor.monitor.warnings(), bit(Warning::kLawMisfit));
  EXPECT_EQ(motor.monitor.level(), Q24::from_int(1));
  for (int i = 0; i < 200; ++i) {
    motor.stretch(0.0);
  }
  EXPECT_EQ(motor.monitor.warnings(), bit(Warning::kLawMisfit)) << "a fit on and off is a misfit";
  motor.monitor.rt_configure(watching_sensor());
  EXPECT_EQ(motor.monitor.warnings(), 0);
}

}  // namespace
}  // namespace capstan
