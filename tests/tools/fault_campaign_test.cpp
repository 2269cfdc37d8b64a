// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/campaign/fault_campaign.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "capstan/tools/campaign/false_alarms.hpp"

namespace capstan::tools {
namespace {

auto hazard_of(const Scene& scene, OneFault fault) -> std::pair<RunResult, Hazard> {
  const RunResult healthy = run_scene(scene, std::nullopt);
  RunResult faulty = run_scene(scene, Trouble{fault, std::nullopt, false});
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

// Not within limits.fault_travel: a healthy motor springs back against its torque too, and the margin to that takes 20
// ms.
TEST(FaultCampaign, TheObserverFindsAWrongSignWithin30Ms) {
  const Scene scene{Joint::kForceps, Situation::kMoving, 7};
  const auto [run, hazard] = hazard_of(scene, {Input::kEncoder, Mode::kWrongSign});
  EXPECT_LE(run.detected_ms, 30);
  EXPECT_LE(hazard.travel_rad, 0.2);
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
