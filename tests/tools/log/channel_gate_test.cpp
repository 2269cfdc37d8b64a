// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/channel_gate.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>

#include "capstan/tools/log/axis_log.hpp"
#include "capstan/tools/log/channel_delay.hpp"
#include "capstan/tools/log/time_scale.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kRows = 4000;
constexpr double kPeriod = 0.005;

auto signal(double (*of)(double)) -> VectorXd {
  VectorXd x(kRows);
  std::uint32_t noise = 1;
  for (Index i = 0; i < kRows; ++i) {
    noise = noise * 1664525U + 1013904223U;
    x[i] = of(kPeriod * static_cast<double>(i)) + 1e-4 * (static_cast<double>(noise >> 8U) / 16777216.0 - 0.5);
  }
  return x;
}

auto motor(double t) -> double {
  return 0.8 * std::sin(1.3 * t) + 0.3 * std::sin(4.1 * t + 1.0);
}
auto torque(double t) -> double {
  const double speed = 1.04 * std::cos(1.3 * t) + 1.23 * std::cos(4.1 * t + 1.0);
  return 0.4 * motor(t) + 0.2 * std::tanh(20.0 * speed) + 0.05;
}
auto joint(double t) -> double {
  return 0.7 * motor(t) - 0.05 * torque(t);
}

struct Log {
  VectorXd q1 = signal(motor), tau = signal(torque), q2 = signal(joint);
};

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

TEST(ChannelGate, ALateChannelIsNamedAndItsIntervalHoldsTheDelay) {
  Log log;
  constexpr Index kLate = 4;
  log.tau.tail(kRows - kLate) = VectorXd(log.tau.head(kRows - kLate));
  EXPECT_EQ(found(log), Words{"late tau"});
  const auto delay = delay_between({&log.q1, &log.tau, &log.q2, false});
  ASSERT_TRUE(delay);
  EXPECT_EQ(delay->channel, LateChannel::kMotorEffort);
  EXPECT_LE(delay->low, 4.0);
  EXPECT_GE(delay->high, 4.0);
}

auto text_of(const Log& log, double unit, bool slow_joint = false, Index repeat = 1) -> std::string {
  std::string text = "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/q2_rad\n";
  for (Index i = 0; i < kRows; ++i) {
    const Index k = i - i % repeat;
    text += exact(unit * kPeriod * static_cast<double>(i)) + "," + exact(log.q1[k]) + "," + exact(log.tau[k]) + "," +
            (slow_joint && i % 4 != 0 ? "" : exact(log.q2[k])) + "\n";
  }
  return text;
}

TEST(AxisLogGate, TimeInAnotherUnitIsRefusedWithTheCureAndTakesNoLonger) {
  for (const auto& [unit, word] : {std::pair{1e3, "1e-3"}, {1e6, "1e-6"}, {1e9, "1e-9"}}) {
    const std::string text = text_of({}, unit);
    try {
      read_axis(CsvLog::parse(text, "x.csv"), {});
      FAIL() << unit;
    } catch (const BadInput& refusal) {
      EXPECT_NE(std::string(refusal.what()).find("--map \"time_s=time_s*" + std::string(word)), std::string::npos)
          << refusal.what();
    }
    const auto cured =
        read_axis(CsvLog::parse(text, "x.csv", parse_mappings({"time_s=time_s*" + std::string(word)})), {});
    EXPECT_NEAR(cured.period_s, kPeriod, 1e-9);
    EXPECT_GT(read_axis(CsvLog::parse(text, "x.csv", parse_mappings({"time_s=time_s*1"})), {}).period_s, 1.0);
  }
  EXPECT_TRUE(time_unit_fault(0.25).empty());
}

TEST(AxisLogGate, AWildValueIsNamedByItsLineAndAStraightLineTakesItsPlace) {
  Log log;
  log.q2[100] = 50.0;
  const AxisLog axis = read_axis(CsvLog::parse(text_of(log, 1.0), "x.csv"), {});
  ASSERT_EQ(axis.warnings.size(), 1U);
  EXPECT_NE(axis.warnings[0].find("x.csv:102: axis0/q2_rad stands out"), std::string::npos) << axis.warnings[0];
  EXPECT_LT(std::abs(axis.q2_rad[100]), 1.0);
  AxisRequest all;
  all.every_row = true;
  EXPECT_EQ(read_axis(CsvLog::parse(text_of(log, 1.0), "x.csv"), all).q2_rad[100], 50.0);
}

TEST(AxisLogGate, OfRowsThatRepeatOnlyTheMeasuredOnesAreUsed) {
  const AxisLog axis = read_axis(CsvLog::parse(text_of({}, 1.0, false, 5), "x.csv"), {});
  EXPECT_EQ(axis.samples(), kRows / 5);
  EXPECT_NEAR(axis.period_s, 5 * kPeriod, 1e-9);
  EXPECT_NE(axis.warnings.back().find("40 Hz"), std::string::npos) << axis.warnings.back();
}

TEST(AxisLogGate, OfTwoRatesTheSlowersRowsAreUsed) {
  const Log log;
  const AxisLog axis = read_axis(CsvLog::parse(text_of(log, 1.0, true), "x.csv"), {});
  EXPECT_EQ(axis.samples(), kRows / 4);
  EXPECT_EQ(axis.q1_rad[10], log.q1[40]);
  ASSERT_FALSE(axis.warnings.empty());
  EXPECT_NE(axis.warnings[0].find("1000 rows of axis0/q2_rad, the slowest"), std::string::npos) << axis.warnings[0];
}

}  // namespace
}  // namespace capstan::tools
