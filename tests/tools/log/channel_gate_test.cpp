// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/channel_gate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "capstan/tests/tools/log/small_log.hpp"
#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

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

// Clocks of cameras jitter, and pictures are lost.
TEST(ChannelGate, ACameraThatJittersAndLosesPicturesIsNamed) {
  for (const auto& [jitter, lost] : {std::pair(1, 0U), {2, 0U}, {0, 15U}, {2, 15U}, {1, 25U}}) {
    Log log;
    std::uint32_t chance = 7;
    double seen = log.q2[0];
    Index next = 0;
    for (Index i = 0, beat = 0; i < kRows; ++i) {
      if (i == next) {
        chance = chance * 1664525U + 1013904223U;
        seen = (chance >> 8U) % 100 < lost ? seen : log.q2[i];
        chance = chance * 1664525U + 1013904223U;
        next = 7 * ++beat + static_cast<Index>((chance >> 8U) % static_cast<std::uint32_t>(jitter + 1));
      }
      log.q2[i] = seen;
    }
    EXPECT_EQ(found(log), Words{"held q2"}) << jitter << " " << lost;
  }
}

TEST(ChannelGate, AChannelThatChangesByChanceIsNotHeldByAClock) {
  for (const std::uint32_t share : {25U, 35U, 50U}) {
    Log log;
    std::uint32_t chance = 7;
    for (Index i = 1; i < kRows; ++i) {
      chance = chance * 1664525U + 1013904223U;
      log.q2[i] = (chance >> 8U) % 100 < share ? log.q2[i] : log.q2[i - 1];
    }
    const auto words = found(log);
    EXPECT_EQ(std::find(words.begin(), words.end(), "held q2"), words.end()) << share;
  }
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

auto with_noise(VectorXd x, double size) -> VectorXd {
  std::uint32_t noise = 5;
  for (double& value : x) {
    noise = noise * 1664525U + 1013904223U;
    value += size * (static_cast<double>(noise >> 8U) / 16777216.0 - 0.5);
  }
  return x;
}

// By shares of the rows, with noise that lifts single rows off the end too.
TEST(ChannelGate, HoweverManyRowsAreCutOffUpToHalfTheyAreNamed) {
  for (const double noise : {0.0, 0.02}) {
    for (const double share : {0.02, 0.05, 0.15, 0.25, 0.45}) {
      for (const bool both : {false, true}) {
        Log log;
        log.tau = with_noise(log.tau, noise);
        const double part = both ? 0.5 * share : share;
        const double high = quantile(log.tau, 1.0 - part);
        log.tau = log.tau.cwiseMin(high).cwiseMax(both ? quantile(log.tau, part) : log.tau.minCoeff());
        const auto words = found(log);
        EXPECT_NE(std::find(words.begin(), words.end(), "clipped tau"), words.end())
            << noise << " " << share << " " << both;
        EXPECT_EQ(std::find(words.begin(), words.end(), "stuck tau"), words.end()) << share;
      }
    }
  }
}

// A motor that slows down before it rests at both ends of its way, or stops at once, and what is coarse there.
TEST(ChannelGate, WhatRestsAtTheEndsOfItsWayIsNotCutOff) {
  for (const double step : {0.0, 1e-4, 2e-3}) {
    for (const bool at_once : {false, true}) {
      Log log;
      for (Index i = 0; i < kRows; ++i) {
        const double phase = static_cast<double>(i % 800) / 250.0;  // up, rest, down, rest
        const double way = phase < 1.0 ? phase : phase < 1.6 ? 1.0 : phase < 2.6 ? 2.6 - phase : 0.0;
        const double angle = at_once ? way + 0.3 * way * (1.0 - way) : way * way * (3.0 - 2.0 * way);
        log.q1[i] = step > 0.0 ? std::round(angle / step) * step : angle;
        log.q2[i] = 0.7 * log.q1[i];
      }
      for (const auto& finding : inspect_channels(
               kPeriod, {{"q1", ChannelRole::kMotorAngle, &log.q1}, {"q2", ChannelRole::kJointAngle, &log.q2}})) {
        EXPECT_NE(finding.fault, ChannelFault::kClipped) << finding.channel << " " << step << " " << at_once;
      }
    }
  }
}

TEST(ChannelGate, AMotorThatIsSwitchedOffBeforeTheLogEndsIsNotCutOff) {
  Log log;
  log.tau = log.tau.array() - log.tau.minCoeff() + 0.05;
  log.tau.tail(kRows / 3).setZero();
  const auto words = found(log);
  EXPECT_EQ(std::find(words.begin(), words.end(), "clipped tau"), words.end());
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

// Where noise takes it to and fro over its zero.
TEST(ChannelGate, ANoisyAngleThatStartsAnewIsNotToldToHaveWildValues) {
  for (const double noise : {0.0, 0.01, 0.05}) {
    Log log;
    log.q2 = with_noise(8.0 * log.q2, noise);
    for (double& q : log.q2) {
      q = std::remainder(q, 2.0 * std::numbers::pi);
    }
    EXPECT_EQ(found(log), Words{"wrapped q2"}) << noise;
  }
  Log wild;  // all come back
  for (const Index row : {100, 700, 1500, 2222}) {
    wild.q2[row] = 40.0;
  }
  EXPECT_EQ(found(wild), Words{"spikes q2"});
}

TEST(ChannelGate, ANumberThatLostItsSignIsNamedWithTheMappingThatCuresIt) {
  for (const auto& [bits, unit] : {std::pair(16, 1e-3), {12, 1e-3}, {16, 3e-5}}) {
    Log log;
    const VectorXd counts = (log.tau.array() / unit).round();
    const double range = std::exp2(bits);
    const VectorXd lost = counts.unaryExpr([range](double x) { return x < 0.0 ? x + range : x; });
    const auto findings = inspect_channels(kPeriod, {{"q1", ChannelRole::kMotorAngle, &log.q1},
                                                     {"axis0/tau_Nm", ChannelRole::kMotorEffort, &lost, "raw"}});
    ASSERT_EQ(findings.size(), 1U) << bits;
    EXPECT_STREQ(fault_word(findings[0].fault), "wrapped");
    const std::string& what = findings[0].what;
    const auto begin = what.find("--map \"") + 7;
    const std::string mapping = what.substr(begin, what.find('"', begin) - begin);
    std::string text = "time_s,raw\n";
    for (Index i = 0; i < 600; ++i) {
      text += std::to_string(i) + "," + exact(lost[i]) + "\n";
    }
    EXPECT_EQ(CsvLog::parse(text, "x.csv", parse_mappings({mapping})).column("axis0/tau_Nm"), counts.head(600))
        << mapping;
  }
  Log sentinel;  // what a device says when it has no value
  sentinel.tau = ((sentinel.tau.array() - sentinel.tau.minCoeff() + 0.1) * 1000.0).round();
  for (const Index row : {100, 700, 1500, 2222}) {
    sentinel.tau[row] = 65535.0;
  }
  EXPECT_EQ(found(sentinel), Words{"spikes tau"});
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

// A law's answer may come late, but none looks ahead.
TEST(ChannelGate, OnlyALateTargetIsToldThatAnEffectTakesItUp) {
  const Log log;
  const VectorXd q1 = held_back(log.q1, 7);
  const VectorXd tau = held_back(log.tau, 7);
  const VectorXd q2 = held_back(log.q2, 7);
  for (const auto& [motor, effort, joint, taken_up] : {std::tuple(&q1, &log.tau, &log.q2, false),
                                                       {&log.q1, &tau, &log.q2, false},
                                                       {&log.q1, &log.tau, &q2, true},
                                                       {&q1, &log.tau, nullptr, false},
                                                       {&log.q1, &tau, nullptr, true}}) {
    const auto findings = inspect_channels(kPeriod, {{"q1", ChannelRole::kMotorAngle, motor},
                                                     {"tau", ChannelRole::kMotorEffort, effort},
                                                     {"q2", ChannelRole::kJointAngle, joint}});
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_EQ(findings[0].what.find("transport_delay can take it up") != std::string::npos, taken_up)
        << findings[0].channel << " " << findings[0].what;
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
