// SPDX-License-Identifier: Apache-2.0
#include "tools/campaign/fault_campaign.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <set>
#include <sstream>

namespace capstan::tools {
namespace {

auto campaign() -> const std::vector<CampaignRow>& {
  static const std::vector<CampaignRow> rows = run_fault_campaign();
  return rows;
}

auto under_torque(const CampaignRow& row) -> bool {
  return row.situation == Situation::kHolding || row.situation == Situation::kMoving ||
         row.situation == Situation::kFollowing || row.situation == Situation::kExperiment;
}

TEST(FaultCampaign, CoversEveryInputInEveryModeInEverySituationOnce) {
  std::set<std::tuple<Input, Mode, Situation>> seen;
  for (const CampaignRow& row : campaign()) {
    EXPECT_TRUE(seen.emplace(row.input, row.mode, row.situation).second);
  }
  EXPECT_EQ(seen.size(), 7U * 8U * 6U);
}

TEST(FaultCampaign, NothingEndsAnywhereButInANamedSafeState) {
  std::ostringstream table;
  print_campaign(table, campaign());
  for (const CampaignRow& row : campaign()) {
    EXPECT_TRUE(row.impossible != nullptr || row.outcome != Outcome::kUnsafe)
        << name(row.input) << ' ' << name(row.mode) << " while " << name(row.situation) << '\n'
        << table.str();
  }
}

TEST(FaultCampaign, WhatIsDetectedUnderTorqueIsLatchedAndOffWithinTwoCycles) {
  int detected = 0;
  for (const CampaignRow& row : campaign()) {
    if (row.impossible == nullptr && under_torque(row) && row.detected_ms > 0) {
      ++detected;
      EXPECT_EQ(row.end, State::kFaulted) << name(row.input) << ' ' << name(row.mode);
      EXPECT_NE(row.fault, Fault::kNone);
      EXPECT_GE(row.off_after_cycles, 0);
      EXPECT_LE(row.off_after_cycles, 2);
    }
  }
  EXPECT_GT(detected, 70);
}

TEST(FaultCampaign, EachFaultIsDetectedAsSoonAsTheReadmeSays) {
  for (const CampaignRow& row : campaign()) {
    if (row.impossible != nullptr || !under_torque(row) || row.detected_ms < 0) {
      continue;
    }
    const bool from_the_onset = row.mode == Mode::kOff || row.mode == Mode::kNan;
    SCOPED_TRACE(std::string(name(row.input)) + ' ' + name(row.mode) + " while " + name(row.situation));
    if (from_the_onset && (row.input == Input::kEncoder || row.input == Input::kCurrent)) {
      EXPECT_EQ(row.detected_ms, 1);
    }
    if (row.input == Input::kEncoder && row.mode == Mode::kGarbage) {
      EXPECT_EQ(row.detected_ms, 1);
      EXPECT_EQ(row.fault, Fault::kEncoderJump);
    }
    if (row.input == Input::kReference && row.mode == Mode::kOff) {
      EXPECT_LE(row.detected_ms, 101);
      EXPECT_EQ(row.fault, Fault::kLinkLost);
    }
    if (row.input == Input::kEmergencyStop && row.mode == Mode::kOff) {
      EXPECT_EQ(row.detected_ms, 1);
    }
    if (row.input == Input::kSupply && (from_the_onset || row.mode == Mode::kWrongSign)) {
      EXPECT_EQ(row.detected_ms, 10);
      EXPECT_EQ(row.fault, Fault::kSupplyLow);
    }
    if (row.input == Input::kCurrent && row.mode == Mode::kGarbage) {
      EXPECT_LT(row.detected_ms, 150) << "most of what is random differs by more than half an ampere";
    }
  }
}

TEST(FaultCampaign, WithoutAFaultNothingIsReportedAndTheJointIsWhereItShouldBe) {
  for (const Situation situation :
       {Situation::kDisarmed, Situation::kHolding, Situation::kMoving, Situation::kFollowing, Situation::kExperiment}) {
    const CampaignRow row = run_without_fault(situation);
    EXPECT_EQ(row.outcome, Outcome::kTolerated) << name(situation);
    EXPECT_EQ(row.fault, Fault::kNone);
    EXPECT_LT(row.error_rad, 0.25) << "a rigid law on a joint with tendons is off by some degrees";
  }
}

}  // namespace
}  // namespace capstan::tools
