// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/shape_range.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace capstan::tools {
namespace {

/// As many places, all visited alike.
auto places(Eigen::Index count) -> Eigen::VectorXd {
  return Eigen::VectorXd::LinSpaced(count, -1.0, 1.0).replicate(50, 1);
}

TEST(AtManyPlaces, ASweepIsInWhateverUnitAndDirection) {
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(2000, 0.0, 20.0);
  EXPECT_TRUE(at_many_places(t.sin().matrix()));
  EXPECT_TRUE(at_many_places((1e3 + 1e-3 * t.sin()).matrix()));
  EXPECT_TRUE(at_many_places((-t).matrix()));
}

TEST(AtManyPlaces, AFewPlacesAreNotHoweverOftenVisited) {
  EXPECT_FALSE(at_many_places(places(6)));
  EXPECT_FALSE(at_many_places(places(13)));
  EXPECT_TRUE(at_many_places(places(14)));
  EXPECT_FALSE(at_many_places(Eigen::VectorXd::Constant(100, 0.3)));
}

TEST(AtManyPlaces, ShortMovesBetweenLongRestsAreNoSweep) {
  Eigen::VectorXd q1(1200);
  for (Eigen::Index i = 0; i < q1.size(); ++i) {
    const double place = static_cast<double>(i / 200);
    q1(i) = place - 1.0 + std::min(1.0, static_cast<double>(i % 200) / 20.0);
  }
  EXPECT_FALSE(at_many_places(q1));
}

TEST(ShapeRange, OfATimeEndsAtThreeTimesTheLongestLogInItsUnit) {
  const SignalReach reach = reach_of({Samples(4000), Samples(1000)}, {0.01, 0.01});
  EXPECT_DOUBLE_EQ(reach.duration_s, 40.0);
  const ShapeInfo minutes = {"time", "min", 0.05, 120.0, 5.0, "", ShapeScale::kRatio, ShapeOf::kTime};
  EXPECT_DOUBLE_EQ(range_of(minutes, reach).high, 2.0);
  EXPECT_DOUBLE_EQ(range_of(minutes, reach).low, 0.05);
  const ShapeInfo seconds = {"time", "s", 0.1, 60.0, 1.0, "", ShapeScale::kRatio, ShapeOf::kTime};
  EXPECT_DOUBLE_EQ(range_of(seconds, reach).high, 60.0);
  EXPECT_DOUBLE_EQ(range_of(minutes, reach_of({Samples(100)}, {0.01})).high, 120.0) << "no range is left";
}

}  // namespace
}  // namespace capstan::tools
