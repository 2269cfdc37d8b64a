// SPDX-License-Identifier: Apache-2.0
// Who commands an application beside its operator: a link that may be lost, and streams.
#include <gtest/gtest.h>

#include "capstan/tests/firmware/loop/application_rig.hpp"

namespace capstan {
namespace {

using test::FakeIo;
using Rig = test::ApplicationRig;

TEST(Application, ALostLinkTakesTorqueAwayWithinOneCycleInTheMiddleOfAMove) {
  Rig rig;
  rig.arm();
  rig.move(1.5);
  rig.ticks(100);
  ASSERT_EQ(rig.state(), State::kMoving);
  rig.application.link_lost();
  rig.ticks(1);
  EXPECT_EQ(rig.state(), State::kDisarmed);
  EXPECT_FALSE(rig.io.has_torque());
}

TEST(Application, ALostLinkOverrulesAnArmingThatIsUnderWay) {
  Rig rig;
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kArm}));
  rig.application.link_lost();
  rig.ticks(10);
  EXPECT_EQ(rig.state(), State::kDisarmed);
  EXPECT_FALSE(rig.io.has_torque());
}

TEST(Application, ALostLinkDoesNotAcknowledgeAFault) {
  Rig rig;
  rig.arm();
  rig.touch_estop();
  ASSERT_EQ(rig.fault(), Fault::kEmergencyStop);
  rig.application.link_lost();
  rig.ticks(10);
  EXPECT_EQ(rig.state(), State::kFaulted);
  EXPECT_EQ(rig.fault(), Fault::kEmergencyStop);
}

TEST(Application, AFaultInTheCycleOfALostLinkIsLatched) {
  Rig rig;
  rig.arm();
  rig.io.encoder = Quality::kMissing;
  rig.application.link_lost();
  rig.ticks(1);
  rig.io.encoder = Quality::kOk;
  EXPECT_EQ(rig.state(), State::kFaulted);
  EXPECT_EQ(rig.fault(), Fault::kSensorMissing);
  EXPECT_FALSE(rig.io.has_torque());
}

TEST(Application, RestTakesTorqueAwayButLeavesAFaultForTheOperator) {
  Rig rig;
  rig.arm();
  rig.request({.kind = Request::Kind::kRest});
  EXPECT_EQ(rig.state(), State::kDisarmed);
  rig.arm();
  rig.touch_estop();
  rig.request({.kind = Request::Kind::kRest});
  rig.ticks(10);
  EXPECT_EQ(rig.fault(), Fault::kEmergencyStop);
  rig.request({.kind = Request::Kind::kDisarm});
  EXPECT_EQ(rig.state(), State::kDisarmed);
}

TEST(Application, AStreamedReferenceMovesTheJointAndAnOperatorsStopOverrulesIt) {
  Rig rig;
  rig.arm();
  Application<FakeIo<1>>::Streamed streamed{};
  for (int i = 0; i < 500; ++i) {
    streamed[0] = {.kind = Request::Kind::kFollow, .position_rad = Q24::from_double(0.001 * i)};
    rig.application.rt_tick(streamed);
  }
  EXPECT_EQ(rig.state(), State::kMoving);
  EXPECT_NEAR(rig.io.motors[0].angle_rad, 0.5, 0.02);
  rig.request({.kind = Request::Kind::kStop});
  rig.ticks(300);
  EXPECT_EQ(rig.state(), State::kHolding);
}

TEST(Application, AnOperatorsHoldEndsAStreamUntilItsSenderPauses) {
  Rig rig;
  rig.arm();
  double reference = 0.0;
  const auto stream = [&](int cycles) {
    for (int i = 0; i < cycles; ++i) {
      reference += 0.0005;
      rig.application.rt_tick({{{.kind = Request::Kind::kFollow, .position_rad = Q24::from_double(reference)}}});
    }
  };
  const auto wanted = [&] { return rig.application.axis_telemetry(0).q2_reference_rad.to_double(); };
  stream(500);
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kStop}));
  stream(300);
  EXPECT_EQ(rig.state(), State::kHolding);
  const double held = wanted();
  EXPECT_NEAR(held, 0.25, 0.05);
  stream(200);
  EXPECT_EQ(wanted(), held);
  rig.ticks(99);
  stream(10);
  EXPECT_EQ(wanted(), held) << "not silent for long enough";
  rig.ticks(100);
  reference = held;
  stream(100);
  EXPECT_NEAR(wanted(), reference, 0.01);
  EXPECT_EQ(rig.state(), State::kMoving);
}

TEST(Application, AnOperatorsMoveEndsAStreamToo) {
  Rig rig;
  rig.arm();
  for (int i = 0; i < 1500; ++i) {
    if (i == 100) {
      ASSERT_TRUE(rig.application.post(
          {.kind = Request::Kind::kMove, .position_rad = Q24::from_double(-0.3), .speed_rad_s = Q24::from_int(1)}));
    }
    rig.application.rt_tick({{{.kind = Request::Kind::kFollow, .position_rad = Q24::from_double(0.2)}}});
  }
  EXPECT_EQ(rig.state(), State::kHolding);
  EXPECT_NEAR(rig.application.axis_telemetry(0).q2_reference_rad.to_double(), -0.3, 1e-3);
}

/// Follows 1.5 rad in every cycle, from before there is torque.
struct StreamedRig : Rig {
  void stream(int cycles, double position_rad = 1.5) {
    for (int i = 0; i < cycles; ++i) {
      application.rt_tick({{{.kind = Request::Kind::kFollow, .position_rad = Q24::from_double(position_rad)}}});
    }
  }
};

TEST(Application, AStreamThatRanBeforeTheArmingMovesNothingUntilItsSenderPauses) {
  StreamedRig rig;
  rig.stream(200);
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kArm}));
  rig.stream(2000);
  EXPECT_EQ(rig.state(), State::kHolding);
  EXPECT_NEAR(rig.io.motors[0].angle_rad, 0.0, 0.01) << "arming holds the joint where it is";
  rig.ticks(100);
  rig.stream(3000);
  EXPECT_NEAR(rig.io.motors[0].angle_rad, 1.5, 0.1) << "a stream that begins anew is meant";
}

TEST(Application, AStreamOfFewFramesASecondIsNotTakenForOneThatBegins) {
  StreamedRig rig;
  const auto slowly = [&rig](int frames) {
    for (int i = 0; i < frames; ++i) {
      rig.stream(1);
      rig.ticks(90);
    }
  };
  slowly(3);
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kArm}));
  slowly(20);
  EXPECT_EQ(rig.state(), State::kHolding);
  EXPECT_NEAR(rig.io.motors[0].angle_rad, 0.0, 0.01);
}

TEST(Application, AStreamThatGoesOnThroughAFaultMovesNothingWhenTheJointIsArmedAgain) {
  StreamedRig rig;
  rig.arm();
  rig.stream(500, 0.2);
  ASSERT_NEAR(rig.io.motors[0].angle_rad, 0.2, 0.05);
  rig.io.estop = true;
  rig.stream(1, 0.2);
  rig.io.estop = false;
  rig.stream(20, -1.5);
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kDisarm}));
  rig.stream(1, -1.5);
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kArm}));
  rig.stream(500, -1.5);
  EXPECT_EQ(rig.state(), State::kHolding);
  EXPECT_NEAR(rig.io.motors[0].angle_rad, 0.2, 0.1);
}

TEST(Application, AStreamUnderAnExperimentDoesNotTakeTheJointAtItsEnd) {
  StreamedRig rig;
  rig.arm();
  const ExperimentSetup setup{
      .recipe = Recipe::kSpeedLadder, .amplitude = Q24::from_double(0.1), .rungs = {Q24::from_int(1)}, .rung_count = 1};
  ASSERT_EQ(rig.application.begin_experiment(setup), nullptr);
  rig.ticks(2);
  rig.stream(20'000);
  EXPECT_EQ(rig.application.telemetry().experiment, ExperimentPhase::kDone);
  EXPECT_EQ(rig.state(), State::kHolding);
  EXPECT_NEAR(rig.io.motors[0].angle_rad, 0.0, 0.2);
}

TEST(Application, WhatTakesTorqueAwayNeedsNoRoomAndOutranksWhatLiesThere) {
  for (const Request::Kind off : {Request::Kind::kDisarm, Request::Kind::kRest}) {
    Rig rig;
    ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kArm}));
    EXPECT_TRUE(rig.application.post({.kind = off}));
    EXPECT_FALSE(rig.application.requests_taken());
    rig.ticks(3);
    EXPECT_TRUE(rig.application.requests_taken());
    EXPECT_EQ(rig.state(), State::kDisarmed);
    EXPECT_FALSE(rig.io.has_torque());
    rig.arm();
    EXPECT_TRUE(rig.io.has_torque()) << "it is carried out once";
  }
}

TEST(Application, ARestDoesNotWeakenTheDisarmOfItsCycle) {
  Rig rig;
  rig.arm();
  rig.touch_estop();
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kDisarm}));
  ASSERT_TRUE(rig.application.post({.kind = Request::Kind::kRest}));
  rig.ticks(1);
  EXPECT_EQ(rig.state(), State::kDisarmed);
}

}  // namespace
}  // namespace capstan
