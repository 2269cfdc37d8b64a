// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/look_answer.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "capstan/tests/firmware/safety/motor_observer_rig.hpp"

namespace capstan {
namespace {

constexpr std::int32_t kOneA = 1 << 24;
// 0.24 A of torque, 0.04 A of which friction takes.
constexpr std::int32_t kMostA = kOneA / 100 * 24;
constexpr std::int32_t kDeadA = kOneA / 100 * 4;

/// A look that moves the motor to `there` and lets it go to `back`. @param least  counts for each A
auto answered(LookAnswer& look, int there, int back, int least, bool judged = true) -> bool {
  look.rt_begin(0, judged);
  bool small = false;
  int place = 0;
  for (int i = 1; i <= LookAnswer::kCycles; ++i) {
    const int next = i <= 8 ? there * i / 8 : there + (back - there) * std::min(i - 8, 8) / 8;
    small |= look.rt_step(next - place, kMostA / 6 * std::max(0, 6 - std::abs(6 - i)), kDeadA, 256 * least);
    place = next;
  }
  return small;
}

TEST(LookAnswer, IsTheWayBetweenTheFurthestPlacesForTheTorqueBeyondFrictions) {
  LookAnswer look;
  EXPECT_FALSE(answered(look, 16, -2, 0));
  EXPECT_EQ(look.counts(), 18);
  EXPECT_NEAR(look.beyond_a().to_double(), 0.2, 1e-3);
  EXPECT_FALSE(answered(look, -12, 0, 0));
  EXPECT_EQ(look.counts(), 12);
  EXPECT_EQ(look.number(), 2U);
}

TEST(LookAnswer, ThreeInARowAreTooSmallAndTwoAreNot) {
  LookAnswer look;
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(answered(look, 14, 0, 65)) << "13 for 0.2 A are enough";
  }
  EXPECT_FALSE(answered(look, 12, 0, 65));
  EXPECT_FALSE(answered(look, 12, 0, 65));
  EXPECT_FALSE(answered(look, 20, 0, 65)) << "not in a row";
  EXPECT_FALSE(answered(look, 12, 0, 65));
  EXPECT_FALSE(answered(look, 12, 0, 65));
  EXPECT_TRUE(answered(look, 12, 0, 65));
}

TEST(LookAnswer, UnderALoadWithoutACommissionedValueAndWithoutTorqueNothingIsTooSmall) {
  LookAnswer look;
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(answered(look, 5, 0, 65, false));
  }
  EXPECT_EQ(look.number(), 0U);
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(answered(look, 5, 0, 0));
    look.rt_begin(0, true);
    for (int k = 0; k < LookAnswer::kCycles; ++k) {
      EXPECT_FALSE(look.rt_step(0, kDeadA, kDeadA, 256 * 65)) << "friction took it all";
    }
  }
}

TEST(LookAnswer, ALookThatBeginsWithinAnotherIsPartOfIt) {
  LookAnswer look;
  look.rt_begin(0, true);
  for (int i = 0; i < LookAnswer::kCycles; ++i) {
    EXPECT_EQ(look.number(), 0U);
    look.rt_begin(0, true);
    static_cast<void>(look.rt_step(1, kMostA, kDeadA, 0));
  }
  EXPECT_EQ(look.number(), 1U);
  EXPECT_EQ(look.counts(), LookAnswer::kCycles);
}

/// A motor that stands at `load_a` and answers each look of an armed observer by `counts`; the faults. @param tuned
/// gains were changed since the answer was found
auto looked_at(int counts, double load_a, bool tuned = false) -> FaultSet {
  AxisConfig config = observer_rig::commissioned_config();
  // 20 counts for 0.105 A, which is what 0.195 A leave beyond 11/16 of the 0.13 A that may be dead
  config.observer.answer_rad_per_a = Q24::from_double(20.0 * 6.283185 / config.motor.encoder_counts_per_turn / 0.105);
  config.observer.answer_gains = LookAnswer::mark(config.control);
  if (tuned) {
    config.control.damping_nms_per_rad = config.control.damping_nms_per_rad * Q24::from_double(1.5);
  }
  MotorObserver observer(config);
  MotorState motor;
  static_cast<void>(observer.rt_step(motor, Q24{}, false));
  observer.rt_arm();
  const Q24 load = Q24::from_double(load_a);
  Q24 drive = load;
  FaultSet faults = 0;
  int since = 0;
  for (int i = 0; i < 500; ++i) {
    motor.current_a = drive;
    faults |= observer.rt_step(motor, drive, true);
    const Q24 look = observer.rt_look();
    since = look == Q24{} ? 0 : since + 1;
    motor.counts = -counts * std::max(0, 6 - std::abs(6 - since)) / 6;
    drive = load + look;
  }
  return faults;
}

TEST(LookAnswer, TheObserverJudgesItAtRestWithoutALoad) {
  EXPECT_EQ(looked_at(20, 0.0) & bit(Fault::kEncoderMotion), 0U);
  EXPECT_EQ(looked_at(15, 0.0) & bit(Fault::kEncoderMotion), 0U);
  EXPECT_NE(looked_at(11, 0.0) & bit(Fault::kEncoderMotion), 0U);
  EXPECT_EQ(looked_at(11, 0.08) & bit(Fault::kEncoderMotion), 0U) << "half of what may be dead are 65 mA";
}

// A stiffer servo lets a look move the motor less: a healthy joint was stopped so after it was tuned.
TEST(LookAnswer, IsNotJudgedWithOtherGainsThanItWasFoundWith) {
  EXPECT_EQ(looked_at(11, 0.0, true) & bit(Fault::kEncoderMotion), 0U);
  const ControlConfig usual;
  for (Q24 ControlConfig::*gain :
       {&ControlConfig::kp, &ControlConfig::ki_per_s, &ControlConfig::kd_s, &ControlConfig::stiffness_nm_per_rad,
        &ControlConfig::damping_nms_per_rad, &ControlConfig::rate_time_constant_s}) {
    ControlConfig other = usual;
    other.*gain = other.*gain + Q24::from_raw(1);
    EXPECT_NE(LookAnswer::mark(other), LookAnswer::mark(usual));
  }
}

}  // namespace
}  // namespace capstan
