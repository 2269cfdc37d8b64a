// SPDX-License-Identifier: Apache-2.0
// Looks: what the observer gives a motor at rest to answer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/tests/firmware/safety/motor_observer_rig.hpp"

namespace capstan {
namespace {

using observer_rig::commissioned_config;
using observer_rig::Rig;

/// Torque comes, and the motor goes on by a count in each cycle of its first look.
/// @return the look's largest torque, A
auto answers_the_first_look(Rig& rig) -> double {
  rig.observer.rt_arm();
  double largest = 0.0;
  for (int i = 0; i < 12; ++i) {
    const double look = rig.observer.rt_look().to_double();
    largest = std::max(largest, std::abs(look));
    EXPECT_EQ(rig.step(look > 0.0 ? 1 : 0, look), 0U) << i;
  }
  return largest;
}

// 0.195 A, a look's torque here, explain 6.4 counts, and 3.5 are the quantisation's.
TEST(MotorObserver, WhatALookHasStretchedExplainsAMotionUntilItHasFaded) {
  for (const int since : {12, 60}) {
    Rig rig;
    ASSERT_NEAR(answers_the_first_look(rig), 0.195, 0.01);
    FaultSet faults = rig.steps(since, 2, 0.0);
    for (const int moved : {5, 8, 10, 10, 1}) {
      faults |= rig.step(moved, 0.0);
    }
    EXPECT_EQ(faults, since == 12 ? 0U : bit(Fault::kEncoderMotion));
  }
}

TEST(MotorObserver, LooksOnceAfterArmingAndOnceWhenAMotionStops) {
  Rig rig;
  const double largest = answers_the_first_look(rig);
  EXPECT_GT(largest, 2.0 * 0.03) << "more than the friction holds, both ways";
  EXPECT_LT(largest, 0.3) << "far less than a joint needs to move";
  EXPECT_EQ(rig.observer.rt_look(), Q24{});
  rig.run_at(3);
  int looked = 0;
  Q24 look;
  for (int i = 0; i < 200 && (looked == 0 || look != Q24{}); ++i) {
    static_cast<void>(rig.step(looked == 3 ? -1 : 0, 0.05));
    look = rig.observer.rt_look();
    looked += look != Q24{} ? 1 : 0;
    EXPECT_LE(look, Q24{}) << "against the motion only";
  }
  EXPECT_EQ(looked, 11);
}

/// A look whose torque follows at 12 mA a cycle, which 0.15 A take 13 cycles.
/// @param answers  cycles of the look after which a count comes
auto follows_slowly(int answers) -> FaultSet {
  Rig rig;
  EXPECT_EQ(rig.steps(30, 1, 0.3), 0U);
  double torque_a = 0.3;
  double look_a = 0.0;
  int cycles = 0;
  FaultSet faults = 0;
  for (int i = 0; i < 100 && faults == 0 && (cycles == 0 || look_a != 0.0); ++i) {
    torque_a += std::clamp(0.3 + look_a - torque_a, -0.012, 0.012);
    faults = rig.step(cycles == answers ? -1 : 0, torque_a);
    look_a = rig.observer.rt_look().to_double();
    cycles += look_a != 0.0 ? 1 : 0;
  }
  return faults;
}

// RAVEN's elbow, whose slew limit lets a look take 0.7 A away in its own time, and 1.6 A tell a dead encoder.
TEST(MotorObserver, ALookWhoseTorqueComesLateGoesOnUntilACountAnswers) {
  EXPECT_EQ(follows_slowly(10), 0U);
  EXPECT_EQ(follows_slowly(1000), bit(Fault::kEncoderFrozen));
}

TEST(MotorObserver, AMotorThatWasSlowIsLookedAtWithinFiftyCyclesAllTheSame) {
  Rig rig;
  ASSERT_EQ(rig.step(1, 0.05), 0U);
  while (rig.steps(1, 0, 0.05) == 0U && rig.observer.rt_look() == Q24{}) {
  }
  ASSERT_EQ(rig.step(-1, 0.05), 0U);
  ASSERT_EQ(rig.steps(40, 0, 0.05), 0U);
  while (rig.observer.rt_look() != Q24{}) {
  }
  ASSERT_EQ(rig.step(1, 0.05), 0U);
  int silent = 1;
  for (; silent < 200 && rig.observer.rt_look() == Q24{}; ++silent) {
    ASSERT_EQ(rig.step(0, 0.05), 0U);
  }
  EXPECT_LE(silent, 52);
}

TEST(MotorObserver, AMotorThatFallsSilentDuringALookIsNotLookedAtASecondTime) {
  Rig rig;
  rig.observer.rt_arm();
  int looked = 0;
  Q24 look;
  for (int i = 0; i < 100; ++i) {
    static_cast<void>(rig.step(i == 2 || i == 3 ? -1 : 0, look.to_double()));  // silent from the ninth cycle on
    look = rig.observer.rt_look();
    looked += look != Q24{} ? 1 : 0;
    EXPECT_TRUE(look == Q24{} || i < 12) << i;
  }
  EXPECT_EQ(looked, 11);
}

/// Stands at a torque until a look comes, and through it.
/// @param answers  cycles of the look's torque after which a count comes, and six later one back; 0: never
/// @return cycles of the look's torque after which a fault came; 0: none
auto stands_through_a_look(Rig& rig, double wanted_a, int answers) -> int {
  int cycles = 0;
  double look_a = 0.0;
  for (int i = 0; i < 60 && cycles < 11; ++i) {
    cycles += look_a != 0.0 ? 1 : 0;
    const int with_look = cycles == answers ? 1 : cycles == answers + 6 ? -1 : 0;
    const int moved = look_a == 0.0 || answers == 0 ? 0 : look_a > 0.0 ? with_look : -with_look;
    if (rig.step(moved, wanted_a + look_a) != 0) {
      return cycles;
    }
    look_a = rig.observer.rt_look().to_double();
  }
  EXPECT_EQ(cycles, 11) << "there was no look";
  return 0;
}

// 0.13 A have to be answered, a look's fourth cycle takes 0.13 A away and its fifth 0.16 A. The last count came at 0.06
// A, with which the motor swung back from the look before.
TEST(MotorObserver, ALookIsJudgedFromTheTorqueThatIsLeftOfTheSwingOfTheLastOne) {
  for (const int answers : {5, 0}) {
    Rig rig;
    static_cast<void>(answers_the_first_look(rig));
    for (const double swing_a : {0.0, 0.03, 0.06}) {
      ASSERT_EQ(rig.step(-1, swing_a), 0U);
    }
    EXPECT_EQ(stands_through_a_look(rig, 0.005, answers), answers == 0 ? 5 : 0);
  }
}

TEST(MotorObserver, TorqueThatWentOnABitBeforeALookIsAllowedAndADeadEncoderFoundInTheSameCycle) {
  for (const double since_a : {0.0, 0.012}) {
    for (const int answers : {5, 0}) {
      Rig rig;
      ASSERT_EQ(rig.steps(30, 1, 0.05), 0U);
      EXPECT_EQ(stands_through_a_look(rig, 0.05 - since_a, answers), answers == 0 ? 5 : 0) << since_a;
    }
  }
}

// Joint 590002 of the drawn ones stood in its tendons' friction while its torque went on; its look took that torque
// back and was answered after four cycles, as 451009's and elbow 4103's were. An encoder that answers none is found
// in it.
TEST(MotorObserver, WhatTorqueWentOnByWithoutACountIsNotAddedUpWhileALookTakesItBack) {
  for (const bool answers : {true, false}) {
    Rig rig;
    ASSERT_EQ(rig.steps(30, 1, 0.3), 0U);
    FaultSet faults = 0;
    double look_a = 0.0;
    int cycles = 0;
    int looked = 0;
    for (; cycles < 30 && looked <= (answers ? 11 : 30) && faults == 0; ++cycles) {
      looked += look_a != 0.0 || looked > 0 ? 1 : 0;
      const int moved = !answers ? 0 : looked == 5 ? -1 : looked == 11 ? 1 : 0;
      faults = rig.step(moved, 0.3 + std::min(0.033 * cycles, 0.12) + look_a);
      look_a = rig.observer.rt_look().to_double();
    }
    EXPECT_GT(looked, answers ? 11 : 0);
    EXPECT_EQ(faults, answers ? 0U : bit(Fault::kEncoderFrozen));
    EXPECT_LE(cycles, 25);
  }
}

// A motor that springs back answers with more than the look's torque.
TEST(MotorObserver, ALookIsJudgedByItsAnswerWhereTheMotorStoodWhenTorqueCame) {
  for (const bool stood : {true, false}) {
    MotorObserver observer(commissioned_config());
    MotorState motor;
    const auto step = [&](int moved, Q24 drive_a, bool energised) {
      motor.counts += moved;
      motor.current_a = drive_a;
      return observer.rt_step(motor, drive_a, energised);
    };
    for (int i = 0; i < 5; ++i) {
      static_cast<void>(step(stood ? 0 : 1, Q24{}, false));
    }
    observer.rt_arm();
    static_cast<void>(step(0, Q24{}, true));
    for (int i = 0; i < 40; ++i) {
      static_cast<void>(step(i == 4 || i == 6 ? 6 : i == 8 ? -6 : 0, observer.rt_look(), true));
    }
    EXPECT_EQ(observer.look_answer().number(), stood ? 1U : 0U);
    EXPECT_EQ(observer.look_answer().counts(), stood ? 12 : 0);
  }
}

// A look that adds torque breaks a joint loose that is about to move; the last count's direction is chance.
TEST(MotorObserver, ALookTakesTorqueAwayWhicheverWayTheLastCountWent) {
  for (const double torque : {0.5, -0.5}) {
    for (const int flicker : {1, -1}) {
      Rig rig;
      for (int i = 0; i < 50; ++i) {  // within the slew
        static_cast<void>(rig.step(i % 5 == 0 ? (torque > 0.0 ? 1 : -1) : 0, torque * i / 50));
      }
      static_cast<void>(rig.step(flicker, torque));
      double most = 0.0;
      for (int i = 0; i < 100; ++i) {
        static_cast<void>(rig.step(0, torque));
        const double look = rig.observer.rt_look().to_double() * (torque > 0.0 ? 1.0 : -1.0);
        EXPECT_LE(look, 0.0) << torque << ' ' << flicker;
        most = std::max(most, -look);
      }
      EXPECT_GT(most, 0.06) << "and there was one";
    }
  }
}

// A load pulled it back while its torque rose by 0.35 A of the 0.39 A that counts may go on against; then it stood.
TEST(MotorObserver, WhatTheEncoderConfirmedBeforeASilenceWasUnderAnotherLoad) {
  for (const bool stood : {true, false}) {
    Rig rig;
    for (int i = 0; i <= 70; ++i) {
      ASSERT_EQ(rig.step(-1, -0.005 * i), 0U) << i;
    }
    for (int i = 0; i <= 70; ++i) {
      ASSERT_EQ(rig.step(-1, -0.35 + 0.005 * i), 0U) << i;
    }
    for (int i = 0; i < 60 && stood; ++i) {
      ASSERT_EQ(rig.step(0, 0.0), 0U);
      static_cast<void>(rig.observer.rt_look());
    }
    EXPECT_EQ(rig.step(-4, 0.03) | rig.step(-4, 0.06), stood ? 0U : bit(Fault::kEncoderMotion));
  }
}

}  // namespace
}  // namespace capstan
