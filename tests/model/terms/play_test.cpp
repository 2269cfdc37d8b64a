// SPDX-License-Identifier: Apache-2.0
#include "capstan/model/terms/play.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <vector>

#include "capstan/tests/model/support.hpp"

namespace capstan {
namespace {

using test::number;
using test::one_khz;
using test::value_of;

template <typename Scalar>
auto sample_at(double q1, bool forward = true) -> Sample<Scalar> {
  return {.q1 = number<Scalar>(q1), .forward = forward};
}

/// The play operator without recursion: after n samples the joint stands at the highest of the lower walls q_j - w that
/// no later upper wall q_k + w has pushed down again, or at the start if no wall has touched it. O(n^2), and no state.
auto play_by_walls(const std::vector<double>& q, double w) -> double {
  const std::size_t n = q.size();
  double ceiling = q[n - 1] + w;
  double highest = -1e300;
  for (std::size_t back = 0; back < n; ++back) {
    const std::size_t j = n - 1 - back;
    ceiling = std::min(ceiling, q[j] + w);
    highest = std::max(highest, std::min(q[j] - w, ceiling));
  }
  return std::max(highest, std::min(q[0], ceiling));
}

RC_GTEST_PROP(Play, AgreesWithTheTwoWallsForAnyMotion, ()) {
  const auto steps = *rc::gen::container<std::vector<std::int32_t>>(rc::gen::inRange(-4000, 4000));
  const double w = 1e-4 * *rc::gen::inRange(5, 5000);
  Play<double> play(one_khz<double>(), {w});
  Play<Q24> fixed(one_khz<Q24>(), {number<Q24>(w)});
  std::vector<double> q = {0.3};
  for (std::size_t i = 0;; ++i) {
    const double position = play.update(sample_at<double>(q.back()))[0] + q.back();
    RC_ASSERT(std::fabs(position - play_by_walls(q, w)) < 1e-12);
    // Rounding of q and of w, half a unit each, and no accumulation however many samples there were.
    RC_ASSERT(std::fabs(fixed.update(sample_at<Q24>(q.back()))[0].to_double() + q.back() - position) <
              2.01 * test::kLsb);
    if (i == steps.size()) {
      break;
    }
    q.push_back(q.back() + 1e-4 * steps[i]);
  }
}

TEST(Play, RestsWhileTheMotorCrossesTheGap) {
  constexpr double kHalf = 0.02;
  Play<double> play(one_khz<double>(), {kHalf});
  for (double q = 0.0; q < 1.0; q += 0.001) {
    play.update(sample_at<double>(q));
  }
  const double top = 1.0;
  const double resting = play.update(sample_at<double>(top))[0] + top;
  EXPECT_NEAR(resting, top - kHalf, 1e-12);
  EXPECT_NEAR(play.update(sample_at<double>(top - 1.99 * kHalf))[0] + top - 1.99 * kHalf, resting, 1e-12);
  EXPECT_NEAR(play.update(sample_at<double>(top - 3.0 * kHalf))[0] + top - 3.0 * kHalf, resting - kHalf, 1e-12);
}

TEST(Play, SettledIsWhereALongMotionOfThatDirectionEnds) {
  for (const double direction : {1.0, -1.0}) {
    Play<Q24> play(one_khz<Q24>(), {number<Q24>(0.05)});
    Q24 last;
    for (int i = 0; i < 1000; ++i) {
      last = play.update(sample_at<Q24>(direction * 0.001 * i))[0];
    }
    EXPECT_EQ(last, play.steady_state(sample_at<Q24>(0.0, direction > 0.0))[0]);
  }
}

TEST(Play, StartsInTheMiddleOfTheGapWhereverTheMotorIs) {
  Play<Q24> play(one_khz<Q24>(), {number<Q24>(0.1)});
  EXPECT_EQ(play.update(sample_at<Q24>(-17.0))[0], Q24{});
}

}  // namespace
}  // namespace capstan
