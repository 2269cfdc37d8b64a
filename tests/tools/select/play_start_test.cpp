// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/play_start.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "capstan/tests/tools/select/small_selection.hpp"

namespace capstan::tools {
namespace {

using test::play_of;
using test::SmallSelection;

/// A cycle of a motor, and a joint behind two plays of 0.7 and 0.2 rad, which begin at a share of those.
struct OneCycle {
  Eigen::VectorXd q1, q2;
  explicit OneCycle(double start, double sign = 1.0, double phase = 0.3, double curve = 0.0)
      : q1(Eigen::ArrayXd::LinSpaced(400, 0.0, 2.0 * std::numbers::pi)), q2(q1.size()) {
    q1 = (q1.array() + phase).sin().matrix();
    const Eigen::VectorXd h = 0.5 * play_of(q1, 0.7, start) + 0.3 * play_of(q1, 0.2, start);
    q2 = sign * (h + curve * h.cwiseAbs2()) + Eigen::VectorXd::Constant(q1.size(), 0.04);
  }
};

TEST(PlayStart, IsWhereTheJointSaysThatItBegan) {
  for (const double start : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    for (const double sign : {1.0, -1.0}) {
      const OneCycle cycle(start, sign);
      EXPECT_EQ(start_of_plays(cycle.q1, cycle.q2), start) << sign;
      EXPECT_EQ(start_of_plays(1e3 * cycle.q1, 1e-3 * cycle.q2), start) << "in other units";
    }
  }
}

// A curve of the ratio bends the branches as a start does, but all of them. One of 0.3 for 0.12 hides some starts.
TEST(PlayStart, IsFoundBehindACurvedRatioAtAnyPhase) {
  for (const double start : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    for (const double phase : {0.0, 0.8, 2.0, 4.0}) {
      const OneCycle cycle(start, 1.0, phase, 0.12);
      EXPECT_EQ(start_of_plays(cycle.q1, cycle.q2), start) << phase;
    }
  }
}

TEST(PlayStart, IsTheMiddleWhereNothingSpeaksForAnother) {
  const OneCycle cycle(1.0);
  EXPECT_EQ(start_of_plays(cycle.q1, 0.5 * cycle.q1), 0.0) << "a joint without play";
  EXPECT_EQ(start_of_plays(Eigen::VectorXd::Constant(50, 0.2), Eigen::VectorXd::LinSpaced(50, 0.0, 1.0)), 0.0)
      << "a motor that stands";
}

TEST(PlayStart, ItsLeadEndsWhereThePlaysMeet) {
  Samples samples(5);
  const double q1[] = {0.0, 0.3, 0.8, 1.5, 0.2};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].q1 = q1[i];
  }
  // Half a gap of 1: from the middle the play stands at 0 0 0 0.5 0.5, from the upper end at 1 1 1 1 1.
  EXPECT_EQ(lead_of_play(samples, 1.0, 1.0), (Eigen::VectorXd(5) << 1.0, 1.0, 1.0, 0.5, 0.5).finished());
  // From the lower end at -1 -0.7 -0.2 0.5 0.5: they meet at the fourth.
  EXPECT_LT((lead_of_play(samples, 1.0, -1.0) - (Eigen::VectorXd(5) << -1.0, -0.7, -0.2, 0.0, 0.0).finished()).norm(),
            1e-15);
  EXPECT_EQ(lead_of_play(samples, 1.0, 0.0), Eigen::VectorXd::Zero(5));
}

TEST(PlayStart, OfALogWithHardlyACycleIsThatOfItsPlays) {
  const OneCycle cycle(1.0);
  SmallSelection small(cycle.q1, cycle.q2);
  // All rows take part, and the plays that made the joint explain all of them.
  EXPECT_EQ(rows_in(small.data.settled()), small.data.rows());
  const Eigen::VectorXd wide = cycle.q1 + small.data.columns({"play", {0.7}}, nullptr).col(0);
  const Eigen::VectorXd narrow = cycle.q1 + small.data.columns({"play", {0.2}}, nullptr).col(0);
  EXPECT_LT((cycle.q2 - 0.5 * wide - 0.3 * narrow - Eigen::VectorXd::Constant(400, 0.04)).norm(), 1e-12);
}

TEST(PlayStart, OfALogOfTwoStrokesEachWayIsNotAsked) {
  const OneCycle cycle(1.0);
  Eigen::VectorXd q1(800), q2(800);
  q1 << cycle.q1, cycle.q1;
  q2 << cycle.q2, cycle.q2;
  DecidingNumbers numbers = test::few_parts();
  numbers.settling = {};
  SmallSelection small(q1, q2, numbers);
  EXPECT_LT(rows_in(small.data.settled()), small.data.rows());
  EXPECT_EQ(small.data.columns({"play", {0.7}}, nullptr)(0, 0), 0.0) << "in the middle of the gap";
}

}  // namespace
}  // namespace capstan::tools
