// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/channel_gate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "capstan/tests/tools/log/small_log.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using namespace test;

auto found(const Log& log) -> std::vector<std::string> {
  std::vector<std::string> words;
  for (const auto& finding : inspect_channels(kPeriod, {{"q1", ChannelRole::kMotorAngle, &log.q1},
                                                        {"tau", ChannelRole::kMotorEffort, &log.tau},
                                                        {"q2", ChannelRole::kJointAngle, &log.q2}})) {
    words.push_back(std::string(fault_word(finding.fault)) + " " + finding.channel);
  }
  return words;
}

using Words = std::vector<std::string>;

TEST(ChannelGate, ACleanLogIsNotAccused) {
  EXPECT_EQ(found({}), Words{});
}

TEST(ChannelGate, SingleWildValuesAreNamed) {
  for (const double size : {-3.0, 0.6, 100.0}) {
    Log log;
    log.tau[1234] += size;
    EXPECT_EQ(found(log), Words{"spikes tau"}) << size;
  }
}

TEST(ChannelGate, AFewWildValuesOfAShortLogDoNotHideEachOther) {
  Log log;
  for (Eigen::VectorXd* channel : {&log.q1, &log.tau, &log.q2}) {
    *channel = Eigen::VectorXd(channel->segment(1000, 300));
  }
  EXPECT_EQ(found(log), Words{});
  for (const Index row : {40, 150, 222}) {
    log.tau[row] += 3.0;
    EXPECT_EQ(found(log), Words{"spikes tau"}) << row;
  }
}

TEST(ChannelGate, AHeldChannelIsNamedWithItsRate) {
  Log log;
  for (Index i = 0; i < kRows; ++i) {
    log.q2[i] = log.q2[i - i % 7];
  }
  EXPECT_EQ(found(log), Words{"held q2"});
}

TEST(ChannelGate, AMagnitudeIsNamed) {
  Log log;
  log.tau = log.tau.cwiseAbs();
  EXPECT_EQ(found(log), Words{"unsigned tau"});
}

TEST(ChannelGate, AChannelThatIsCutOffIsNamed) {
  Log log;
  log.tau = log.tau.cwiseMin(0.5);
  EXPECT_EQ(found(log), Words{"clipped tau"});
}

TEST(ChannelGate, AChannelThatStandsStillForAWhileIsNamed) {
  Log log;
  log.q2.segment(1000, 400).setConstant(log.q2[1000]);
  EXPECT_EQ(found(log), Words{"stuck q2"});
}

TEST(ChannelGate, AnAngleThatStartsAnewAfterATurnIsNamed) {
  Log log;
  for (double& q : log.q1) {
    q = std::remainder(8.0 * q, 2.0 * std::numbers::pi);
  }
  const auto words = found(log);
  ASSERT_FALSE(words.empty());
  EXPECT_EQ(words.front(), "wrapped q1");
}

TEST(ChannelGate, AWrapIsUnwrappedByTheTurnOfItsSensor) {
  for (const auto& [turn, text] : {std::pair{2.0 * std::numbers::pi, "period=6.2831853)"},
                                   {360.0, "period=360)"},
                                   {1.0, "period=1)"},
                                   {4096.0, "period=4096)"}}) {
    Log log;
    for (double& q : log.q1) {
      q = std::remainder(1.3 * turn * q, turn);
    }
    const auto findings = inspect_channels(kPeriod, {{"q1", ChannelRole::kMotorAngle, &log.q1}});
    ASSERT_FALSE(findings.empty());
    EXPECT_NE(findings.front().what.find(text), std::string::npos) << findings.front().what;
  }
}

// Dry friction alone: only angles start anew after a turn.
TEST(ChannelGate, ATorqueThatSwitchesBetweenTwoLevelsIsNotToldToBeUnwrapped) {
  Log log;
  for (Index i = 0; i < kRows; ++i) {
    log.tau[i] = std::copysign(0.08, log.q1[std::min(i + 1, kRows - 1)] - log.q1[std::max<Index>(i - 1, 0)]);
  }
  for (const auto& word : found(log)) {
    EXPECT_EQ(word.find("tau"), std::string::npos) << word;
  }
  log = {};
  log.tau.tail(kRows / 2).array() += 2.0 * std::numbers::pi * log.tau.cwiseAbs().maxCoeff();
  EXPECT_EQ(found(log).front(), "jump tau");
}

TEST(ChannelGate, ASingleJumpIsAWrapOnlyByATurn) {
  for (const auto& [jump, word] : {std::pair{9.0, "jump q2"}, {2.0 * std::numbers::pi, "wrapped q2"}}) {
    Log log;
    log.q2.tail(kRows / 2).array() += jump;
    const auto words = found(log);
    ASSERT_FALSE(words.empty());
    EXPECT_EQ(words.front(), word);
  }
}

// A tendon that slips once by a twentieth of the joint's range is no larger a change than half of the range, which a
// turn is, and far larger than all others.
TEST(ChannelGate, AJointThatLeapsOnceWithoutItsMotorIsSaidToHaveJumped) {
  const double range = Log{}.q2.maxCoeff() - Log{}.q2.minCoeff();
  for (const double share : {0.2, 0.05}) {
    Log log;
    log.q2.tail(kRows / 2).array() += share * range;
    EXPECT_EQ(found(log).front(), "jump q2") << share;
  }
  Log both;  // a motor that goes there as well
  both.q1.tail(kRows / 2).array() += 0.2 * range;
  both.q2.tail(kRows / 2).array() += 0.2 * range;
  const auto words = found(both);
  EXPECT_EQ(std::find(words.begin(), words.end(), "jump q2"), words.end());
}

TEST(ChannelGate, ACoarseChannelIsNamed) {
  Log log;
  log.q2 = (log.q2.array() * 20.0).round() / 20.0;
  const auto words = found(log);
  EXPECT_NE(std::find(words.begin(), words.end(), "quantised q2"), words.end());
}

TEST(ChannelGate, DegreesBesideRadiansAreNamed) {
  Log log;
  log.q2 *= 180.0 / std::numbers::pi;
  EXPECT_EQ(found(log), Words{"degrees q2"});
  Log other;
  other.q1 *= 180.0 / std::numbers::pi;
  EXPECT_EQ(found(other), Words{"degrees q1"});
}

TEST(ChannelGate, UnitsDoNotMatter) {
  Log log;
  log.tau[777] += 1.0;
  log.tau *= 1e6;
  log.q1 *= 1e-4;
  log.q2 *= 1e-4;
  EXPECT_EQ(found(log), Words{"spikes tau"});
}

TEST(ChannelGate, EachLateChannelIsNamed) {
  for (const auto& [member, name] : {std::pair(&Log::q1, "late q1"), {&Log::tau, "late tau"}, {&Log::q2, "late q2"}}) {
    for (const Index rows : {2, 7, 16, 40}) {
      Log log;
      log.*member = held_back(log.*member, rows);
      EXPECT_EQ(found(log), Words{name}) << rows;
    }
  }
}

// What a law can not take up has another cure.
TEST(ChannelGate, ALateChannelIsToldWhatCuresIt) {
  for (const auto& [rows, cure] : {std::pair(12, "can take it up"), {30, "takes up 120 ms at most, so give"}}) {
    const Log log;
    const VectorXd late = held_back(log.q2, rows);
    const auto findings = inspect_channels(kPeriod, {{"q1", ChannelRole::kMotorAngle, &log.q1},
                                                     {"tau", ChannelRole::kMotorEffort, &log.tau},
                                                     {"q2", ChannelRole::kJointAngle, &late}});
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_NE(findings[0].what.find(cure), std::string::npos) << findings[0].what;
  }
}

// A tendon that drags makes its torque run behind the motor as a late channel does.
TEST(ChannelGate, ALateTorqueBeforeAJointMayBeTheJoints) {
  const Log log;
  const VectorXd late = held_back(log.tau, 12);
  for (const bool sees_joint : {true, false}) {
    std::vector<GateChannel> channels = {{"q1", ChannelRole::kMotorAngle, &log.q1},
                                         {"tau", ChannelRole::kMotorEffort, &late}};
    if (sees_joint) {
      channels.push_back({"q2", ChannelRole::kJointAngle, &log.q2});
    }
    const auto findings = inspect_channels(kPeriod, channels);
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_EQ(findings[0].what.find("this is not a delay") != std::string::npos, sees_joint) << findings[0].what;
  }
}

TEST(ChannelGate, WildValuesDoNotHideALateChannel) {
  Log log;
  log.tau = held_back(log.tau, 4);
  log.tau[1234] += 30.0;
  EXPECT_EQ(found(log), (Words{"spikes tau", "late tau"}));
}

TEST(ChannelGate, DragAndFrictionThatLagInTravelAreNoDelay) {
  Log log;
  double bent = log.q1[0];
  for (Index i = 1; i + 1 < kRows; ++i) {
    bent = std::clamp(bent, log.q1[i] - 0.02, log.q1[i] + 0.02);
    log.q2[i] += -0.02 * (log.q1[i + 1] - log.q1[i - 1]) / (2.0 * kPeriod) + 0.3 * (bent - log.q1[i]);
  }
  EXPECT_EQ(found(log), Words{});
}

}  // namespace
}  // namespace capstan::tools
