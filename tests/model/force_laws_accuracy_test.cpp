// SPDX-License-Identifier: Apache-2.0
// The force laws in fixed point beside themselves in double, a million random samples each.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>

#include "capstan/model/preisach.hpp"
#include "capstan/model/pull_push.hpp"
#include "capstan/model/tension_state.hpp"
#include "capstan/tests/model/relays.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;

constexpr int kSamples = 1'000'000;

/// Parameters anywhere in their ranges, rounded to fixed point.
auto any_parameters(std::mt19937& engine) -> PullPushParameters<Q24> {
  const auto up_to = [&engine](double high) {
    return number<Q24>(std::uniform_real_distribution<double>(0.0, high)(engine));
  };
  return {up_to(3.0), up_to(3.0), up_to(8.0), up_to(4.0) + number<Q24>(0.01), up_to(2.0), up_to(2.0)};
}
auto in_double(const PullPushParameters<Q24>& p) -> PullPushParameters<double> {
  return {p.eta_top.to_double(), p.eta_bottom.to_double(),  p.pretension_nm.to_double(),
          p.ratio.to_double(),   p.pull_weight.to_double(), p.pull_push_weight.to_double()};
}

TEST(PullPushAccuracy, FixedIsWithinAThousandthOfFullScale) {
  std::mt19937 engine(21);
  std::uniform_real_distribution<double> torque(-8.0, 8.0);
  std::uniform_real_distribution<double> small(-0.5, 0.5);
  double worst = 0.0;
  double worst_share = 0.0;
  int phase_differs = 0;
  for (int round = 0; round < kSamples / 1000; ++round) {
    auto parameters = any_parameters(engine);
    parameters.ratio = std::min(parameters.ratio, Q24::from_int(4));
    ASSERT_EQ(check(parameters), PullPushFault::kNone);
    PullPush<double> exact(in_double(parameters));
    PullPush<Q24> fixed(parameters);
    double full_scale = 0.0;
    double round_worst = 0.0;
    double tau = 0.0;
    for (int i = 0; i < 1000; ++i) {
      // Wide jumps and short walks, so that the output is often held between the lines.
      tau = i % 10 == 0 ? torque(engine) : std::clamp(tau + small(engine), -8.0, 8.0);
      const Q24 input = number<Q24>(tau);
      const auto expected = exact.update(input.to_double(), true);
      const auto estimate = fixed.update(input, true);
      ASSERT_FALSE(estimate.saturated);
      phase_differs += estimate.phase != expected.phase ? 1 : 0;
      round_worst = std::fmax(round_worst, std::fabs(estimate.force.to_double() - expected.force));
      full_scale = std::fmax(full_scale, std::fabs(expected.force));
    }
    worst = std::fmax(worst, round_worst);
    worst_share = std::fmax(worst_share, round_worst / full_scale);
  }
  std::printf("law pull_push | torque 8 N m, eta 3, I r1 8 N m, ratio 4 | %.1e N m, %.1e of full scale\n", worst,
              worst_share);
  EXPECT_LT(worst_share, 1e-3);
  std::printf("pull-push: phase differs in %d of %d samples\n", phase_differs, kSamples);
  EXPECT_LT(phase_differs, kSamples / 1000);
}

TEST(PreisachInverseAccuracy, InputInFixedPointBringsTheForceAboutInDouble) {
  const auto table = test::Relays(200).table<41>(41);
  const auto fixed_table = convert_table<Q24>(table);
  const double low = table.force(0, 0);
  const double span = table.force(40, 40) - low;
  Preisach<double, 41> exact(table, StartState::kNegativeSaturation, 1e-12);
  Preisach<Q24, 41> fixed(fixed_table, StartState::kNegativeSaturation, number<Q24>(1e-6));
  const test::RandomMultisine slow(22, 0.45, 0.5, 20.0);
  std::mt19937 engine(23);
  std::uniform_real_distribution<double> noise(-0.05, 0.05);
  double worst = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const Q24 wanted = number<Q24>(low + span * (0.5 + slow(0.001 * i) + noise(engine)));
    const auto command = fixed.input_for(wanted);
    ASSERT_TRUE(command.reachable);
    fixed.update(command.input);
    worst = std::fmax(worst, std::fabs(exact.update(command.input.to_double()).force - wanted.to_double()));
  }
  std::printf("law preisach_41_inverse | between the saturations | %.1e of full scale\n", worst / span);
  EXPECT_LT(worst, 1e-3 * span);
}

auto in_double(const TensionStateParameters<Q24>& p) -> TensionStateParameters<double> {
  return {p.eta_top.to_double(),        p.eta_bottom.to_double(),        p.pretension_nm.to_double(),
          p.compliance_top.to_double(), p.compliance_bottom.to_double(), p.beta.to_double(),
          p.joint_offset.to_double(),   p.friction_nm.to_double()};
}

// Torque up to what an instrument bears: elongations up to 4 rad of the motor, any parameters.
TEST(TensionStateAccuracy, FixedIsWithinItsPromiseOfDouble) {
  std::mt19937 engine(25);
  double worst_angle = 0.0;
  double worst_torque = 0.0;
  for (int round = 0; round < kSamples / 5000; ++round) {
    const auto between = [&engine](double low, double high) {
      return number<Q24>(std::uniform_real_distribution<double>(low, high)(engine));
    };
    const double compliance = std::exp(std::uniform_real_distribution<double>(-3.0, 1.7)(engine));
    const double largest = std::fmin(8.0, 4.0 / compliance);
    const TensionStateParameters<Q24> parameters = {between(0.0, 3.0),
                                                    between(0.0, 3.0),
                                                    between(0.02, 1.0) * number<Q24>(largest),
                                                    number<Q24>(compliance),
                                                    between(0.7 * compliance, compliance),
                                                    between(0.25, 2.0),
                                                    between(-3.0, 3.0),
                                                    between(0.0, 0.02)};
    ASSERT_EQ(check(parameters), TensionStateFault::kNone);
    TensionState<double> exact(in_double(parameters));
    TensionState<Q24> fixed(parameters);
    const test::RandomMultisine torque(static_cast<std::uint32_t>(round), 2.0 * largest, 0.1, 5.0);
    const test::RandomMultisine angle(static_cast<std::uint32_t>(round) + 1000, 10.0, 0.1, 3.0);
    double full_scale = 0.0;
    double round_worst = 0.0;
    for (int i = 0; i < 5000; ++i) {
      const Q24 tau = number<Q24>(std::clamp(torque(0.001 * i), -largest, largest));
      const Q24 q1 = number<Q24>(angle(0.001 * i));
      const bool forward = (i / 700) % 2 == 0;
      const auto expected = exact.update(q1.to_double(), tau.to_double(), forward);
      const auto estimate = fixed.update(q1, tau, forward);
      ASSERT_FALSE(estimate.saturated);
      worst_angle = std::fmax(worst_angle, std::fabs(estimate.q2.to_double() - expected.q2));
      round_worst = std::fmax(round_worst, std::fabs(estimate.joint_torque.to_double() - expected.joint_torque));
      full_scale = std::fmax(full_scale, std::fabs(expected.joint_torque));
    }
    worst_torque = std::fmax(worst_torque, round_worst / full_scale);
  }
  std::printf("law tension_state | elongation 4 rad, torque 8 N m, q1 10 rad | %.1e rad, %.1e of full scale\n",
              worst_angle, worst_torque);
  EXPECT_LT(worst_angle, 2e-5);
  EXPECT_LT(worst_torque, 1e-3);
}

}  // namespace
}  // namespace capstan
