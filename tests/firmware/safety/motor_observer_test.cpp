// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/motor_observer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/firmware/parameters/parameters.hpp"
#include "capstan/tests/firmware/safety/motor_observer_rig.hpp"

namespace capstan {
namespace {

using observer_rig::commissioned_config;
using observer_rig::Rig;

TEST(MotorObserver, ASteadyMotionAndANoisyCurrentAreNoFault) {
  Rig rig;
  rig.run_at(10);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(rig.step(10 + i % 2, 0.05, 0.05 + 0.006 * (i % 3 - 1)), 0U);
  }
}

TEST(MotorObserver, AnEncoderThatStopsAtSpeedIsFrozenInThatVeryCycle) {
  Rig rig;
  rig.run_at(10);
  EXPECT_EQ(rig.step(0, 0.05), bit(Fault::kEncoderFrozen));
}

TEST(MotorObserver, HalfOfTheSpeedAndTheOtherSignAreAMotionThatNoTorqueMade) {
  Rig half;
  half.run_at(12);
  EXPECT_EQ(half.step(6, 0.05), bit(Fault::kEncoderMotion));
  Rig reversed;
  reversed.run_at(12);
  EXPECT_EQ(reversed.step(-12, 0.05), bit(Fault::kEncoderMotion));
}

// 4 counts a cycle are 0.6 rad/s, and 2 fewer are within what one cycle is quantised by.
TEST(MotorObserver, HalfOfASlowSpeedShowsInTwoCyclesThoughTheServoPushes) {
  for (const bool forward : {true, false}) {
    const int way = forward ? 1 : -1;
    Rig rig;
    for (int v = 0; v <= 4; ++v) {
      static_cast<void>(rig.step(v * way, 0.05 * way));
    }
    ASSERT_EQ(rig.steps(200, 4 * way, 0.05 * way), 0U);
    EXPECT_EQ(rig.step(2 * way, 0.05 * way), 0U) << "one cycle alone is not enough";
    EXPECT_EQ(rig.step(2 * way, 0.07 * way), bit(Fault::kEncoderMotion));
  }
}

TEST(MotorObserver, WhatAMotorLosesWithItsTorqueOverTwoCyclesIsNoFault) {
  Rig rig;
  rig.run_at(6);
  // 25 mA less in each cycle are 0.8 counts a cycle and cycle.
  EXPECT_EQ(rig.step(6, 0.025), 0U);
  EXPECT_EQ(rig.step(5, 0.0), 0U);
  EXPECT_EQ(rig.step(4, -0.025), 0U);
  EXPECT_EQ(rig.step(2, -0.05), 0U);
}

// A tremor pulls the motor on and lets it go.
TEST(MotorObserver, WhatALoadGaveTheMotorOfLateItMayTakeAgain) {
  for (const int meanwhile : {0, 300}) {
    Rig rig;
    rig.run_at(2);
    for (const int moved : {3, 5, 7, 7}) {
      ASSERT_EQ(rig.step(moved, 0.05), 0U);
    }
    ASSERT_EQ(rig.steps(meanwhile, 7, 0.05), 0U);
    FaultSet faults = 0;
    for (const int moved : {5, 3, 2, 2}) {
      faults |= rig.step(moved, 0.05);
    }
    EXPECT_EQ(faults, meanwhile == 0 ? 0U : bit(Fault::kEncoderMotion));
  }
}

TEST(MotorObserver, ATipThatHitsSomethingIsSlowedByAPartOfItsSpeedAndHalfByHalf) {
  Rig hits;
  hits.run_at(13);
  FaultSet faults = 0;
  for (const int moved : {13, 12, 11, 10, 10, 9, 9}) {
    faults |= hits.step(moved, 0.05);
  }
  EXPECT_EQ(faults, 0U);
  Rig half;
  half.run_at(12);
  EXPECT_NE(half.steps(2, 6, 0.05), 0U);
}

TEST(MotorObserver, WhatTheTorqueExplainsIsNoFault) {
  Rig rig;
  rig.run_at(10);
  // Each 50 mA less are 5 mNm: 250 rad/s2, 1.6 counts less in every cycle from then on.
  EXPECT_EQ(rig.step(10, 0.0), 0U);
  EXPECT_EQ(rig.step(8, -0.05), 0U);
  EXPECT_EQ(rig.step(5, -0.10), 0U);
}

TEST(MotorObserver, ABlowThatSpeedsTheMotorUpIsNoFault) {
  Rig rig;
  rig.run_at(4);
  EXPECT_EQ(rig.step(14, 0.05), 0U);
  for (const int way : {10, -10}) {
    Rig at_rest;
    EXPECT_EQ(at_rest.steps(100, 0, 0.0) | at_rest.step(way, 0.0), 0U) << way;
  }
}

TEST(MotorObserver, AJumpBeyond32BitsIsNotTakenForTheCountThatItsLowBitsAre) {
  for (const std::int64_t jump : {(std::int64_t{1} << 32) + 1, -(std::int64_t{1} << 32) - 1}) {
    Rig rig;
    rig.counts += jump;
    EXPECT_EQ(rig.step(0, 0.0), 0U) << "a motor at rest that is moved";
    EXPECT_EQ(rig.step(0, 0.0), bit(Fault::kEncoderFrozen)) << "and can not stop in a cycle";
  }
}

TEST(MotorObserver, TorqueBeyondWhatFrictionHoldsHasToBeAnsweredByACount) {
  Rig rig;
  FaultSet faults = 0;
  double wanted = 0.0;
  for (int i = 0; i < 100 && faults == 0; ++i) {
    wanted += 0.01;
    faults = rig.step(0, wanted);
  }
  EXPECT_EQ(faults, bit(Fault::kEncoderFrozen));
  EXPECT_GT(wanted, 0.06) << "the motor's own friction, both ways";
  EXPECT_LT(wanted, 0.16);
}

TEST(MotorObserver, WithACountNowAndThenTorqueMayRise) {
  Rig rig;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(rig.step(i % 4 == 0 ? 1 : 0, 0.01 * i), 0U) << i;
  }
}

// 0.39 A against it are too much at speed; a load that goes away lets a motor creep on, however far its torque has
// gone.
TEST(MotorObserver, CountsGoOnAgainstTheTorqueAtACreepOnly) {
  for (const int speed : {1, 5}) {
    Rig rig;
    ASSERT_EQ(rig.step(-1, 1.2), 0U);
    FaultSet faults = 0;
    for (int i = 1; i <= 1000; ++i) {
      faults |= rig.step(i < 100 ? 1 : std::min(speed, 1 + (i - 100) / 100), 1.2 - 0.001 * i);
    }
    EXPECT_EQ(faults, speed == 1 ? 0U : bit(Fault::kEncoderMotion));
  }
}

TEST(MotorObserver, AnEncoderThatGoesBackWhileTorqueRisesCountsTheWrongWay) {
  Rig rig;
  static_cast<void>(rig.step(1, 0.0));
  FaultSet faults = 0;
  for (int i = 0; i < 40 && faults == 0; ++i) {
    faults = rig.step(-1, 0.01 * i);
  }
  EXPECT_EQ(faults, bit(Fault::kEncoderMotion));
}

// Of 2 A, beside a noise of 3 mA, of which 15 mA pass.
TEST(MotorObserver, ACurrentMayBeOffByTheSharesThatTheAmplifierIs) {
  const auto stops_at = [](Q24 gain_error) {
    AxisConfig config = commissioned_config();
    config.observer.gain_error = gain_error;
    config.observer.coulomb_nm = Q24::from_double(1.0);  // so that no torque is missed by the encoder
    for (int percent = 0; percent < 60; ++percent) {
      Rig rig(config);
      FaultSet faults = 0;
      for (int i = 0; i < 4000; ++i) {
        faults |= rig.step(0, 2.0, 2.0 + 0.02 * percent);
      }
      if (faults != 0) {
        EXPECT_EQ(faults, bit(Fault::kCurrentMismatch));
        return percent;
      }
    }
    return 100;
  };
  EXPECT_EQ(stops_at(Q24::from_double(1.0 / 64.0)), 3) << "1/64 and 15 mA are 2.3 %";
  EXPECT_EQ(stops_at(Q24{}), 8) << "not known: a sixteenth and 15 mA are 7 %";
  EXPECT_EQ(stops_at(Q24::from_double(0.2)), 21);
}

TEST(MotorObserver, ACurrentThatNobodyWantedIsAMismatchInTheFirstCycle) {
  Rig rig;
  EXPECT_EQ(rig.step(0, 0.1, 1.5), bit(Fault::kCurrentMismatch));
  Rig small;
  FaultSet faults = 0;
  int cycles = 0;
  for (; cycles < 100 && faults == 0; ++cycles) {
    faults = small.step(0, 0.05, 0.05 + 0.03);
  }
  EXPECT_EQ(faults, bit(Fault::kCurrentMismatch)) << "30 mA are ten times the noise";
  EXPECT_GT(cycles, 1);
}

TEST(MotorObserver, ALagOfTheAmplifierBetweenTwoWishesIsNone) {
  Rig rig;
  for (int i = 0; i < 100; ++i) {
    const double before = 0.05 * ((i + 3) % 4 / 2);
    const double now = 0.05 * (i % 4 / 2);
    EXPECT_EQ(rig.step(i % 2, now, 0.5 * (before + now)), 0U);
  }
}

/// A motor without load whose encoder is reversed, under a servo's torque that the reversed count makes rise: 0.02 g m2
/// and 0.1 Nm/A are 5 rad/s more a cycle and A, and 40,960 counts a turn 32.6 counts a cycle.
TEST(MotorObserver, ACountThatGainsSpeedAgainstItsTorqueIsFoundBeforeTheMotorIsFast) {
  Rig rig;
  double speed = 0.5;  // counts a cycle
  double shown = 0.0;
  double torque = 0.0;
  FaultSet faults = 0;
  for (int i = 0; i < 60 && faults == 0; ++i) {
    torque += 0.02;
    speed += 32.6 * std::max(0.0, torque - 0.06);  // what friction leaves
    const double before = shown;
    shown -= speed;
    faults = rig.step(static_cast<int>(std::floor(shown) - std::floor(before)), torque);
  }
  EXPECT_EQ(faults, bit(Fault::kEncoderMotion));
  EXPECT_LT(speed / 6.52, 2.0 * 2.0) << "rad/s: twice limits.joint_speed";
}

// By two counts a cycle, which are 8 of limits.joint_speed's 13 within four.
TEST(MotorObserver, ALoadMayBringTheMotorSlowlyToTwoAndAHalfTimesItsSpeedAgainstItsTorque) {
  Rig rig;
  for (int i = 0; i <= 50; ++i) {
    ASSERT_EQ(rig.step(1, 0.01 * i), 0U) << i;
  }
  ASSERT_EQ(rig.step(1, 0.3), 0U) << "0.2 A against it";
  const double fast = 40960.0 / 6283.19 * commissioned_config().limits.joint_speed_rad_s.to_double();
  int moved = 1;
  while (moved + 2 - 1 <= 2.5 * fast) {
    moved += 2;
    ASSERT_EQ(rig.step(moved, 0.3), 0U) << moved;
  }
  EXPECT_EQ(rig.step(moved + 2, 0.3), bit(Fault::kEncoderMotion));
}

TEST(MotorObserver, AHandThatPushesTheMotorOnWhileItsServoGivesWayIsNoFault) {
  Rig rig;
  for (int i = 0; i < 40; ++i) {  // 1 rad/s in 40 ms, and half of what stops any motion
    EXPECT_EQ(rig.step(1 + i * 6 / 40, -0.003 * i), 0U) << i;
  }
}

TEST(MotorObserver, AMotorThatSpringsBackWhenTorqueComesMaySlowDownForFiftyCycles) {
  for (const bool later : {false, true}) {
    MotorObserver observer(commissioned_config());
    MotorState motor;
    const auto step = [&](int moved, bool energised) {
      motor.counts += moved;
      return observer.rt_step(motor, Q24{}, energised);
    };
    for (int i = 0; i < 5; ++i) {
      static_cast<void>(step(45, false));
    }
    observer.rt_arm();
    FaultSet faults = 0;
    for (int i = 0; i < (later ? 60 : 10); ++i) {
      faults |= step(45, true);
    }
    EXPECT_EQ(faults, 0U);
    faults = step(30, true) | step(15, true);
    EXPECT_EQ(faults, later ? bit(Fault::kEncoderMotion) : 0U);
  }
}

TEST(MotorObserver, WhatATorqueOfJustNowHasStretchedStillExplainsAMotionWhenTorqueIsBack) {
  MotorObserver observer(commissioned_config());
  MotorState motor;
  const auto step = [&](int moved, double drive_a, bool energised) {
    motor.counts += moved;
    motor.current_a = Q24::from_double(drive_a);
    return observer.rt_step(motor, Q24::from_double(drive_a), energised);
  };
  for (int i = 0; i <= 100; ++i) {
    static_cast<void>(step(0, 0.01 * i, false));
  }
  static_cast<void>(step(0, 0.0, false));
  observer.rt_arm();  // at rest
  static_cast<void>(step(0, 0.0, true));
  static_cast<void>(step(8, 0.0, true));
  EXPECT_EQ(step(-7, 0.0, true), 0U) << "15 counts in a cycle are 0.46 A, and 1 A went away";
}

TEST(MotorObserver, WithoutCommissionedValuesItSaysNothingAndLimitsNothing) {
  Rig rig{AxisConfig{}};
  EXPECT_EQ(rig.step(0, 0.1, 1.5), 0U);
  EXPECT_EQ(rig.step(50, 0.1), 0U);
  EXPECT_EQ(rig.step(0, 3.0), 0U);
  EXPECT_EQ(rig.observer.rt_look(), Q24{});
  EXPECT_EQ(MotorObserver::slew_limit(AxisConfig{}), Q24::max());
  AxisConfig no_torque = commissioned_config();
  no_torque.motor.torque_per_current_nm_per_a = Q24{};
  Rig unknown(no_torque);
  EXPECT_EQ(unknown.step(0, 0.1, 1.5) | unknown.step(50, 0.1) | unknown.step(0, 3.0), 0U);
}

TEST(MotorObserver, TwoCyclesAtTheSlewLimitGiveLessThanHalfOfTheSpeedLimit) {
  const AxisConfig config = commissioned_config();
  const double step_nm = MotorObserver::slew_limit(config).to_double() * 0.1;
  const double acceleration = step_nm / 2e-5;  // after one cycle, twice that after two
  const double speed = acceleration * 1e-3 + 2 * acceleration * 1e-3;
  EXPECT_LE(speed, 0.5 * config.limits.joint_speed_rad_s.to_double());
}

TEST(MotorObserver, TheSlewKeepsTenCyclesWithinTheTravelOfAFault) {
  AxisConfig config = commissioned_config();
  config.limits.fault_travel_rad = Q24::from_double(0.01);
  const double ramp_nm = MotorObserver::slew_limit(config).to_double() * 0.1;  // in each cycle
  const double travel = ramp_nm / 2e-5 * 10 * 10 * 10 / 6 * 1e-6;
  EXPECT_LE(travel, 0.01);
  EXPECT_GT(travel, 0.009) << "and no less than it has to be";
}

TEST(MotorObserver, ImpossibleValuesAreRefusedWithTheCure) {
  AxisConfig config = commissioned_config();
  EXPECT_EQ(check(config), nullptr);
  EXPECT_EQ(check(AxisConfig{}), nullptr);
  config.observer.coulomb_nm = Q24{};
  ASSERT_NE(check(config), nullptr);
  EXPECT_NE(std::string(check(config)).find("observer.coulomb"), std::string::npos);
  config = commissioned_config();
  config.observer.noise_a = Q24{};
  EXPECT_NE(check(config), nullptr);
  config = commissioned_config();
  config.observer.against_nm = Q24{};
  EXPECT_NE(check(config), nullptr);
  for (Q24 ObserverConfig::*value : {&ObserverConfig::inertia_gm2, &ObserverConfig::coulomb_nm,
                                     &ObserverConfig::against_nm, &ObserverConfig::noise_a}) {
    config = commissioned_config();
    config.observer.*value = Q24::from_double(-0.02);
    ASSERT_NE(check(config), nullptr);
    EXPECT_NE(std::string(check(config)).find("negative"), std::string::npos);
  }
}

TEST(MotorObserver, ExtremeValuesSaturate) {
  for (const double inertia : {1e-6, 100.0}) {
    AxisConfig config = commissioned_config();
    config.observer.inertia_gm2 = Q24::from_double(inertia);
    config.motor.torque_per_current_nm_per_a = Q24::from_raw(1);
    config.motor.encoder_counts_per_turn = 1 << 24;
    Rig rig(config);
    static_cast<void>(rig.step(1 << 30, 127.0, -127.0));
    static_cast<void>(rig.step(-(1 << 30), -127.0, 127.0));
    EXPECT_GT(MotorObserver::slew_limit(config), Q24{});
  }
}

/// As large a gain as a set may lead to; the sanitizers see what overflows.
TEST(MotorObserver, TheLargestGainOfASoundSetSaturates) {
  AxisConfig config;
  config.motor.encoder_counts_per_turn = 1 << 24;
  config.motor.torque_per_current_nm_per_a = Q24::from_int(100);
  config.observer.inertia_gm2 = Q24::from_raw(1);
  config.observer.coulomb_nm = config.observer.against_nm = config.observer.noise_a = Q24::from_double(0.01);
  ASSERT_EQ(check(config), nullptr);
  Rig rig(config);
  EXPECT_EQ(rig.steps(100, 1000, 0.0), 0U) << "no torque explains nothing, however large the gain";
}

}  // namespace
}  // namespace capstan
