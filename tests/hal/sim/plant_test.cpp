// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/plant.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "capstan/hal/sim/deterministic_math.hpp"
#include "capstan/tests/hal/sim/support.hpp"

namespace capstan::sim {
namespace {

using test::quiet;

constexpr double kPi = std::numbers::pi;

// A plain position servo on q1: enough to make the plant move in every test. Returns the truth of every step.
std::vector<Truth> follow(Plant& plant, double frequency_hz, double seconds, double amplitude_rad = 0.5) {
  std::vector<Truth> record;
  while (plant.truth().time_s < seconds - 1.0e-9) {
    const Truth& t = plant.truth();
    const double wanted = amplitude_rad * det_sin(2.0 * kPi * frequency_hz * t.time_s);
    plant.step(20.0 * (wanted - t.q1_rad) - 0.05 * t.q1_rate_rad_per_s, true);
    record.push_back(plant.truth());
  }
  return record;
}

std::uint64_t mix(std::uint64_t hash, std::uint64_t value) {
  return (hash ^ value) * 0x100000001b3U;
}

// Everything an observer could see, folded into one number.
std::uint64_t fingerprint(std::uint64_t seed) {
  Plant plant(PlantParameters{}, seed);
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (int i = 0; i < 3000; ++i) {
    plant.step(0.9 * det_sin(0.004 * static_cast<double>(i)), true);
    hash = mix(hash, static_cast<std::uint32_t>(plant.readings().encoder_counts));
    hash = mix(hash, std::bit_cast<std::uint64_t>(plant.readings().current_a));
    hash = mix(hash, std::bit_cast<std::uint64_t>(plant.truth().q2_camera_rad));
  }
  return hash;
}

double largest_difference(const PlantParameters& p, double frequency_hz, double seconds) {
  Plant plain(quiet(), 1);
  Plant changed(p, 1);
  double largest = 0.0;
  for (int i = 1; i <= static_cast<int>(seconds * 1000.0); ++i) {
    const double q1 = 0.5 * det_sin(2.0 * kPi * frequency_hz * 0.001 * static_cast<double>(i));
    plain.step_kinematic(q1);
    changed.step_kinematic(q1);
    largest = std::max(largest, std::fabs(plain.truth().q2_camera_rad - changed.truth().q2_camera_rad));
  }
  return largest;
}

TEST(Plant, TheSameSeedGivesTheSameBits) {
  EXPECT_EQ(fingerprint(7), fingerprint(7));
  EXPECT_NE(fingerprint(7), fingerprint(8));
}

TEST(Plant, RestsWhereItIsWithoutCurrent) {
  Plant plant(quiet(), 1);
  for (int i = 0; i < 1000; ++i)
    plant.step(0.0, false);
  EXPECT_NEAR(plant.truth().q1_rad, 0.0, 1.0e-9);
  EXPECT_NEAR(plant.truth().q2_rad, 0.0, 1.0e-9);
  EXPECT_EQ(plant.readings().encoder_counts, 0);
}

TEST(Plant, TheMotorTorqueCarriesFrictionPretensionAndJointWhileSliding) {
  Plant plant(quiet(), 1);
  const std::vector<Truth> record = follow(plant, 0.05, 4.0);
  const PlantParameters p;
  const Truth& t = record.back();
  ASSERT_GT(t.q1_rate_rad_per_s, 0.01);
  const double expected_in = t.motor_torque_nm - p.motor_coulomb_nm - p.motor_viscous_nms_per_rad * t.q1_rate_rad_per_s;
  EXPECT_NEAR(t.tau_in_nm, expected_in, 2.0e-4);
  EXPECT_NEAR(t.tau_out_nm, p.joint_coulomb_nm + p.joint_viscous_nms_per_rad * t.q2_rate_rad_per_s, 2.0e-5);
}

TEST(Plant, StaysStableFromTheSoftestToTheStiffestTendon) {
  for (const double stiffness : {1.0e2, 5.0e4, 1.0e6, 1.0e8, 1.0e9}) {
    PlantParameters p = quiet();
    p.stiffness_top_n_per_m = p.stiffness_bottom_n_per_m = stiffness;
    p.joint_inertia_kgm2 = 1.0e-10;
    p.joint_viscous_nms_per_rad = 0.0;
    Plant plant(p, 1);
    for (const Truth& t : follow(plant, 1.0, 1.0)) {
      ASSERT_LT(std::fabs(t.q2_rad), 1.0) << stiffness;
      ASSERT_LT(std::fabs(t.tau_in_nm), 0.3) << stiffness;
    }
    const double follows = plant.truth().q1_rad * p.input_radius_m / p.output_radius_m - plant.truth().q2_rad;
    if (stiffness > 1.0e7) {
      EXPECT_NEAR(follows, 0.0, 1.0e-3) << stiffness;
    }
  }
}

TEST(Plant, SubstepsHardlyMatter) {
  PlantParameters fine = quiet();
  fine.substeps = 32;
  Plant a(quiet(), 1);
  Plant b(fine, 1);
  const std::vector<Truth> coarse_record = follow(a, 0.5, 4.0);
  const std::vector<Truth> fine_record = follow(b, 0.5, 4.0);
  double worst = 0.0;
  for (std::size_t i = 0; i < coarse_record.size(); ++i) {
    worst = std::max(worst, std::fabs(coarse_record[i].q2_rad - fine_record[i].q2_rad));
  }
  EXPECT_LT(worst, 1.0e-3);
}

TEST(Plant, CurrentLoopHasItsBandwidthAndLimit) {
  PlantParameters p = quiet();
  p.current_bandwidth_hz = 50.0;
  Plant plant(p, 1);
  plant.step(1.0, true);
  EXPECT_NEAR(plant.truth().current_a, 1.0 - std::exp(-2.0 * kPi * 50.0 * 0.001), 1.0e-12);
  for (int i = 0; i < 100; ++i)
    plant.step(9.0, true);
  EXPECT_NEAR(plant.truth().current_a, p.current_limit_a, 1.0e-9);
  plant.step(9.0, false);
  EXPECT_EQ(plant.truth().current_a, 0.0);
}

TEST(Plant, ASpringAtTheTipTakesItsTorque) {
  PlantParameters p = quiet();
  p.environment = {.kind = EnvironmentKind::kSpring, .stiffness = 0.05};
  Plant plant(p, 1);
  for (int i = 1; i <= 2000; ++i)
    plant.step_kinematic(0.5 * static_cast<double>(i) / 2000.0);
  const Truth& t = plant.truth();
  const double friction = p.joint_coulomb_nm + p.joint_viscous_nms_per_rad * t.q2_rate_rad_per_s;
  EXPECT_NEAR(t.tau_out_nm, 0.05 * t.q2_rad + friction, 1.0e-5);
}

TEST(Plant, AContactOnlyPushes) {
  PlantParameters p = quiet();
  p.environment = {.kind = EnvironmentKind::kHuntCrossley, .stiffness = 1.0, .damping = 0.5, .angle_rad = 0.2};
  Plant plant(p, 1);
  PlantParameters none = quiet();
  Plant free_plant(none, 1);
  double deepest = 0.0;
  double alone = 0.0;
  for (const Truth& t : follow(plant, 0.2, 5.0))
    deepest = std::max(deepest, t.q2_rad);
  for (const Truth& t : follow(free_plant, 0.2, 5.0))
    alone = std::max(alone, t.q2_rad);
  EXPECT_GT(deepest, 0.2);
  EXPECT_LT(deepest, alone - 0.03);
}

TEST(Plant, PlayLeavesTheJointBehindByItsWholeWidthAtAReversal) {
  PlantParameters with = quiet();
  with.effects.play_half_width_rad = 0.03;
  const auto still_rad = [](const PlantParameters& p) {
    Plant plant(p, 1);
    for (int i = 1; i <= 4000; ++i)
      plant.step_kinematic(0.4 * static_cast<double>(i) / 4000.0);
    const double turn = plant.truth().q2_rad;
    double q1 = 0.4;
    while (plant.truth().q2_rad > turn - 1.0e-4)
      plant.step_kinematic(q1 -= 1.0e-4);
    return 0.4 - q1;
  };
  const double ratio = with.output_radius_m / with.input_radius_m;
  EXPECT_NEAR(still_rad(with) - still_rad(quiet()), 2.0 * 0.03 * ratio, 2.0e-3);
}

TEST(Plant, TransportDelayMakesTheCameraLateAndNothingElse) {
  PlantParameters p = quiet();
  p.effects.transport_delay_s = 0.04;
  Plant plant(p, 1);
  Plant plain(quiet(), 1);
  const std::vector<Truth> late = follow(plant, 0.5, 2.0);
  const std::vector<Truth> prompt = follow(plain, 0.5, 2.0);
  for (std::size_t i = 100; i < late.size(); ++i) {
    ASSERT_EQ(late[i].q2_camera_rad, prompt[i - 40].q2_camera_rad);
    ASSERT_EQ(late[i].q2_rad, prompt[i].q2_rad);
  }
}

TEST(Plant, PretensionCanChangeDuringARun) {
  PlantParameters p = quiet();
  p.effects.pretension_change_n = -10.0;
  p.effects.pretension_change_at_s = 0.5;
  Plant plant(p, 1);
  const auto pretension = [&] {
    double sum = 0.0;
    for (const Tendon* t : {&plant.drivetrain().top(), &plant.drivetrain().bottom()}) {
      for (int i = 0; i < t->element_count(); ++i)
        sum += t->tension(i) * t->length_share(i);
    }
    return sum;
  };
  for (int i = 0; i < 400; ++i)
    plant.step(0.0, true);
  EXPECT_NEAR(pretension(), p.pretension_n, 1.0e-6);
  for (int i = 0; i < 400; ++i)
    plant.step(0.0, true);
  EXPECT_NEAR(pretension(), p.pretension_n - 10.0, 0.02);
}

TEST(Plant, StartsWithTheDeclaredPretensionEvenIfTheTendonsHarden) {
  for (const double hardening : {0.0, 0.03}) {
    PlantParameters p = quiet();
    p.effects.hardening_per_n = hardening;
    const Plant plant(p, 1);
    double sum = 0.0;
    for (const Tendon* t : {&plant.drivetrain().top(), &plant.drivetrain().bottom()}) {
      for (int i = 0; i < t->element_count(); ++i)
        sum += t->tension(i) * t->length_share(i);
    }
    EXPECT_NEAR(sum, p.pretension_n, 1.0e-9) << hardening;
  }
}

TEST(Plant, EveryEffectThatMovesTheJointIsSeenByTheCameraAndOffByDefault) {
  EXPECT_EQ(largest_difference(quiet(), 0.5, 1.0), 0.0);
  struct Case {
    const char* name;
    std::function<void(Effects&)> set;
  };
  const std::vector<Case> cases = {
      {"transmission_viscous", [](Effects& e) { e.transmission_viscous_forward_ns_per_m = 1000.0; }},
      {"play", [](Effects& e) { e.play_half_width_rad = 0.02; }},
      {"transport_delay", [](Effects& e) { e.transport_delay_s = 0.02; }},
      {"pretension", [](Effects& e) { e.pretension_change_n = -10.0; }},
      {"gravity", [](Effects& e) { e.gravity_torque_nm = 0.01; }},
      {"viscoelastic_creep",
       [](Effects& e) {
         e.creep_ratio = 0.5;
         e.creep_time_s = 0.5;
       }},
      {"thermal_drift",
       [](Effects& e) {
         e.thermal_growth_m = 2.0e-4;
         e.thermal_time_s = 1.0;
       }},
      {"stiffness_hardening", [](Effects& e) { e.hardening_per_n = 0.02; }},
      {"load_inertia", [](Effects& e) { e.load_inertia_kgm2 = 1.0e-3; }},
      {"wear", [](Effects& e) { e.wear_per_rad = 0.1; }},
      {"sticky_spot", [](Effects& e) { e.sticky_spot_nm = 0.02; }},
      {"tremor", [](Effects& e) { e.tremor_nm = 0.02; }},
      {"sheath_bend", [](Effects& e) { e.sheath_bend_per_rad = 1.0; }},
  };
  for (const Case& c : cases) {
    PlantParameters p = quiet();
    c.set(p.effects);
    EXPECT_GT(largest_difference(p, 0.5, 2.0), 0.002) << c.name;
  }
}

TEST(Plant, EffectsOnTheMotorSideShowInEncoderOrCurrent) {
  PlantParameters eccentric = quiet();
  eccentric.effects.angle_periodic_rad = 0.01;
  PlantParameters slipping = quiet();
  slipping.effects.pulley_slip_rad = 0.05;
  slipping.effects.pulley_slip_at_s = 0.5;
  Plant a(eccentric, 1);
  Plant b(slipping, 1);
  const double counts_per_rad = eccentric.encoder_counts_per_turn / (2.0 * kPi);
  for (int i = 1; i <= 1000; ++i) {
    a.step_kinematic(0.3 * static_cast<double>(i) / 1000.0);
    b.step_kinematic(0.3 * static_cast<double>(i) / 1000.0);
  }
  EXPECT_NEAR(a.readings().encoder_counts, (0.3 + 0.01 * std::sin(5.0 * 0.3)) * counts_per_rad, 1.0);
  EXPECT_NEAR(b.readings().encoder_counts, 0.35 * counts_per_rad, 1.0);
  slipping.effects.pulley_slip_every_s = 0.2;  // at 0.5, 0.7 and 0.9 s
  Plant again(slipping, 1);
  for (int i = 1; i <= 1000; ++i) {
    again.step_kinematic(0.3 * static_cast<double>(i) / 1000.0);
  }
  EXPECT_NEAR(again.readings().encoder_counts, 0.45 * counts_per_rad, 1.0);

  PlantParameters cogging = quiet();
  cogging.effects.magnetic_detent_nm = 0.01;
  PlantParameters fading = quiet();
  fading.effects.torque_fade = 0.3;
  fading.effects.torque_fade_time_s = 0.5;
  for (const PlantParameters& p : {cogging, fading}) {
    Plant plain(quiet(), 1);
    Plant changed(p, 1);
    const std::vector<Truth> x = follow(plain, 0.5, 2.0);
    const std::vector<Truth> y = follow(changed, 0.5, 2.0);
    double largest = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
      largest = std::max(largest, std::fabs(x[i].current_a - y[i].current_a));
    EXPECT_GT(largest, 0.03);
  }
}

TEST(Plant, SurvivesRoughTreatmentWithEveryEffectAtOnce) {
  PlantParameters p;
  p.pretension_n = 6.0;
  p.effects.transmission_viscous_forward_ns_per_m = 800.0;
  p.effects.play_half_width_rad = 0.02;
  p.effects.gravity_torque_nm = 0.01;
  p.effects.creep_ratio = 0.2;
  p.effects.thermal_growth_m = 1.0e-4;
  p.effects.hardening_per_n = 0.01;
  p.effects.wear_per_rad = 0.01;
  p.effects.sticky_spot_nm = 0.01;
  p.effects.tremor_nm = 0.005;
  p.effects.magnetic_detent_nm = 0.005;
  p.effects.sheath_bend_per_rad = 0.2;
  p.environment = {.kind = EnvironmentKind::kHuntCrossley, .stiffness = 5.0, .damping = 1.0, .angle_rad = 0.3};
  Plant plant(p, 5);
  Random random(9);
  double command = 0.0;
  for (int i = 0; i < 10000; ++i) {
    if (i % 40 == 0)
      command = random.normal() - 0.5 * plant.truth().q1_rad;
    plant.step(command, i % 3000 < 2800);
    ASSERT_TRUE(std::isfinite(plant.truth().q2_rad) && std::isfinite(plant.readings().current_a)) << i;
    ASSERT_LT(std::fabs(plant.truth().q2_rad), 100.0) << i;
  }
}

TEST(Plant, ACommandThatIsNotANumberIsRefusedWithASentence) {
  Plant plant(quiet(), 1);
  EXPECT_THROW(plant.step(std::numeric_limits<double>::quiet_NaN(), true), std::runtime_error);
  EXPECT_THROW(plant.step_kinematic(std::numeric_limits<double>::infinity()), std::runtime_error);
}

TEST(Plant, RunawayIsReportedInsteadOfNotANumber) {
  PlantParameters p = quiet();
  p.current_limit_a = 1000.0;
  Plant plant(p, 1);
  try {
    for (int i = 0; i < 60000; ++i)
      plant.step(1000.0, true);
    FAIL() << "the plant went on for ever";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("diverged"), std::string::npos);
  }
}

TEST(Plant, ImpossibleParametersAreRefusedByName) {
  PlantParameters p;
  p.stiffness_top_n_per_m = -5.0;
  try {
    const Plant plant(p, 1);
    FAIL() << "a negative stiffness was accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("stiffness_top_n_per_m"), std::string::npos);
  }
  p = PlantParameters{};
  p.substeps = 0;
  EXPECT_THROW(Plant(p, 1), std::invalid_argument);
  p = PlantParameters{};
  p.effects.pretension_change_n = -100.0;
  EXPECT_THROW(Plant(p, 1), std::invalid_argument);
}

TEST(Plant, AnEndStopHoldsTheJointAgainstTheMotorAndPushesOnTheTip) {
  PlantParameters stopped = quiet();
  stopped.stop_high_rad = 0.2;
  stopped.stop_low_rad = -0.2;
  stopped.stop_stiffness_nm_per_rad = 5.0;
  Plant with(stopped, 1);
  Plant without(quiet(), 1);
  for (int i = 0; i < 500; ++i) {
    with.step(1.5, true);
    without.step(1.5, true);
  }
  EXPECT_GT(without.truth().q2_rad, 1.0);
  EXPECT_GT(with.truth().q2_rad, 0.2);
  EXPECT_LT(with.truth().q2_rad, 0.25);
  EXPECT_NEAR(with.truth().tip_torque_nm, 5.0 * (with.truth().q2_rad - 0.2), 1e-3);
}

TEST(Plant, EndStopsInTheWrongOrderAreRefused) {
  PlantParameters stopped;
  stopped.stop_low_rad = 1.0;
  stopped.stop_high_rad = 1.0;
  EXPECT_THROW(Plant(stopped, 1), std::invalid_argument);
}

}  // namespace
}  // namespace capstan::sim
