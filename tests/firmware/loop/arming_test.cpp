// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

TEST(Arming, WhileDrivesDoNotFollowTheJointsAreBeingArmedAndNoRequestIsTakenAndForgotten) {
  test::Bench<1> bench;
  const Request move{
      .kind = Request::Kind::kMove, .position_rad = Q24::from_double(0.5), .speed_rad_s = Q24::from_int(2)};
  bench.io.cycles_to_follow = 50;
  ASSERT_TRUE(bench.application.post({.kind = Request::Kind::kArm}));
  bench.ticks(1);
  ASSERT_TRUE(bench.application.post(move));
  bench.ticks(31);
  EXPECT_EQ(bench.state(), State::kArmed);
  EXPECT_TRUE(bench.io.has_torque()) << "or the drive would never be enabled";
  bench.ticks(30);
  EXPECT_EQ(bench.state(), State::kHolding);
  bench.ticks(500);
  EXPECT_EQ(bench.state(), State::kHolding) << "nothing moves by what was said before";
  ASSERT_TRUE(bench.application.post(move));
  bench.ticks(1);
  EXPECT_EQ(bench.state(), State::kMoving);
}

}  // namespace
}  // namespace capstan
