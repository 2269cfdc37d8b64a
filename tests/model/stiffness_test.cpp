// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/stiffness.hpp"

#include <gtest/gtest.h>

#include "capstan/tests/model/integrated_tension.hpp"

namespace capstan {
namespace {

using test::integrate;

constexpr TendonPair kPair = {{1.1414, 5.0664e4}, {0.8, 4.0e4}, 0.0026, 0.0024};

/// A small step of the motor against a spring at the joint, from the tendons' balances: unknown steps of both input
/// tensions, of the joint and the motor. Areas and ends are integrated, not taken from the closed forms.
struct Step {
  double compliance, gain;
};
auto small_step(const TendonPair& pair, bool pushed_taut, double environment) -> Step {
  const auto pulled = integrate(pair.pulled.eta, 1.0, 1.0);
  const auto pushed = integrate(pair.pushed.eta, -1.0, 1.0);
  // delta = r1 dq1 - r2 dq2 stretches the pulled tendon by itself and lets the pushed one go by as much.
  constexpr double kDelta = 1e-6;
  const double pulled_in = kDelta * pair.pulled.stiffness / pulled.area;
  const double pushed_in = pushed_taut ? -kDelta * pair.pushed.stiffness / pushed.area : 0.0;
  const double torque_in = (pulled_in - pushed_in) * pair.r1;
  const double torque_out = (pulled_in * pulled.end_tension - pushed_in * pushed.end_tension) * pair.r2;
  const double dq2 = torque_out / environment;
  return {(kDelta + pair.r2 * dq2) / pair.r1 / torque_in, torque_out / torque_in};
}

TEST(CombinedCompliance, IsTheSmallStepOfBothTendonsAndTheSpring) {
  for (const double environment : {0.01, 0.2, 3.0, 1e6}) {
    for (const bool pushed_taut : {true, false}) {
      const auto phase = phase_stiffness(kPair, pushed_taut ? ForcePhase::kBothActive : ForcePhase::kOneSlack);
      const Step step = small_step(kPair, pushed_taut, environment);
      EXPECT_NEAR(phase.gain, step.gain, 1e-9 * step.gain);
      EXPECT_NEAR(combined_compliance(kPair, phase, environment), step.compliance, 1e-9 * step.compliance);
      EXPECT_NEAR(environment_stiffness(kPair, phase, step.compliance), environment, 1e-6 * environment);
    }
  }
}

TEST(PhaseStiffness, FallsFromPhaseToPhaseAndIsThePrintedMinimumInTheThird) {
  const double second = phase_stiffness(kPair, ForcePhase::kPulledActive, 1.0, 0.3).stiffness;
  const double third = phase_stiffness(kPair, ForcePhase::kBothActive).stiffness;
  const double fourth = phase_stiffness(kPair, ForcePhase::kOneSlack).stiffness;
  EXPECT_GT(phase_stiffness(kPair, ForcePhase::kHeld, 0.2, 0.1).stiffness, second);
  EXPECT_GT(second, third);
  EXPECT_GT(third, fourth);
  const double pull = 5.0664e4 * 1.1414 / (1.0 - std::exp(-1.1414));  // (3.8)
  const double push = 4.0e4 * 0.8 / (std::exp(0.8) - 1.0);            // (3.9)
  EXPECT_NEAR(third, 0.0026 * 0.0026 * (pull + push), 1e-9 * third);  // (3.21)
  EXPECT_EQ(phase_stiffness(kPair, ForcePhase::kHeld, 0.2, 0.1).gain, 0.0);
}

// Equal tendons: what is pulled in is let out, so the third phase passes torque as if there were no friction.
TEST(PhaseStiffness, ThirdPhaseOfEqualTendonsPassesTorqueLikeARigidOne) {
  const TendonPair equal = {{1.1414, 5.0e4}, {1.1414, 5.0e4}, 0.0026, 0.0024};
  EXPECT_NEAR(phase_stiffness(equal, ForcePhase::kBothActive).gain, 0.0024 / 0.0026, 1e-12);
}

// (3.26) lacks r1^2, and (3.22) the pulleys' ratio and the friction.
TEST(CombinedCompliance, PrintedSeriesConnectionIsRefuted) {
  const double environment = 0.2;
  const Step slack = small_step(kPair, false, environment);
  const double pull = apparent_stiffness(kPair.pulled, 1.0);
  EXPECT_GT(std::fabs(1.0 / pull + 1.0 / environment - slack.compliance), 0.5 * slack.compliance);
  EXPECT_GT(std::fabs(1.0 / (kPair.r1 * kPair.r1 * pull) + 1.0 / environment - slack.compliance),
            0.5 * slack.compliance);
}

}  // namespace
}  // namespace capstan
