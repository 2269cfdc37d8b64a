// SPDX-License-Identifier: Apache-2.0
// Effects with a number that physics gives: axis coupling, elastic friction, the motor's own frictions. The others are
// in plant_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>
#include <vector>

#include "capstan/hal/sim/fields.hpp"
#include "capstan/hal/sim/plant.hpp"
#include "capstan/tests/hal/sim/support.hpp"

namespace capstan::sim {
namespace {

using test::quiet;

PlantParameters with(std::initializer_list<std::pair<const char*, double>> settings) {
  PlantParameters p = quiet();
  for (const auto& [name, value] : settings)
    set_effect(p.effects, name, value);
  return p;
}

// What the motor gives beyond what the tendons take while the input pulley turns at a constant speed, N m.
double motor_friction(const PlantParameters& p, double speed) {
  Plant plant(p, 1);
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < 2000; ++i) {
    const Truth& t = plant.truth();
    plant.step(60.0 * (speed * t.time_s - t.q1_rad) + 0.4 * (speed - t.q1_rate_rad_per_s), true);
    if (i < 1000)
      continue;
    sum += p.torque_constant_nm_per_a * plant.truth().current_a - plant.truth().tau_in_nm;
    ++count;
  }
  return sum / count;
}

TEST(Effects, TheMotorsFrictionsAddUpToWhatTheySay) {
  const PlantParameters p = quiet();
  const double plain = p.motor_coulomb_nm + 0.2 * p.motor_viscous_nms_per_rad;
  EXPECT_NEAR(motor_friction(p, 0.2), plain, 1.0e-5);
  EXPECT_NEAR(motor_friction(with({{"viscous_friction", 0.01}}), 0.2), plain + 0.002, 1.0e-5);
  EXPECT_NEAR(motor_friction(with({{"coulomb_friction", 0.004}}), 0.2), plain + 0.004, 1.0e-5);
  EXPECT_NEAR(motor_friction(with({{"offset", 0.004}}), 0.2), plain + 0.004, 1.0e-5);
  EXPECT_NEAR(motor_friction(with({{"offset", 0.004}}), -0.2), -plain + 0.004, 1.0e-5);
  EXPECT_NEAR(motor_friction(with({{"friction_asymmetry", 0.3}}), 0.2), 1.3 * plain, 1.0e-5);
  EXPECT_NEAR(motor_friction(with({{"friction_asymmetry", 0.3}}), -0.2), -0.7 * plain, 1.0e-5);
  EXPECT_NEAR(motor_friction(with({{"play_friction", 0.003}}), 0.2), plain + 0.003, 1.0e-5);
  const PlantParameters stribeck = with({{"stribeck_friction", 0.004}, {"stribeck_friction.rate_rad_per_s", 0.1}});
  // Where it falls with speed the servo wobbles a little about the wanted one.
  EXPECT_NEAR(motor_friction(stribeck, 0.1),
              p.motor_coulomb_nm + 0.1 * p.motor_viscous_nms_per_rad + 0.004 * std::exp(-1.0), 4.0e-4);
  EXPECT_NEAR(motor_friction(stribeck, 0.5), p.motor_coulomb_nm + 0.5 * p.motor_viscous_nms_per_rad, 1.0e-5);
}

TEST(Effects, ElasticFrictionIsASpringUntilItYields) {
  // The joint pushed by tremor alone, too weak for the elastic part to yield and without Coulomb friction: it swings
  // about where it is by torque / (tendons' stiffness + force / width), and comes back.
  PlantParameters p =
      with({{"presliding", 0.02}, {"presliding.width_rad", 0.02}, {"tremor", 0.004}, {"tremor.frequency_hz", 0.5}});
  p.joint_coulomb_nm = 0.0;
  PlantParameters bare = p;
  bare.effects.presliding_nm = 0.0;
  const auto swing = [](const PlantParameters& parameters) {
    Plant plant(parameters, 1);
    double high = -1.0;
    double low = 1.0;
    for (int i = 0; i < 4000; ++i) {
      plant.step_kinematic(0.0);
      high = std::max(high, plant.truth().q2_rad);
      low = std::min(low, plant.truth().q2_rad);
    }
    return high - low;
  };
  const double stiffness_alone = 0.008 / swing(bare);
  EXPECT_NEAR(0.008 / swing(p), stiffness_alone + 0.02 / 0.02, 0.15 * stiffness_alone);
}

TEST(Effects, PreslidingDelaysTheReversalByTwiceItsWidth) {
  PlantParameters p = with({{"presliding", 0.004}, {"presliding.width_rad", 0.05}});
  Plant plant(p, 1);
  for (int i = 1; i <= 4000; ++i)
    plant.step_kinematic(0.4 * static_cast<double>(i) / 4000.0);
  const double out = plant.truth().tau_out_nm;
  const double turn = plant.truth().q2_rad;
  EXPECT_NEAR(out, p.joint_coulomb_nm + 0.004 + p.joint_viscous_nms_per_rad * plant.truth().q2_rate_rad_per_s, 1.0e-5);
  // Once the joint has turned back by twice the width, the torque is that of sliding backward; half way, in between.
  double half_way = 0.0;
  for (double q1 = 0.4; plant.truth().q2_rad > turn - 0.1; q1 -= 1.0e-4) {
    plant.step_kinematic(q1);
    if (plant.truth().q2_rad > turn - 0.05)
      half_way = plant.truth().tau_out_nm;
  }
  EXPECT_NEAR(plant.truth().tau_out_nm, -out, 5.0e-5);
  EXPECT_NEAR(half_way, -p.joint_coulomb_nm, 2.0e-4);
}

TEST(Effects, ASecondJointCarriesThisOneByTheRatioOfTheRadii) {
  PlantParameters p = with({{"axis_coupling", 0.5}, {"axis_coupling.frequency_hz", 0.2}});
  Plant plant(p, 1);
  double high = 0.0;
  double second = 0.0;
  for (int i = 0; i < 1250; ++i) {
    plant.step_kinematic(0.0);
    high = std::min(high, plant.truth().q2_rad);
    second = std::max(second, plant.truth().second_rad);
  }
  EXPECT_NEAR(second, 0.5, 1.0e-4);
  // Longer on the top run turns the joint back. The tendons' own friction and the joint's take a share.
  EXPECT_NEAR(high, -0.5 * p.effects.axis_coupling_radius_m / p.output_radius_m, 0.06);
  EXPECT_LT(high, -0.2);
}

TEST(Effects, EveryNameOfTheTransmissionCatalogueIsAnEffectOrArisesByItself) {
  // reversal_memory and slip_propagation are what the chain does anyway: phenomena_test.cpp measures them.
  for (const char* name :
       {"transmission_viscous", "pretension", "play", "presliding", "gravity", "axis_coupling", "viscoelastic_creep",
        "thermal_drift", "angle_periodic", "transport_delay", "stiffness_hardening", "load_inertia", "viscous_friction",
        "coulomb_friction", "friction_asymmetry", "stribeck_friction", "play_friction", "offset"}) {
    Effects effects;
    EXPECT_NO_THROW(set_effect(effects, name, 0.01)) << name;
  }
}

// What the tendons give to a joint that an environment holds back, and what the environment should take: friction of
// the joint, and `expected` of its angle and rate, while it is pushed in, held and let go.
void expect_torque(const Environment& environment, double tolerance_nm, auto&& expected) {
  PlantParameters p = quiet();
  p.environment = environment;
  p.joint_coulomb_nm = p.joint_viscous_nms_per_rad = 0.0;
  p.joint_inertia_kgm2 = 1.0e-9;
  Plant plant(p, 1);
  double deepest = 0.0;
  for (int i = 1; i <= 3000; ++i) {
    plant.step_kinematic(0.5 * std::sin(3.14159265358979 * static_cast<double>(i) / 3000.0));
    const Truth& t = plant.truth();
    ASSERT_NEAR(t.tau_out_nm, expected(t.q2_rad, t.q2_rate_rad_per_s), tolerance_nm) << i;
    deepest = std::max(deepest, t.q2_rad);
  }
  EXPECT_GT(deepest, 0.2);
}

TEST(Environment, KelvinVoigtIsASpringBesideADashpot) {
  expect_torque({.kind = EnvironmentKind::kKelvinVoigt, .stiffness = 0.04, .damping = 0.02, .angle_rad = 0.05}, 1.0e-6,
                [](double angle, double rate) { return 0.04 * (angle - 0.05) + 0.02 * rate; });
}

TEST(Environment, HuntCrossleyFollowsItsLawAndLosesWhatItsLoopHolds) {
  // stiffness d^1.5 (1 + damping d') from the surface on; before it, and once it has been left, nothing.
  const Environment contact{
      .kind = EnvironmentKind::kHuntCrossley, .stiffness = 0.3, .damping = 0.8, .angle_rad = 0.15};
  expect_torque(contact, 1.0e-6, [](double angle, double rate) {
    const double depth = std::max(angle - 0.15, 0.0);
    return 0.3 * depth * std::sqrt(depth) * std::max(1.0 + 0.8 * rate, 0.0);
  });
  // A thrust of a half sine, a sin(w t): the spring gives its work back, and damping takes the integral over
  // stiffness damping d^1.5 d'^2.
  constexpr double kDepth = 0.2;
  constexpr double kRate = 4.0;
  double lost = 0.0;
  double closed = 0.0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double phase = 3.14159265358979 * (i + 0.5) / kSteps;
    const double dt = 3.14159265358979 / kRate / kSteps;
    const double depth = kDepth * std::sin(phase);
    const double rate = kDepth * kRate * std::cos(phase);
    lost += environment_torque(contact, 0.15 + depth, rate).value * rate * dt;
    closed += 0.3 * 0.8 * std::pow(depth, 1.5) * rate * rate * dt;
  }
  EXPECT_NEAR(lost, closed, 1.0e-6 * closed);
}

TEST(Environment, ALockedJointStandsAndASpringIsFeltInBothDirections) {
  PlantParameters p = quiet();
  p.environment.kind = EnvironmentKind::kLocked;
  Plant plant(p, 1);
  double most = 0.0;
  for (int i = 1; i <= 500; ++i) {
    plant.step_kinematic(0.3 * std::sin(0.012 * i));
    ASSERT_EQ(plant.truth().q2_rad, 0.0);
    most = std::max(most, std::fabs(plant.truth().tau_in_nm));
  }
  EXPECT_GT(most, 0.1);
  expect_torque({.kind = EnvironmentKind::kSpring, .stiffness = 0.05, .angle_rad = 0.1}, 5.0e-6,
                [](double angle, double) { return 0.05 * (angle - 0.1); });
}

TEST(Environment, LayeredTissueIsSoftThenStiffAndKnowsItsInclusion) {
  PlantParameters p = quiet();
  p.environment = {.kind = EnvironmentKind::kLayered,
                   .stiffness = 0.05,
                   .angle_rad = 0.1,
                   .layer_depth_rad = 0.1,
                   .deep_stiffness = 0.3,
                   .inclusion_stiffness = 0.2,
                   .inclusion_depth_rad = 0.05,
                   .inclusion_site_m = 0.02,
                   .inclusion_width_m = 0.004};
  const auto torque = [&](double site, double depth) {
    Environment e = p.environment;
    e.site_m = site;
    return environment_torque(e, 0.1 + depth, 0.0).value;
  };
  EXPECT_EQ(torque(0.0, -0.05), 0.0);
  EXPECT_NEAR(torque(0.0, 0.04), 0.05 * 0.04, 1.0e-12);
  EXPECT_NEAR(torque(0.0, 0.15), 0.05 * 0.1 + 0.3 * 0.05, 1.0e-6);
  EXPECT_NEAR(torque(0.02, 0.15) - torque(0.0, 0.15), 0.2 * 0.1, 1.0e-6);
  EXPECT_NEAR((torque(0.024, 0.15) - torque(0.0, 0.15)) / (0.2 * 0.1), std::exp(-1.0), 1.0e-6);
}

TEST(Environment, PalpationOfARowOfSitesFeelsTheInclusionInTheTipForce) {
  PlantParameters p = quiet();
  p.environment = {.kind = EnvironmentKind::kLayered,
                   .stiffness = 0.02,
                   .angle_rad = 0.1,
                   .deep_stiffness = 0.05,
                   .inclusion_stiffness = 0.05,
                   .inclusion_site_m = 0.02,
                   .inclusion_width_m = 0.004,
                   .site_step_m = 0.01,
                   .site_period_s = 1.0};
  Plant plant(p, 1);
  std::vector<double> peak(5, 0.0);
  for (int i = 0; i < 5000; ++i) {
    const double within = static_cast<double>(i % 1000) / 1000.0;
    plant.step_kinematic(0.5 * std::sin(3.14159265358979 * within));
    peak[static_cast<std::size_t>(i / 1000)] =
        std::max(peak[static_cast<std::size_t>(i / 1000)], plant.truth().tip_force_n);
  }
  EXPECT_GT(peak[2], 1.3 * peak[0]);
  EXPECT_NEAR(peak[4], peak[0], 0.1 * peak[0]);
}

TEST(Environment, TheTipForceSensorHasItsNoiseAndScale) {
  PlantParameters p = quiet();
  p.tip_force_noise_n = 0.05;
  p.environment = {.kind = EnvironmentKind::kSpring, .stiffness = 0.05};
  Plant plant(p, 1);
  for (int i = 1; i <= 1000; ++i)
    plant.step_kinematic(0.4 * static_cast<double>(i) / 1000.0);
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < 4000; ++i) {
    plant.step_kinematic(0.4);
    sum += plant.truth().tip_force_n;
    squares += plant.truth().tip_force_n * plant.truth().tip_force_n;
  }
  const double mean = sum / 4000.0;
  EXPECT_NEAR(mean, 0.05 * plant.truth().q2_rad / p.tip_length_m, 0.005);
  EXPECT_NEAR(std::sqrt(squares / 4000.0 - mean * mean), 0.05, 0.003);
}

}  // namespace
}  // namespace capstan::sim
