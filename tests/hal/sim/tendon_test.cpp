// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/tendon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "capstan/hal/sim/random.hpp"
#include "capstan/tests/hal/sim/slow_tendon.hpp"

namespace capstan::sim {
namespace {

constexpr double kStiffness = 5.07e4;
constexpr double kEta = 1.14;
constexpr double kDt = 2.5e-4;

TendonParameters chain(int elements) {
  return {.element_count = elements, .stiffness_n_per_m = kStiffness, .eta = kEta};
}

// Moves the input end away from the output by `distance` in equal steps; positive pulls.
TendonEnds pull(Tendon& tendon, double distance, int steps) {
  TendonEnds ends;
  for (int i = 0; i < steps; ++i) {
    ends = tendon.trial(-distance / steps, 0.0, kDt);
    tendon.commit();
  }
  return ends;
}

double tension_integral(const Tendon& tendon) {
  double sum = 0.0;
  for (int i = 0; i < tendon.element_count(); ++i)
    sum += tendon.tension(i) * tendon.length_share(i);
  return sum;
}

TEST(Tendon, FullySlidingChainHasTheClosedFormTensionRatio) {
  for (const int elements : {2, 5, 16, 64}) {
    Tendon tendon(chain(elements), 0.0);
    const TendonEnds ends = pull(tendon, 1.0e-3, 10);
    EXPECT_NEAR(ends.output_n / ends.input_n, std::exp(-kEta), 1.0e-12) << elements;
  }
}

TEST(Tendon, FullySlidingElongationConvergesToTheClosedFormWithTheSquareOfTheElementSize) {
  std::vector<double> errors;
  for (const int nodes : {8, 16, 32, 64}) {
    Tendon tendon(chain(nodes + 1), 0.0);
    const TendonEnds ends = pull(tendon, 1.0e-3, 10);
    const double closed = ends.input_n * (1.0 - std::exp(-kEta)) / (kEta * kStiffness);
    errors.push_back(std::fabs(1.0e-3 / closed - 1.0));
  }
  EXPECT_LT(errors[1], 5.0e-4);
  for (std::size_t i = 1; i < errors.size(); ++i)
    EXPECT_NEAR(errors[i - 1] / errors[i], 4.0, 0.1);
}

TEST(Tendon, ApparentStiffnessIsThatOfAPulledAndOfAPushedTendon) {
  Tendon tendon(chain(64), 5.0e-4);
  TendonEnds ends = pull(tendon, 1.0e-3, 100);
  EXPECT_NEAR(-ends.input_by_input, kStiffness * kEta / (1.0 - std::exp(-kEta)), 1.0e-3 * kStiffness);
  ends = pull(tendon, -1.35e-3, 100);
  EXPECT_NEAR(-ends.input_by_input, kStiffness * kEta / (std::exp(kEta) - 1.0), 1.0e-3 * kStiffness);
  EXPECT_NEAR(ends.output_n / ends.input_n, std::exp(kEta), 1.0e-9);
}

TEST(Tendon, APartlySlidingChainFollowsTheSlipFront) {
  const double elongation = 5.0e-4;
  Tendon tendon(chain(200), elongation);
  const double rest = kStiffness * elongation;
  const double distance = 1.0e-5;
  const TendonEnds ends = pull(tendon, distance, 20);
  // (2.10) from an even profile: the front stands where T_in exp(-eta phi) meets the rest tension.
  const double front = std::log(ends.input_n / rest) / kEta;
  const double expected = ((ends.input_n - rest) / kEta - rest * front) / kStiffness;
  EXPECT_LT(front, 0.5);
  EXPECT_NEAR(expected, distance, 0.01 * distance);
  EXPECT_DOUBLE_EQ(ends.output_n, rest);
  EXPECT_DOUBLE_EQ(ends.output_by_input, 0.0);
}

TEST(Tendon, ElongationIsTheIntegralOfTensionOverStiffness) {
  Tendon tendon(chain(16), 3.0e-4);
  pull(tendon, 2.0e-4, 7);
  EXPECT_NEAR(tension_integral(tendon), kStiffness * 5.0e-4, 1.0e-9);
}

struct Walk {
  const char* name;
  double drag_to_input, drag_to_output;
  double step;
};

class TendonWalk : public ::testing::TestWithParam<Walk> {};

TEST_P(TendonWalk, AgreesWithTheSlowReference) {
  const Walk& walk = GetParam();
  constexpr int kElements = 9;
  TendonParameters parameters = chain(kElements);
  parameters.drag_to_input_ns_per_m = walk.drag_to_input;
  parameters.drag_to_output_ns_per_m = walk.drag_to_output;
  const double start = 4.0e-4;
  Tendon fast(parameters, start);
  test::SlowTendon slow(kElements, kStiffness, kEta, start);
  slow.set_drag(walk.drag_to_input, walk.drag_to_output);
  Random random(11);
  double input = 0.0;
  double output = 0.0;
  double worst = 0.0;
  for (int i = 0; i < 300; ++i) {
    // Ends wander independently, pulled back so that the chain stays taut: same and opposite directions both occur.
    const double input_move = walk.step * random.normal() - 0.2 * input;
    const double output_move = walk.step * random.normal() - 0.2 * output;
    input += input_move;
    output += output_move;
    fast.trial(input_move, output_move, kDt);
    fast.commit();
    slow.move(input_move, output_move, kDt);
    for (int e = 0; e < kElements; ++e)
      worst = std::max(worst, std::fabs(fast.tension(e) - slow.tension(e)));
  }
  EXPECT_LT(worst, 1.0e-6) << "N, " << walk.name;
}

INSTANTIATE_TEST_SUITE_P(Walks, TendonWalk,
                         ::testing::Values(Walk{"small steps", 0.0, 0.0, 1.0e-6}, Walk{"large steps", 0.0, 0.0, 3.0e-5},
                                           Walk{"drag", 40.0, 40.0, 1.0e-5}, Walk{"uneven drag", 0.5, 30.0, 1.0e-5},
                                           Walk{"drag with slack elements", 300.0, 200.0, 3.0e-5}));

TEST(Tendon, TensionIsNeverNegativeAndASlackTendonCarriesNothing) {
  Tendon tendon(chain(16), 1.0e-4);
  Random random(5);
  double total = 1.0e-4;
  int slack_steps = 0;
  for (int i = 0; i < 5000; ++i) {
    const double move = 5.0e-5 * random.normal() - 0.1 * (total - 2.0e-5);
    const TendonEnds ends = tendon.trial(0.0, move, kDt);
    tendon.commit();
    total += move;
    ASSERT_NEAR(tendon.elongation(), total, 1.0e-12);
    for (int e = 0; e < 16; ++e)
      ASSERT_GE(tendon.tension(e), 0.0);
    if (total > 0.0)
      continue;
    ++slack_steps;
    ASSERT_EQ(ends.input_n, 0.0);
    ASSERT_EQ(ends.output_n, 0.0);
  }
  EXPECT_GT(slack_steps, 500);
}

TEST(Tendon, TakingUpSlackBuildsTheProfileOfTheEndThatPulls) {
  Tendon tendon(chain(16), -2.0e-4);
  TendonEnds ends = tendon.trial(-3.0e-4, 0.0, kDt);
  EXPECT_NEAR(ends.output_n / ends.input_n, std::exp(-kEta), 1.0e-9);
  ends = tendon.trial(0.0, 3.0e-4, kDt);
  EXPECT_NEAR(ends.input_n / ends.output_n, std::exp(-kEta), 1.0e-9);
}

TEST(Tendon, TangentsAreTheDerivativesOfTheEndTensions) {
  struct Start {
    double elongation, input, output;
  };
  for (const Start& s :
       {Start{4e-4, -2e-5, 1e-5}, Start{4e-4, -4e-4, -2e-4}, Start{4e-4, 3e-5, 5e-5}, Start{-1e-4, -3e-4, 1e-4}}) {
    Tendon tendon(chain(16), s.elongation);
    const double d = 1.0e-12;
    const TendonEnds at = tendon.trial(s.input, s.output, kDt);
    const TendonEnds by_input = tendon.trial(s.input + d, s.output, kDt);
    const TendonEnds by_output = tendon.trial(s.input, s.output + d, kDt);
    EXPECT_NEAR((by_input.input_n - at.input_n) / d, at.input_by_input, 50.0) << s.elongation << " " << s.input;
    EXPECT_NEAR((by_input.output_n - at.output_n) / d, at.output_by_input, 50.0) << s.elongation << " " << s.input;
    EXPECT_NEAR((by_output.input_n - at.input_n) / d, at.input_by_output, 50.0) << s.elongation << " " << s.input;
    EXPECT_NEAR((by_output.output_n - at.output_n) / d, at.output_by_output, 50.0) << s.elongation << " " << s.input;
  }
}

TEST(Tendon, AMinorLoopClosesAndLeavesNoTrace) {
  Tendon with(chain(16), 3.0e-4);
  Tendon without(chain(16), 3.0e-4);
  for (Tendon* t : {&with, &without})
    pull(*t, 1.0e-4, 50);
  pull(with, -3.0e-5, 50);
  pull(with, 2.0e-5, 50);
  pull(with, -1.0e-5, 50);
  pull(with, 2.0e-5, 50);
  for (int e = 0; e < 16; ++e)
    EXPECT_NEAR(with.tension(e), without.tension(e), 1.0e-8);
  // Beyond the turning point both go on alike, as if the loop had not been.
  const TendonEnds a = pull(with, 5.0e-5, 20);
  const TendonEnds b = pull(without, 5.0e-5, 20);
  EXPECT_NEAR(a.input_n, b.input_n, 1.0e-8);
  EXPECT_NEAR(a.output_n, b.output_n, 1.0e-8);
}

TEST(Tendon, DragOfAWholeMovingTendonIsThatOfTheClosedForm) {
  // (6.18): T_out = e^{-eta} F + (b L / eta)(e^{-eta} - 1) v; here the far end is let go at the same speed.
  TendonParameters parameters = chain(200);
  parameters.drag_to_input_ns_per_m = 800.0;
  Tendon tendon(parameters, 1.0e-3);
  const double speed = 5.0e-3;
  TendonEnds ends;
  for (int i = 0; i < 4000; ++i) {
    ends = tendon.trial(-speed * kDt, -speed * kDt, kDt);
    tendon.commit();
  }
  const double e = std::exp(-kEta);
  EXPECT_NEAR(ends.output_n, e * ends.input_n + (800.0 / kEta) * (e - 1.0) * speed, 2.0e-2);
}

TEST(Tendon, HardeningBendsTheTensionByTheSquareOfTheForce) {
  TendonParameters parameters = chain(16);
  parameters.hardening_per_n = 0.02;
  const Tendon tendon(parameters, 4.0e-4);
  const double linear = kStiffness * 4.0e-4;
  EXPECT_NEAR(tendon.tension(7), linear * (1.0 + 0.02 * linear), 1.0e-9);
}

TEST(Tendon, CreepRelaxesTheTensionOfAHeldTendonToItsShare) {
  TendonParameters parameters = chain(16);
  parameters.creep_ratio = 0.25;
  parameters.creep_time_s = 1.0;
  Tendon tendon(parameters, 4.0e-4);
  const double start = tendon.tension(3);
  for (int i = 0; i < 20000; ++i) {
    tendon.creep(1.0e-3);
    tendon.trial(0.0, 0.0, 1.0e-3);
    tendon.commit();
  }
  // Elastic and creep share the elongation as 1 to 0.25.
  EXPECT_NEAR(tendon.tension(3), start / 1.25, 1.0e-3 * start);
}

TEST(Tendon, FindsTheEquilibriumOfLongChainsWithoutSweeping) {
  Tendon tendon(chain(128), 2.0e-4);
  Random random(3);
  double total = 2.0e-4;
  for (int i = 0; i < 2000; ++i) {
    const double input = 4.0e-5 * random.normal();
    const double output = input + 2.0e-5 * random.normal() - 0.1 * (total - 1.0e-4);
    tendon.trial(input, output, kDt);
    tendon.commit();
    total += output - input;
  }
  EXPECT_EQ(tendon.sweeps(), 0U);
}

}  // namespace
}  // namespace capstan::sim
