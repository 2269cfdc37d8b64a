// SPDX-License-Identifier: Apache-2.0
// High-frequency input: the joint on its tendons against the linear oscillator that it is without friction, and against
// the quasi-static mode where both must agree.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "capstan/hal/sim/multi_plant.hpp"
#include "capstan/tests/hal/sim/support.hpp"

namespace capstan::sim {
namespace {

using test::quiet;

constexpr double kPi = std::numbers::pi;

// Tendons without friction, taut throughout: two springs.
PlantParameters oscillator(SolverMode mode) {
  PlantParameters p = quiet();
  p.mode = mode;
  p.eta_top = p.eta_bottom = 0.0;
  p.joint_coulomb_nm = p.motor_coulomb_nm = 0.0;
  p.pretension_n = 500.0;
  return p;
}

double stiffness(const PlantParameters& p) {
  return p.output_radius_m * p.output_radius_m * (p.stiffness_top_n_per_m + p.stiffness_bottom_n_per_m);
}

// Amplitude of q2 at `frequency_hz` over the last half second of one, by projection.
template <class Step>
double response(Step&& step, double frequency_hz) {
  std::complex<double> sum = 0.0;
  for (int i = 1; i <= 1000; ++i) {
    const double q2 = step();
    if (i > 500)
      sum += q2 * std::polar(1.0, -2.0 * kPi * frequency_hz * 0.001 * i);
  }
  return std::abs(sum) / 250.0;
}

// A periodic torque at the tip, the motor held.
double tip_response(PlantParameters p, double frequency_hz) {
  p.effects.tremor_nm = 0.005;
  p.effects.tremor_hz = frequency_hz;
  Plant plant(p, 1);
  return response(
      [&] {
        plant.step_kinematic(0.0);
        return plant.truth().q2_rad;
      },
      frequency_hz);
}

// J q'' + c q' + k q = torque.
double expected_tip_response(const PlantParameters& p, double frequency_hz) {
  const double w = 2.0 * kPi * frequency_hz;
  const std::complex<double> impedance(stiffness(p) - p.joint_inertia_kgm2 * w * w, p.joint_viscous_nms_per_rad * w);
  return 0.005 / std::abs(impedance);
}

TEST(DynamicMode, AJointOnItsTendonsResonatesAsTheLinearOscillatorDoes) {
  PlantParameters p = oscillator(SolverMode::kDynamic);
  const double natural = std::sqrt(stiffness(p) / p.joint_inertia_kgm2) / (2.0 * kPi);
  EXPECT_NEAR(natural, 192.4, 0.1);
  for (const double f : {10.0, 60.0, 120.0, 170.0, 192.0, 220.0, 300.0}) {
    const double expected = expected_tip_response(p, f);
    p.substeps = 4;
    const double error = tip_response(p, f) - expected;
    EXPECT_NEAR(error, 0.0, 0.05 * expected) << f;
    // Second order: with twice the sub-steps a quarter is left, but for the trace of damping.
    p.substeps = 8;
    EXPECT_NEAR(tip_response(p, f) - expected, 0.0, 0.25 * std::fabs(error) + 0.01 * expected) << f;
  }
}

TEST(DynamicMode, TheQuasiStaticModeAgreesFarBelowTheResonanceAndFlattensIt) {
  const PlantParameters p = oscillator(SolverMode::kQuasiStatic);
  EXPECT_NEAR(tip_response(p, 10.0), expected_tip_response(p, 10.0), 0.005 * expected_tip_response(p, 10.0));
  EXPECT_LT(tip_response(p, 192.0), 0.75 * expected_tip_response(p, 192.0));
}

TEST(DynamicMode, AMotorThatShakesItsEndOfTheTendonsMovesTheJointByTheTransferFunction) {
  const PlantParameters p = oscillator(SolverMode::kDynamic);
  for (const double f : {20.0, 60.0, 120.0}) {
    Plant plant(p, 1);
    int i = 0;
    const double amplitude = response(
        [&] {
          plant.step_kinematic(0.02 * std::sin(2.0 * kPi * f * 0.001 * ++i));
          return plant.truth().q2_rad;
        },
        f);
    // The hand moves on straight lines from step to step, which leaves sinc^2 of the amplitude.
    const double sinc = std::sin(kPi * f * 0.001) / (kPi * f * 0.001);
    const double still = 0.02 * sinc * sinc * p.input_radius_m / p.output_radius_m;
    const double expected = still * expected_tip_response(p, f) * stiffness(p) / 0.005;
    EXPECT_NEAR(amplitude, expected, 0.02 * expected) << f;
  }
}

TEST(DynamicMode, WithoutDampingARingFadesByTheTraceThatTheSolverAdds) {
  PlantParameters p = oscillator(SolverMode::kDynamic);
  p.joint_viscous_nms_per_rad = 0.0;
  p.joint_inertia_kgm2 *= 16.0;  // 48 Hz
  Plant plant(p, 1);
  plant.step_kinematic(0.05);
  const double rest = 0.05 * p.input_radius_m / p.output_radius_m;
  double early = 0.0;
  double late = 0.0;
  for (int i = 0; i < 1000; ++i) {
    plant.step_kinematic(0.05);
    double& peak = i < 40 ? early : late;
    if (i < 40 || i >= 960)
      peak = std::max(peak, std::fabs(plant.truth().q2_rad - rest));
  }
  // 0.02 w h of critical damping, w = 302 rad/s, h = 0.25 ms, over 0.96 s.
  const double w = std::sqrt(stiffness(p) / p.joint_inertia_kgm2);
  EXPECT_GT(early, 0.03);
  EXPECT_NEAR(late / early, std::exp(-0.02 * w * 2.5e-4 * w * 0.96), 0.03);
}

TEST(DynamicMode, FrictionHoldsAndSlowLoopsAreTheSameInBothModes) {
  PlantParameters dynamic = quiet();
  dynamic.mode = SolverMode::kDynamic;
  test::Bench a(quiet());
  test::Bench b(dynamic);
  for (const double target : {0.5, -0.5, 0.2, -0.1, 0.5}) {
    const std::vector<Truth> x = a.go(target);
    const std::vector<Truth> y = b.go(target);
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_NEAR(x[i].q2_rad, y[i].q2_rad, 2.0e-3) << target << " " << i;
      ASSERT_NEAR(x[i].tau_in_nm, y[i].tau_in_nm, 4.0e-3) << target << " " << i;
    }
  }
  // Left alone, everything stands still.
  Plant plant(dynamic, 1);
  for (int i = 0; i < 500; ++i)
    plant.step(0.0, false);
  EXPECT_EQ(plant.truth().q2_rate_rad_per_s, 0.0);
  EXPECT_NEAR(plant.truth().q1_rad, 0.0, 1.0e-9);
}

TEST(DynamicMode, CoupledAxesMoveAsPlantsOfTheirOwn) {
  PlantParameters p = quiet();
  p.mode = SolverMode::kDynamic;
  p.effects.play_half_width_rad = 0.01;
  Plant alone(p, 1);
  MultiPlant together({{"a", p, {}}, {"b", p, {}}}, 1);
  for (int i = 0; i < 2000; ++i) {
    const double current = 1.2 * std::sin(0.03 * i) * std::sin(0.0007 * i * i / 100.0);
    alone.step(current, true);
    together.step(std::vector<MotorCommand>{{current, true}, {-current, true}});
    ASSERT_NEAR(together.truth(0).q2_rad, alone.truth().q2_rad, 1.0e-5) << i;
  }
  PlantParameters other = p;
  other.mode = SolverMode::kQuasiStatic;
  EXPECT_THROW(MultiPlant({{"a", p, {}}, {"b", other, {}}}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace capstan::sim
