// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "capstan/tests/firmware/loop/allocation_watch.hpp"
#include "capstan/tests/hal/cia402_sim/can_rig.hpp"

namespace capstan {
namespace {

/// Allocations of the firmware's side only; the simulated drives allocate as they like.
auto allocations_of(test::CanRig& rig, int cycles) -> long {
  long sum = 0;
  for (int i = 0; i < cycles; ++i) {
    rig.cycle([] {},
              [&sum](const std::function<void()>& tick) {
                const test::Watch watch;
                tick();
                sum += watch.count();
              });
  }
  return sum;
}

TEST(CanNoAllocation, NotWhenDisarmedArmedMovingOrFaulted) {
  test::CanRig rig({"0.5:double-status:1", "0.5:short-emergency:2"});
  EXPECT_EQ(allocations_of(rig, 50), 0);
  rig.application().post({.kind = Request::Kind::kArm});
  EXPECT_EQ(allocations_of(rig, 100), 0);
  ASSERT_EQ(rig.state(), State::kHolding);
  rig.application().post({.kind = Request::Kind::kMove,
                          .axis = 0,
                          .position_rad = Q24::from_double(0.3),
                          .speed_rad_s = Q24::from_int(1)});
  EXPECT_EQ(allocations_of(rig, 600), 0);
  EXPECT_EQ(rig.state(), State::kFaulted);
  EXPECT_GT(rig.count(cia402::Anomaly::kStatusContradicts), 0U);
  EXPECT_GT(rig.count(cia402::Anomaly::kEmergencyLength), 0U);
}

TEST(CanNoAllocation, NotWhenTheBusIsGone) {
  test::CanRig rig;
  rig.arm();
  rig.hang_up();
  long sum = 0;
  for (int i = 0; i < 10; ++i) {
    ++test::time_ms;
    const test::Watch watch;
    rig.application().rt_tick();
    sum += watch.count();
  }
  EXPECT_EQ(sum, 0);
}

}  // namespace
}  // namespace capstan
