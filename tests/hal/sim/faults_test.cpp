// SPDX-License-Identifier: Apache-2.0
// The faults beyond the sensors' plain ones (those are in sensors_test.cpp): intermittent and slow values, amplifier,
// tendons, supply, bus.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "capstan/hal/sim/plant.hpp"
#include "capstan/hal/sim/scenario.hpp"
#include "capstan/tests/hal/sim/support.hpp"

namespace capstan::sim {
namespace {

using test::quiet;

struct Record {
  std::vector<Readings> readings;
  std::vector<Truth> truth;
};

// One second at 1.2 A, which turns the input pulley steadily, with the fault from 0.5 s to 0.7 s.
Record run(Fault fault, bool scheduled = true, const PlantParameters& parameters = quiet()) {
  Plant plant(parameters, 2);
  fault.time_s = 0.5;
  fault.duration_s = 0.2;
  if (scheduled)
    plant.schedule(fault);
  Record record;
  for (int i = 0; i < 1000; ++i) {
    plant.step(1.2, true);
    record.readings.push_back(plant.readings());
    record.truth.push_back(plant.truth());
  }
  return record;
}

TEST(MoreFaults, IntermittentLosesItsShareOfTheSamples) {
  const Record r = run({.target = FaultTarget::kEncoder, .kind = FaultKind::kIntermittent, .amount = 0.3});
  int lost = 0;
  for (std::size_t i = 500; i < 699; ++i)
    lost += r.readings[i].encoder_ok ? 0 : 1;
  EXPECT_NEAR(lost, 0.3 * 199, 20);
  EXPECT_TRUE(r.readings[499 - 2].encoder_ok && r.readings[720].encoder_ok && r.readings[600].current_ok);
}

TEST(MoreFaults, SlowFollowsWithItsTimeConstantAndLooksHealthy) {
  Plant plant(quiet(), 2);
  plant.schedule({.time_s = 0.5, .target = FaultTarget::kCurrent, .kind = FaultKind::kSlow, .amount = 0.05});
  double before = 0.0;
  for (int i = 1; i <= 600; ++i) {
    plant.step(i < 500 ? 0.4 : 1.4, true);
    if (i == 499)
      before = plant.readings().current_a;
  }
  // 0.1 s and a little after the step of 1 A: two time constants.
  EXPECT_NEAR(before, 0.4, 1.0e-3);
  EXPECT_NEAR(plant.readings().current_a, 1.4 - std::exp(-2.0), 0.01);
  EXPECT_TRUE(plant.readings().current_ok);
}

TEST(MoreFaults, ASlowEncoderLagsBySpeedTimesTimeConstant) {
  const Record good = run({}, false);
  const Record slow = run({.target = FaultTarget::kEncoder, .kind = FaultKind::kSlow, .amount = 0.02});
  const double speed = (good.readings[650].encoder_counts - good.readings[630].encoder_counts) / 0.02;
  ASSERT_GT(std::fabs(speed), 500.0);
  EXPECT_NEAR(good.readings[650].encoder_counts - slow.readings[650].encoder_counts, 0.02 * speed,
              0.08 * std::fabs(0.02 * speed) + 2.0);
}

TEST(MoreFaults, TheAmplifierHasEveryKindOfItsOwn) {
  const double good = run({}, false).truth[600].current_a;
  const auto current = [](FaultKind kind, double amount) {
    return run({.target = FaultTarget::kAmplifier, .kind = kind, .amount = amount}).truth[600].current_a;
  };
  EXPECT_NEAR(good, 1.2, 1.0e-9);
  EXPECT_NEAR(current(FaultKind::kSign, 0.0), -1.2, 1.0e-9);
  EXPECT_NEAR(current(FaultKind::kJump, 0.3), 1.5, 1.0e-9);
  EXPECT_NE(current(FaultKind::kGarbage, 0.0), good);
  EXPECT_EQ(current(FaultKind::kIntermittent, 1.0), 0.0);
  EXPECT_EQ(current(FaultKind::kOff, 0.0), 0.0);
  EXPECT_NEAR(current(FaultKind::kDelayed, 0.1), 1.2, 1.0e-9);
}

TEST(MoreFaults, ADelayedAmplifierDrivesTheOlderCommand) {
  Plant plant(quiet(), 2);
  plant.schedule({.time_s = 0.0, .target = FaultTarget::kAmplifier, .kind = FaultKind::kDelayed, .amount = 0.1});
  for (int i = 0; i < 150; ++i)
    plant.step(i < 50 ? 0.5 : 0.9, true);
  EXPECT_NEAR(plant.truth().current_a, 0.5, 0.2);
  for (int i = 0; i < 20; ++i)
    plant.step(0.9, true);
  EXPECT_NEAR(plant.truth().current_a, 0.9, 1.0e-6);
}

TEST(MoreFaults, ATrippedAmplifierStaysOffUntilTheEnableIsWithdrawn) {
  Plant plant(quiet(), 2);
  plant.schedule({.time_s = 0.1, .target = FaultTarget::kAmplifier, .kind = FaultKind::kTrip});
  const auto drive = [&](int steps, bool enabled) {
    for (int i = 0; i < steps; ++i)
      plant.step(0.5, enabled);
    return plant.truth().current_a;
  };
  EXPECT_NEAR(drive(90, true), 0.5, 1.0e-9);
  EXPECT_EQ(drive(400, true), 0.0);
  EXPECT_EQ(drive(5, false), 0.0);
  EXPECT_NEAR(drive(50, true), 0.5, 1.0e-9);
}

TEST(MoreFaults, ASnappedTendonHasNoTensionForGood) {
  for (const bool top : {true, false}) {
    for (const double drag : {0.0, 500.0}) {
      PlantParameters p = quiet();
      p.effects.transmission_viscous_forward_ns_per_m = drag;
      Plant plant(p, 2);
      plant.schedule({.time_s = 0.2,
                      .target = top ? FaultTarget::kTendonTop : FaultTarget::kTendonBottom,
                      .kind = FaultKind::kSnap});
      for (int i = 0; i < 1500; ++i) {
        plant.step(i % 500 < 250 ? 0.6 : -0.6, true);
        if (i < 210)
          continue;
        const Tendon& tendon = top ? plant.drivetrain().top() : plant.drivetrain().bottom();
        for (int e = 0; e < tendon.element_count(); ++e)
          ASSERT_EQ(tendon.tension(e), 0.0);
        // What is left can only pull one way.
        ASSERT_LE(plant.truth().tau_in_nm * (top ? 1.0 : -1.0), 1.0e-12);
      }
    }
  }
}

TEST(MoreFaults, APowerDipLimitsTheCurrentAndADeepOneBlindsTheSensors) {
  const Record shallow = run({.target = FaultTarget::kSupply, .kind = FaultKind::kDip, .amount = 0.6});
  EXPECT_NEAR(shallow.truth[600].current_a, 1.2, 1.0e-9);
  EXPECT_TRUE(shallow.readings[600].encoder_ok);
  const Record deep = run({.target = FaultTarget::kSupply, .kind = FaultKind::kDip, .amount = 0.2});
  EXPECT_NEAR(deep.truth[600].current_a, 0.5, 1.0e-9);  // 0.2 of 2.5 A
  EXPECT_FALSE(deep.readings[600].encoder_ok || deep.readings[600].current_ok);
  EXPECT_TRUE(deep.readings[800].encoder_ok);
  // What turned meanwhile was not counted.
  const double counts = 40960.0 / (2.0 * 3.14159265358979);
  const double missed = deep.truth[699].q1_rad - deep.truth[498].q1_rad;
  ASSERT_GT(missed, 0.001);
  EXPECT_NEAR(deep.truth[800].q1_rad * counts - deep.readings[800].encoder_counts, missed * counts,
              0.1 * missed * counts);
}

TEST(MoreFaults, ASilentBusBringsNothingAndTheAmplifierGivesUpAfterItsTime) {
  const Record r = run({.target = FaultTarget::kBus, .kind = FaultKind::kOff, .amount = 0.05});
  EXPECT_FALSE(r.readings[600].encoder_ok || r.readings[600].current_ok);
  EXPECT_NEAR(r.truth[530].current_a, 1.2, 1.0e-9);
  EXPECT_EQ(r.truth[600].current_a, 0.0);
  EXPECT_TRUE(r.readings[720].encoder_ok);
  EXPECT_NEAR(r.truth[720].current_a, 1.2, 1.0e-6);
}

TEST(MoreFaults, TheLogsSensorsHaveEveryKindOfTheirOwnAndTheBoardSeesNothingOfIt) {
  PlantParameters p = quiet();
  p.environment = {.kind = EnvironmentKind::kSpring, .stiffness = 0.002};
  const Record good = run({}, false, p);
  ASSERT_GT(good.truth[500].tip_force_n, 0.1);
  for (const FaultTarget target : {FaultTarget::kCamera, FaultTarget::kTipForce}) {
    const bool camera = target == FaultTarget::kCamera;
    const auto shown = [&](FaultKind kind, double amount, std::size_t at) {
      const Record r = run({.target = target, .kind = kind, .amount = amount}, true, p);
      for (std::size_t i = 0; i < 1000; ++i) {
        EXPECT_EQ(r.readings[i].encoder_counts, good.readings[i].encoder_counts);
        EXPECT_EQ(camera ? r.truth[i].tip_force_n : r.truth[i].q2_camera_rad,
                  camera ? good.truth[i].tip_force_n : good.truth[i].q2_camera_rad);
      }
      EXPECT_EQ(r.truth[800].q2_camera_rad, good.truth[800].q2_camera_rad);
      EXPECT_EQ(r.truth[800].tip_force_n, good.truth[800].tip_force_n);
      EXPECT_TRUE(std::isnan(r.truth[at].tip_force_n) || r.truth[at].tip_torque_nm == r.truth[at].tip_force_n * 0.01);
      return camera ? r.truth[at].q2_camera_rad : r.truth[at].tip_force_n;
    };
    const auto healthy = [&](std::size_t at) {
      return camera ? good.truth[at].q2_camera_rad : good.truth[at].tip_force_n;
    };
    EXPECT_EQ(shown(FaultKind::kOff, 0.0, 600), 0.0);
    EXPECT_NEAR(shown(FaultKind::kStuck, 0.0, 600), healthy(499), 0.02 * healthy(499));
    EXPECT_EQ(shown(FaultKind::kStuck, 0.0, 600), shown(FaultKind::kStuck, 0.0, 650));
    EXPECT_EQ(shown(FaultKind::kJump, 0.25, 600), healthy(600) + 0.25);
    EXPECT_TRUE(std::isnan(shown(FaultKind::kNan, 0.0, 600)));
    EXPECT_EQ(shown(FaultKind::kSign, 0.0, 600), -healthy(600));
    EXPECT_EQ(shown(FaultKind::kDelayed, 0.1, 650), healthy(550));
    EXPECT_EQ(shown(FaultKind::kIntermittent, 1.0, 600), 0.0);
    EXPECT_NE(shown(FaultKind::kGarbage, 0.0, 600), healthy(600));
    // A ramp followed by a lag of 20 ms is late by 20 ms.
    EXPECT_NEAR(shown(FaultKind::kSlow, 0.02, 690), healthy(670), 0.005 * healthy(670));
  }
}

TEST(MoreFaults, AWeightOnTheTipIsATorqueOnTheJointForThatLong) {
  PlantParameters p = quiet();
  p.environment = {.kind = EnvironmentKind::kSpring, .stiffness = 5.0};
  Plant plant(p, 2);
  const auto rest = [&] {
    for (int i = 0; i < 500; ++i)
      plant.step(0.0, true);
    return plant.truth().q2_rad;
  };
  const double before = rest();
  plant.schedule(
      {.time_s = 0.6, .target = FaultTarget::kTip, .kind = FaultKind::kJump, .amount = 0.1, .duration_s = 0.8});
  EXPECT_GT(rest(), before + 0.005) << "pushed forward, with most of 0.1 / 5 rad, tendons and friction take the rest";
  EXPECT_LT(plant.truth().q2_rad, before + 0.02);
  static_cast<void>(rest());
  EXPECT_LT(rest(), before + 0.01) << "and let go";
}

TEST(MoreFaults, TargetsThatCannotHaveAKindAreRefused) {
  FaultSchedule schedule(1);
  for (const Fault& bad : std::vector<Fault>{
           {.target = FaultTarget::kTendonTop, .kind = FaultKind::kStuck},
           {.target = FaultTarget::kEncoder, .kind = FaultKind::kSnap},
           {.target = FaultTarget::kSupply, .kind = FaultKind::kOff},
           {.target = FaultTarget::kCurrent, .kind = FaultKind::kDip},
           {.target = FaultTarget::kCurrent, .kind = FaultKind::kTrip},
           {.target = FaultTarget::kAmplifier, .kind = FaultKind::kNan},
           {.target = FaultTarget::kBus, .kind = FaultKind::kStuck},
           {.target = FaultTarget::kEncoder, .kind = FaultKind::kSlow, .amount = 0.0},
           {.target = FaultTarget::kEncoder, .kind = FaultKind::kIntermittent, .amount = 1.5},
           {.target = FaultTarget::kTip, .kind = FaultKind::kStuck},
       }) {
    EXPECT_THROW(schedule.add(bad), std::invalid_argument);
  }
}

TEST(MoreFaults, CanBeGivenInWords) {
  const Fault f = parse_fault("current jump at 2.5 for 0.5 amount -0.3");
  EXPECT_EQ(f.target, FaultTarget::kCurrent);
  EXPECT_EQ(f.kind, FaultKind::kJump);
  EXPECT_EQ(f.time_s, 2.5);
  EXPECT_EQ(f.duration_s, 0.5);
  EXPECT_EQ(f.amount, -0.3);
  EXPECT_EQ(parse_fault("tendon_top snap").kind, FaultKind::kSnap);
  EXPECT_EQ(parse_fault("camera off axis 2").axis, 2);
  for (const char* bad : {"", "encoder", "encoder flies", "encoder off at", "encoder off at x", "encoder off near 3",
                          "amplifier nan at 1", "encoder off at -1", "encoder off axis -1"}) {
    EXPECT_THROW(static_cast<void>(parse_fault(bad)), ScenarioError) << bad;
  }
}

}  // namespace
}  // namespace capstan::sim
