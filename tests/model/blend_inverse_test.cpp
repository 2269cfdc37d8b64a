// SPDX-License-Identifier: Apache-2.0
// The blend (2.27) turned round, against its own way there in small steps: the motor torque that is told brings the
// output there, and none nearer does.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "capstan/model/pull_push.hpp"
#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::value_of;

template <typename Scalar>
class BlendInverse : public testing::Test {};
using Scalars = testing::Types<double, Q24>;
TYPED_TEST_SUITE(BlendInverse, Scalars);

/// Coarse steps from `now` on until the output is there, and the last of them again in fine ones.
template <typename Scalar>
auto stepped_to(const PullPush<Scalar>& from, double wanted, double now, double step) -> double {
  const auto output_after = [&](double torque) {
    PullPush<Scalar> law = from;
    return value_of(law.update(number<Scalar>(torque), true).force);
  };
  const double sign = wanted > output_after(now) ? 1.0 : -1.0;
  const auto there = [&](double torque) { return sign * (output_after(torque) - wanted) >= 0.0; };
  double torque = now;
  while (!there(torque) && std::fabs(torque) < 20.0) {
    torque += sign * step;
  }
  torque -= sign * step;
  for (double fine = step / 2.0; fine > 1e-9; fine /= 2.0) {
    torque += there(torque + sign * fine) ? 0.0 : sign * fine;
  }
  return torque;
}

TYPED_TEST(BlendInverse, IsTheNearestTorqueThatBringsTheOutputThere) {
  std::mt19937 random(2027);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  double worst = 0.0;
  for (int joint = 0; joint < 40; ++joint) {
    // The weights of one law alone among them, whose way round is another.
    const double pull = joint % 5 == 0 ? 0.0 : between(0.1, 1.5);
    const double pull_push = joint % 5 == 1 ? 0.0 : between(0.1, 1.5);
    PullPush<TypeParam> law({number<TypeParam>(between(0.05, 1.8)), number<TypeParam>(between(0.05, 1.8)),
                             number<TypeParam>(between(0.0, 0.1)), number<TypeParam>(between(0.5, 1.5)),
                             number<TypeParam>(pull), number<TypeParam>(pull_push)});
    for (int turn = 0; turn < 25; ++turn) {
      const double now = value_of(number<TypeParam>(between(-0.25, 0.25)));
      static_cast<void>(law.update(number<TypeParam>(now), true));
      const double wanted = value_of(number<TypeParam>(between(-0.15, 0.15)));
      const double told = value_of(law.input_for(number<TypeParam>(wanted), number<TypeParam>(now)));
      const double expected = stepped_to(law, wanted, now, 0.01);
      PullPush<TypeParam> there = law;
      const double reached = value_of(there.update(number<TypeParam>(told), true).force);
      ASSERT_NEAR(reached, wanted, 2e-6) << joint << ", " << turn << ": from " << now;
      // Torques are as far apart as the flattest line makes of what fixed point rounds.
      ASSERT_NEAR(told, expected, 1e-4) << joint << ", " << turn;
      worst = std::fmax(worst, std::fabs(reached - wanted));
    }
  }
  std::printf("blend turned round: within %.1e N m\n", worst);
}

TYPED_TEST(BlendInverse, WantedWhereTheOutputIsLeavesTheMotorAlone) {
  PullPush<TypeParam> law({number<TypeParam>(1.1414), number<TypeParam>(1.1404), number<TypeParam>(0.072),
                           number<TypeParam>(0.92), number<TypeParam>(0.5904), number<TypeParam>(0.4686)});
  static_cast<void>(law.update(number<TypeParam>(0.12), true));
  const TypeParam held = law.update(number<TypeParam>(0.1), true).force;
  EXPECT_EQ(law.input_for(held, number<TypeParam>(0.1)), number<TypeParam>(0.1));
}

}  // namespace
}  // namespace capstan
