// SPDX-License-Identifier: Apache-2.0
// The closed forms of one and two tendons beside the simulated chains of springs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "capstan/hal/sim/plant.hpp"
#include "capstan/model/stiffness.hpp"
#include "capstan/model/tension_profile.hpp"

namespace capstan {
namespace {

TEST(TensionProfileOnThePlant, FollowsAChainOfManySpringsMovedAtItsInput) {
  const sim::TendonParameters parameters{.element_count = 256, .stiffness_n_per_m = 5.0664e4, .eta = 1.1414};
  const double start_m = 12.0 / parameters.stiffness_n_per_m;
  sim::Tendon chain(parameters, start_m);
  TensionProfile profile({parameters.eta, parameters.stiffness_n_per_m}, 12.0);
  std::mt19937 engine(41);
  std::uniform_real_distribution<double> target(0.3 * start_m, 3.0 * start_m);
  double worst_out = 0.0;
  double worst_elongation = 0.0;
  double elongation = start_m;
  for (int turn = 0; turn < 30; ++turn) {
    const double to = target(engine);
    for (int i = 0; i < 50; ++i) {
      const double move = (to - elongation) / (50 - i);
      const auto& ends = chain.trial(-move, 0.0, 0.001);
      chain.commit();
      elongation += move;
      profile.pull_to(ends.input_n);
      worst_out = std::fmax(worst_out, std::fabs(profile.at(1.0) - ends.output_n));
      worst_elongation = std::fmax(worst_elongation, std::fabs(profile.elongation() - chain.elongation()));
    }
  }
  std::printf("tension profile against a chain of 256: output %.2e N, elongation %.2e of the largest\n", worst_out,
              worst_elongation / (3.0 * start_m));
  EXPECT_LT(worst_out, 0.15);
  EXPECT_LT(worst_elongation, 2e-3 * 3.0 * start_m);
}

/// Compliance dq1 / dtau_in felt on a slow press against a spring, by least squares over a stretch of torque, with both
/// tendons active (below the slack torque) or one slack (above).
auto felt_compliance(const sim::PlantParameters& p, bool one_slack) -> double {
  sim::Plant plant(p, 1);
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  // There and back once, so that what is felt is a branch after a reversal.
  double q1 = 0.0;
  const auto go = [&](double to, bool look) {
    const int steps = static_cast<int>(std::fabs(to - q1) / 1e-4);
    const double step = (to - q1) / steps;
    for (int i = 0; i < steps; ++i) {
      q1 += step;
      plant.step_kinematic(q1);
      const double tau = plant.truth().tau_in_nm;
      const auto& top = plant.drivetrain().top();
      const auto& bottom = plant.drivetrain().bottom();
      const int last = bottom.element_count() - 1;
      const bool slack = bottom.elongation() <= 0.0;
      const bool pulled = std::fabs(std::log(top.tension(0) / top.tension(last)) - p.eta_top) < 1e-6;
      const bool pushed = std::fabs(std::log(bottom.tension(last) / bottom.tension(0)) - p.eta_bottom) < 1e-6;
      const bool both = !slack && pulled && pushed;
      if (look && (one_slack ? slack && tau > 0.0 : both)) {
        n += 1.0;
        sx += tau;
        sy += q1;
        sxx += tau * tau;
        sxy += tau * q1;
      }
    }
  };
  go(0.6, false);
  go(-0.6, false);
  go(0.9, true);
  EXPECT_GT(n, 100.0);
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

TEST(CombinedComplianceOnThePlant, IsFeltInPhasesIIIAndIVWhateverTheEnvironment) {
  for (const double environment : {0.05, 0.2, 1.0}) {
    sim::PlantParameters p;
    p.environment.kind = sim::EnvironmentKind::kSpring;
    p.environment.stiffness = environment;
    p.joint_coulomb_nm = 0.0;
    p.joint_viscous_nms_per_rad = 0.0;
    p.pretension_n = 15.0;
    p.element_count = 64;
    const TendonPair pair = {{p.eta_top, p.stiffness_top_n_per_m},
                             {p.eta_bottom, p.stiffness_bottom_n_per_m},
                             p.input_radius_m,
                             p.output_radius_m};
    for (const bool one_slack : {false, true}) {
      const auto phase = phase_stiffness(pair, one_slack ? ForcePhase::kOneSlack : ForcePhase::kBothActive);
      const double felt = felt_compliance(p, one_slack);
      const double expected = combined_compliance(pair, phase, environment);
      std::printf(
          "K_env %.2f N m/rad, phase %s: felt %.4f rad/(N m), closed form %.4f, as printed %.4f; K_env back %.4f\n",
          environment, one_slack ? "IV" : "III", felt, expected, 1.0 / phase.stiffness + 1.0 / environment,
          environment_stiffness(pair, phase, felt));
      EXPECT_NEAR(felt, expected, 1e-3 * expected) << environment << (one_slack ? ", IV" : ", III");
    }
  }
}

}  // namespace
}  // namespace capstan
