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

}  // namespace
}  // namespace capstan::tools
