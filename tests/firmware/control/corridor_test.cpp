// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/control/corridor.hpp"

#include <gtest/gtest.h>

namespace capstan {
namespace {

auto q(double x) -> Q24 {
  return Q24::from_double(x);
}

struct Laid : Corridor {
  Laid() { rt_lay(q(0.5), q(0.1)); }
};

TEST(Corridor, MeetsAStandingJointAtHalfItsWidthToEitherSide) {
  Laid corridor;
  EXPECT_FALSE(corridor.rt_met(q(0.59), Q24{}, q(10.0)));
  EXPECT_FALSE(corridor.rt_met(q(0.41), Q24{}, q(10.0)));
  EXPECT_FALSE(corridor.holds());
  EXPECT_TRUE(corridor.rt_met(q(0.601), Q24{}, q(10.0)));
  EXPECT_TRUE(corridor.holds());
  EXPECT_TRUE(corridor.rt_met(q(0.399), Q24{}, q(10.0)));
}

// v^2 / (2 a): 1 rad/s needs 0.05 rad at 10 rad/s2, 2 rad/s 0.2 rad.
TEST(Corridor, MeetsAMovingJointWhereItCanJustStopInside) {
  Laid corridor;
  EXPECT_FALSE(corridor.rt_met(q(0.549), q(1.0), q(10.0)));
  EXPECT_TRUE(corridor.rt_met(q(0.551), q(1.0), q(10.0)));
  EXPECT_TRUE(corridor.rt_met(q(0.501), q(2.0), q(10.0)));
  EXPECT_FALSE(corridor.rt_met(q(0.551), q(-1.0), q(10.0))) << "on its way back";
  EXPECT_TRUE(corridor.rt_met(q(0.449), q(-1.0), q(10.0)));
}

// 11 rad/s and 60 rad/s2: v^2 = 121 would be at the numbers' end, and 20 beyond it.
TEST(Corridor, KeepsToItsWayAtSpeedsWhoseSquareHasNoPlaceInTheNumbers) {
  Corridor corridor;
  corridor.rt_lay(Q24{}, q(3.0));
  EXPECT_FALSE(corridor.rt_met(q(1.9), q(11.0), q(60.0)));  // 1.008 rad to stop
  EXPECT_TRUE(corridor.rt_met(q(2.0), q(11.0), q(60.0)));
  EXPECT_TRUE(corridor.rt_met(q(0.1), q(20.0), q(60.0)));  // 3.33 rad
}

TEST(Corridor, EdgeLetsGoOfAJointThatPressesOutwardMoreThanWanted) {
  Laid corridor;
  ASSERT_TRUE(corridor.rt_met(q(0.6), Q24{}, q(10.0)));
  EXPECT_FALSE(corridor.pressed_back(q(0.052), q(0.05), q(0.005)));
  EXPECT_TRUE(corridor.pressed_back(q(0.056), q(0.05), q(0.005)));
  EXPECT_TRUE(corridor.pressed_back(q(0.0), q(-0.05), q(0.005))) << "the other way is wanted now";
  ASSERT_TRUE(corridor.rt_met(q(0.4), Q24{}, q(10.0)));
  EXPECT_FALSE(corridor.pressed_back(q(0.056), q(0.05), q(0.005)));
  EXPECT_TRUE(corridor.pressed_back(q(-0.056), q(-0.05), q(0.005)));
}

TEST(Corridor, DoesNotHoldAgainWhereItJustLetGoAndDoesAfterTheJointWasInside) {
  Laid corridor;
  ASSERT_TRUE(corridor.rt_met(q(0.6), Q24{}, q(10.0)));
  corridor.rt_let_go(q(0.6));
  EXPECT_FALSE(corridor.rt_met(q(0.602), Q24{}, q(10.0)));
  EXPECT_TRUE(corridor.rt_met(q(0.604), Q24{}, q(10.0))) << "a thirty-second of 0.1 further is the end";
  corridor.rt_let_go(q(0.6));
  EXPECT_FALSE(corridor.rt_met(q(0.59), Q24{}, q(10.0)));
  EXPECT_TRUE(corridor.rt_met(q(0.601), Q24{}, q(10.0)));
}

TEST(Corridor, NoneNeverHolds) {
  Corridor corridor;
  EXPECT_FALSE(corridor.rt_met(q(20.0), q(30.0), q(10.0)));
  Laid laid;
  laid.rt_lift();
  EXPECT_FALSE(laid.rt_met(q(20.0), q(30.0), q(10.0)));
  EXPECT_FALSE(laid.holds());
}

TEST(Corridor, KeepsItsMiddleWhenItIsResizedAndLetsGoWhenItWidens) {
  Laid corridor;
  ASSERT_TRUE(corridor.rt_met(q(0.6), Q24{}, q(10.0)));
  corridor.rt_resize(q(0.08));
  EXPECT_TRUE(corridor.holds());
  corridor.rt_resize(q(0.2));
  EXPECT_FALSE(corridor.holds());
  EXPECT_FALSE(corridor.rt_met(q(0.69), Q24{}, q(10.0)));
  EXPECT_TRUE(corridor.rt_met(q(0.31), q(-1.0), q(10.0)));
}

}  // namespace
}  // namespace capstan
