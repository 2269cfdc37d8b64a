// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/campaign/fault_campaign.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/firmware/loop/application.hpp"
#include "capstan/hal/sim/sim_io.hpp"
#include "capstan/tools/campaign/false_alarms.hpp"
#include "capstan/tools/campaign/hazard.hpp"

namespace capstan::tools {
namespace {

auto hazard_of(const Scene& scene, OneFault fault) -> std::pair<RunResult, Hazard> {
  const RunResult healthy = run_scene(scene, std::nullopt);
  RunResult faulty = run_scene(scene, Trouble{fault});
  const Hazard hazard = hazard_beyond(healthy.course, faulty.course);
  return {std::move(faulty), hazard};
}
auto limits() -> HazardLimits {
  return hazard_limits(setup_of(Joint::kForceps).config);
}

Course course_of(std::initializer_list<double> angles) {
  Course course;
  for (const double angle : angles) {
    sim::Truth truth;
    truth.q2_rad = angle;
    course.add(truth, 0.0);
  }
  return course;
}

TEST(Hazard, AJointThatStopsEarlyWentNowhereBeyondItsTwin) {
  EXPECT_EQ(hazard_beyond(course_of({0.0, 0.1, 0.2, 0.3}), course_of({0.0, 0.1, 0.1, 0.1})).travel_rad, 0.0);
}

TEST(Hazard, AJointAheadOfItsTwinOrBehindItsOnsetIsBeyond) {
  EXPECT_NEAR(hazard_beyond(course_of({0.0, 0.1, 0.2}), course_of({0.0, 0.1, 0.27})).travel_rad, 0.07, 1e-12);
  EXPECT_NEAR(hazard_beyond(course_of({0.0, 0.1, 0.2}), course_of({0.0, -0.04, 0.0})).travel_rad, 0.04, 1e-12);
}

TEST(Hazard, IsUnsafeBeyondAnyOfItsThreeLimits) {
  EXPECT_LE((Hazard{0.05, 3.0, 0.24}.severity(limits())), 1.0 + 1e-6) << "the limits are rounded to 2^-24";
  EXPECT_GT((Hazard{0.051, 0.0, 0.0}.severity(limits())), 1.0);
  EXPECT_GT((Hazard{0.0, 3.01, 0.0}.severity(limits())), 1.0);
  EXPECT_GT((Hazard{0.0, 0.0, 0.241}.severity(limits())), 1.0);
}

TEST(FaultCampaign, TheSameRunTwiceIsTheSameCourse) {
  const Scene scene{Joint::kForceps, Situation::kMoving, 7};
  EXPECT_EQ(run_scene(scene, std::nullopt).course.angle_rad, run_scene(scene, std::nullopt).course.angle_rad);
}

TEST(FaultCampaign, WithoutAFaultNothingIsReportedInAnyPhase) {
  for (const Joint joint : kJoints) {
    for (const Situation situation : kSituations) {
      if (situation != Situation::kFaulted) {
        const CampaignRow row = run_without_fault(joint, situation);
        EXPECT_EQ(row.fault, Fault::kNone) << name(joint) << ' ' << name(situation) << ' ' << info(row.fault).name;
      }
    }
  }
}

TEST(FaultCampaign, AStuckEncoderAtFullSpeedMovesTheJointByLessThanItsLimitInEveryPhase) {
  for (int phase = 0; phase < kPhases; ++phase) {
    const auto [run, hazard] = hazard_of({Joint::kForceps, Situation::kFast, phase}, {Input::kEncoder, Mode::kStuck});
    EXPECT_EQ(run.end, State::kFaulted) << phase;
    EXPECT_LE(hazard.travel_rad, 0.05) << phase;
    EXPECT_LE(run.off_after_cycles, 2) << phase;
  }
}

TEST(FaultCampaign, AWildAmplifierIsOffInTheSecondCycleAndMovesNothing) {
  for (const Mode mode : {Mode::kGarbage, Mode::kWrongSign}) {
    const auto [run, hazard] = hazard_of({Joint::kForceps, Situation::kFast, 4}, {Input::kAmplifier, mode});
    EXPECT_LE(run.detected_ms, 3) << name(mode);
    EXPECT_LE(hazard.severity(limits()), 1.0) << name(mode);
  }
}

TEST(FaultCampaign, ADeadEncoderIsFoundByTheFirstLookBeforeAnythingMoves) {
  const auto [run, hazard] = hazard_of({Joint::kForceps, Situation::kDisarmed, 0}, {Input::kEncoder, Mode::kStuck});
  EXPECT_EQ(run.fault, Fault::kEncoderFrozen);
  EXPECT_LE(run.detected_ms, 101 + 20) << "armed 100 ms after the onset";
  EXPECT_LT(hazard.travel_rad, 0.005);
}

TEST(FaultCampaign, AWrongSignMovesTheForcepsByLessThanItsLimitsInEveryPhase) {
  for (const Situation situation : {Situation::kMoving, Situation::kFast}) {
    for (int phase = 0; phase < kPhases; ++phase) {
      const auto [run, hazard] = hazard_of({Joint::kForceps, situation, phase}, {Input::kEncoder, Mode::kWrongSign});
      EXPECT_EQ(run.end, State::kFaulted) << phase;
      EXPECT_LE(hazard.severity(limits()), 1.0) << name(situation) << ' ' << phase;
    }
  }
}

// Phases 4 to 7 of a move at half of the speed limit are in its middle; in 8 to 10 the joint stands and turns round
// next.
TEST(FaultCampaign, HalfOfTheCountsAreFoundInAMotionAndWhereTheMotorTurnsRoundBeforeTheJointFollows) {
  for (int phase = 4; phase <= 10; ++phase) {
    const auto [run, hazard] = hazard_of({Joint::kForceps, Situation::kMoving, phase}, {Input::kEncoder, Mode::kHalf});
    EXPECT_EQ(run.end, State::kFaulted) << phase;
    EXPECT_EQ(run.fault, Fault::kEncoderMotion) << phase;
    EXPECT_LE(hazard.severity(limits()), 1.0) << phase;
  }
}

TEST(FaultCampaign, ADriftingCountIsFoundWhereItRunsAgainstTheMotionOrTheTorque) {
  for (int phase = 4; phase <= 10; ++phase) {
    const auto [run, hazard] = hazard_of({Joint::kForceps, Situation::kMoving, phase}, {Input::kEncoder, Mode::kDrift});
    EXPECT_EQ(run.end, State::kFaulted) << phase;
    EXPECT_LE(hazard.severity(limits()), 1.0) << phase;
  }
}

// In these phases the motor winds its tendons up before the joint follows, with ever more torque at a steady speed.
TEST(FaultCampaign, HalfOfTheCountsAndALagAreFoundWhileTheMotorWindsItsTendonsUp) {
  for (const auto& [situation, phase] : {std::pair{Situation::kFast, 2}, std::pair{Situation::kFast, 12},
                                         std::pair{Situation::kFollowing, 9}, std::pair{Situation::kMoving, 12}}) {
    for (const Mode mode : {Mode::kHalf, Mode::kSlow}) {
      const auto [run, hazard] = hazard_of({Joint::kForceps, situation, phase}, {Input::kEncoder, mode});
      EXPECT_EQ(run.end, State::kFaulted) << name(situation) << ' ' << phase << ' ' << name(mode);
      EXPECT_LE(run.detected_ms, 5) << name(situation) << ' ' << phase << ' ' << name(mode);
      EXPECT_LE(hazard.severity(limits()), 1.0) << name(situation) << ' ' << phase << ' ' << name(mode);
    }
  }
}

TEST(FaultCampaign, HalfOfTheCountsAreFoundByLooksAtRestBeforeTheJointMoves) {
  for (const Joint joint : {Joint::kForceps, Joint::kStiff, Joint::kContact, Joint::kFinger}) {
    EXPECT_GT(setup_of(joint).config.observer.answer_rad_per_a, Q24{}) << name(joint);
    const auto [run, hazard] = hazard_of({joint, Situation::kHolding, 0}, {Input::kEncoder, Mode::kHalf});
    EXPECT_EQ(run.fault, Fault::kEncoderMotion) << name(joint);
    EXPECT_LE(hazard.severity(limits()), 1.0) << name(joint);
  }
  for (const Situation situation : {Situation::kDisarmed, Situation::kStarting}) {
    const auto [run, hazard] = hazard_of({Joint::kForceps, situation, 0}, {Input::kEncoder, Mode::kHalf});
    EXPECT_LE(run.detected_ms, 400) << "armed after 100 ms, asked to move 300 ms later";
    EXPECT_LE(hazard.severity(limits()), 0.1) << name(situation);
  }
}

// Cut 4 ms after a tear and 2 ms after a loss of pretension keeps within the limit; found after 8 and 6 ms it was not.
TEST(FaultCampaign, ATornOrLooseTendonMovesTheJointByLessThanItsLimitBeyondACutAtTheOnset) {
  for (const Mode mode : {Mode::kTopBreaks, Mode::kBottomBreaks, Mode::kLoose}) {
    for (const int phase : {3, 4, 8, 13, 14, 18}) {
      const Scene scene{Joint::kForceps, Situation::kMoving, phase};
      const OneFault fault{Input::kTransmission, mode};
      const RunResult healthy = run_scene(scene, std::nullopt);
      const Hazard cut = hazard_beyond(healthy.course, run_scene(scene, Trouble{fault, {}, 0}).course);
      const Hazard hazard = hazard_of(scene, fault).second;
      EXPECT_LE(hazard.travel_rad, cut.travel_rad + limits().travel_rad) << name(mode) << ' ' << phase;
    }
  }
}

TEST(FaultCampaign, WhatIsUnsafeNeedsSomethingThatTheFirmwareIsNot) {
  EXPECT_STREQ(remedy({Input::kEncoder, Mode::kHalf}), "a second position sensor");
  EXPECT_STREQ(remedy({Input::kEncoder, Mode::kStuck}), "a finer encoder");
  EXPECT_EQ(remedy({Input::kAmplifier, Mode::kQuantised}), nullptr);
}

/// Fault after torque came back so many cycles after it went, in a fast motion.
auto armed_again(Joint joint, int into_the_motion, int pause) -> Fault {
  AxisConfig config = setup_of(joint).config;
  config.limits.supply_min_v = Q24{};
  sim::Plant plant(setup_of(joint).plant, 7);
  SimIo io(plant);
  FileBanks banks = FileBanks::temporary();
  Application<SimIo> application(io, banks);
  static_cast<void>(application.configure({&config, 1}, Rights::kMaintenance));
  const auto say = [&](const Request& request, int cycles) {
    static_cast<void>(application.post(request));
    for (int i = 0; i < cycles; ++i) {
      application.rt_tick();
    }
  };
  say({.kind = Request::Kind::kDisarm}, 100);
  say({.kind = Request::Kind::kArm}, 300);
  say({.kind = Request::Kind::kMove,
       .position_rad = Q24::from_double(0.5),
       .speed_rad_s = config.limits.joint_speed_rad_s},
      into_the_motion);
  say({.kind = Request::Kind::kDisarm}, pause);
  say({.kind = Request::Kind::kArm}, 400);
  return application.telemetry().first_fault;
}

TEST(FalseAlarms, AJointIsArmedAgainWhileItStillSpringsBack) {
  for (const Joint joint : {Joint::kForceps, Joint::kContact}) {
    for (const int into_the_motion : {110, 210, 310, 410}) {
      for (const int pause : {2, 4, 6, 8, 12, 16, 30}) {
        const Fault fault = armed_again(joint, into_the_motion, pause);
        EXPECT_EQ(fault, Fault::kNone) << name(joint) << ' ' << into_the_motion << ' ' << pause << ' '
                                       << info(fault).name;
      }
    }
  }
}

// Two drawn joints that the observer's own look broke loose, and stopped, when it still went against the last count.
TEST(FalseAlarms, ALookDoesNotBreakAJointLooseThatIsAboutToMove) {
  for (const std::uint64_t seed : {80116U, 80323U}) {
    const FalseAlarms alarms = run_false_alarms(300.0 / 3600.0, seed, 1);
    EXPECT_TRUE(alarms.stops.empty()) << seed;
    EXPECT_NEAR(alarms.hours, 300.0 / 3600.0, 1e-6) << seed;
  }
}

// A contact helped the motor of the one on before it turned round; the winding's heat limit took 0.94 A from the other
// in one cycle.
TEST(FalseAlarms, AHelpfulLoadAndAStepOfTorqueStopNoJoint) {
  for (const std::uint64_t seed : {220024U, 220045U}) {
    EXPECT_TRUE(run_false_alarms(300.0 / 3600.0, seed, 1).stops.empty()) << seed;
  }
}

// Friction's share of what the first three pressed with, where they turned round; a tremor that gave the fourth its
// speed and took it again; a contact that the fifth ran into at 2 rad/s.
TEST(FalseAlarms, FrictionUnderLoadATremorAndAContactStopNoJoint) {
  for (const std::uint64_t seed : {260262U, 260382U, 260065U, 230046U, 270341U}) {
    EXPECT_TRUE(run_false_alarms(300.0 / 3600.0, seed, 1).stops.empty()) << seed;
  }
}

// Its gains leave its servo 13 deg of phase: swinging at 80 Hz its tip comes to four times the limit of its speed.
TEST(FalseAlarms, AStopOfAJointThatSwingsBeyondItsSpeedIsCountedApart) {
  const FalseAlarms alarms = run_false_alarms(300.0 / 3600.0, 260298, 1);
  ASSERT_EQ(alarms.stops.size(), 1U);
  EXPECT_GT(alarms.stops[0].speed_share, HazardLimits{}.speed_factor);
  EXPECT_EQ(alarms.false_stops(), 0);
}

// Two joints that swing with their drawn gains, after 5.4 and 2.7 s.
TEST(FalseAlarms, TunedJointsDoNotSwing) {
  for (const std::uint64_t seed : {260300U, 260071U}) {
    EXPECT_EQ(run_false_alarms(300.0 / 3600.0, seed, 1).stops.size(), 1U) << seed;
    EXPECT_TRUE(run_false_alarms(300.0 / 3600.0, seed, 1, Gains::kTuned).stops.empty()) << seed;
  }
}

// A look near zero torque let it go where its tendons still pulled.
TEST(FalseAlarms, WhatWasConfirmedBeforeASilenceDoesNotCount) {
  EXPECT_TRUE(run_false_alarms(300.0 / 3600.0, 290021, 1, Gains::kTuned).stops.empty());
}

TEST(FalseAlarms, AreTheSameOnAnyNumberOfThreads) {
  const FalseAlarms one = run_false_alarms(0.2, 1, 1);
  const FalseAlarms two = run_false_alarms(0.2, 1, 2);
  EXPECT_EQ(one.stops.size(), two.stops.size());
  EXPECT_EQ(one.hours, two.hours);
  EXPECT_GT(one.hours, 0.1);
}

}  // namespace
}  // namespace capstan::tools
