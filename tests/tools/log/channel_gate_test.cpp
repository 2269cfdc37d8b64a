// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/channel_gate.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <tuple>

#include "capstan/tests/tools/log/small_log.hpp"
#include "capstan/tools/log/channel_delay.hpp"
#include "capstan/tools/log/delay_law.hpp"

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

TEST(ChannelGate, EachLateChannelIsNamedWithItsDelay) {
  constexpr double kHalfRow = 0.5;  // as far pulls what the law does not have
  for (const auto& [member, late, name] : {std::tuple(&Log::q1, LateChannel::kMotorAngle, "late q1"),
                                           {&Log::tau, LateChannel::kMotorEffort, "late tau"},
                                           {&Log::q2, LateChannel::kTarget, "late q2"}}) {
    for (const Index rows : {2, 7}) {
      Log log;
      log.*member = held_back(log.*member, rows);
      EXPECT_EQ(found(log), Words{name}) << rows;
      const auto delay = delay_between({&log.q1, &log.tau, &log.q2, kPeriod});
      ASSERT_TRUE(delay) << name << rows;
      EXPECT_EQ(delay->channel, late) << name << rows;
      EXPECT_LE(delay->low - kHalfRow, static_cast<double>(rows)) << name;
      EXPECT_GE(delay->high + kHalfRow, static_cast<double>(rows)) << name;
    }
  }
}

// A camera at 1 kHz is late by many rows.
TEST(ChannelGate, AChannelThatIsManyRowsLateIsNamedWithItsDelay) {
  for (const auto& [member, name] : {std::pair(&Log::q1, "late q1"), {&Log::tau, "late tau"}, {&Log::q2, "late q2"}}) {
    for (const Index rows : {16, 40}) {
      Log log;
      log.*member = held_back(log.*member, rows);
      EXPECT_EQ(found(log), Words{name}) << rows;
      const auto delay = delay_between({&log.q1, &log.tau, &log.q2, kPeriod});
      ASSERT_TRUE(delay) << name << rows;
      EXPECT_NEAR(delay->rows, static_cast<double>(rows), 0.5) << name;
    }
  }
}

// Several strokes late: a wrong delay would be worse than none.
TEST(ChannelGate, NoDelayIsNamedWhereItIsFartherThanAStroke) {
  Log log;
  log.q2 = held_back(log.q2, kRows / 4);
  const auto delay = delay_between({&log.q1, &log.tau, &log.q2, kPeriod});
  EXPECT_FALSE(delay) << delay->rows;
}

TEST(ChannelGate, TheIntervalOfALateEffortHoldsItsDelay) {
  Log log;
  log.tau = held_back(log.tau, 4);
  const auto delay = delay_between({&log.q1, &log.tau, &log.q2, kPeriod});
  ASSERT_TRUE(delay);
  EXPECT_EQ(delay->channel, LateChannel::kMotorEffort);
  EXPECT_LE(delay->low, 4.0);
  EXPECT_GE(delay->high, 4.0);
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

TEST(ChannelGate, AMotionThatHardlyTurnsTellsNoDelay) {
  Log log;
  for (Index i = 0; i < kRows; ++i) {
    log.q1[i] += 3.0 * kPeriod * static_cast<double>(i);
  }
  log.q2 = held_back(0.7 * log.q1, 5);
  EXPECT_FALSE(delay_between({&log.q1, &log.tau, &log.q2, kPeriod}));
}

TEST(ChannelGate, ALongLogTakesNoLonger) {
  constexpr Index kLong = 600000;
  VectorXd q1(kLong);
  VectorXd tau(kLong);
  for (Index i = 0; i < kLong; ++i) {
    const double t = kPeriod * static_cast<double>(i);
    q1[i] = motor(t);
    tau[i] = torque(t) + 1e-4 * std::sin(1e3 * t * t);
  }
  const VectorXd q2 = 0.7 * q1 - 0.05 * tau;
  const auto start = std::chrono::steady_clock::now();
  static_cast<void>(delay_between({&q1, &tau, &q2, kPeriod}));
  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_LT(took, 10.0) << "five times what it takes on an idle machine";
}

TEST(ShiftFit, ATurnIsPutWhereTheWayBackBegan) {
  // Comes to rest at row 500, rests, and starts back at one acceleration at row 900, in steps of an encoder.
  VectorXd q(1500);
  for (Index i = 0; i < q.size(); ++i) {
    const auto row = static_cast<double>(i);
    const double angle = i < 500   ? 1.0 - std::pow((row - 500.0) / 500.0, 2)
                         : i < 900 ? 1.0
                                   : 1.0 - 4e-6 * std::pow(row - 900.0, 2);
    q[i] = std::round(angle / 1e-3) * 1e-3;
  }
  const Turns turns = turns_of(q);
  ASSERT_EQ(turns.count, 1);
  EXPECT_GT(turns.direction[880], 0.0);
  EXPECT_LT(turns.direction[920], 0.0);
}

TEST(ShiftFit, ALogThatIsTooShortHasNone) {
  EXPECT_EQ(parts_of_log(50, 2).rows, 0);
  constexpr Index kFew = 200;
  const LogParts parts = parts_of_log(kFew, 2);
  const VectorXd x = signal(motor).head(kFew);
  EXPECT_FALSE(shift_behind(std::vector(5, cut(x, parts)), cut(x, parts), parts));
}

TEST(ShiftFit, AShiftIsFoundBetweenTheRowsNearAndFar) {
  const auto at = [](double rows) {
    VectorXd x(kRows);
    for (Index i = 0; i < kRows; ++i) {
      x[i] = motor(kPeriod * (static_cast<double>(i) - rows));
    }
    return x;
  };
  const VectorXd noise = signal([](double) { return 0.0; });
  const LogParts parts = parts_of_log(kRows, 2, kLongReach);
  for (const double rows : {0.0, 0.3, 9.5, -33.7, 120.4, -201.0}) {
    const auto fit = shift_behind({cut(at(0.0), parts)}, cut(3.0 * at(rows) + noise, parts), parts);
    ASSERT_TRUE(fit) << rows;
    EXPECT_NEAR(fit->rows, rows, 0.05);
    EXPECT_LT(fit->half, 0.2) << rows;
  }
  const auto beyond = shift_behind({cut(at(0.0), parts)}, cut(at(300.0) + noise, parts), parts);
  EXPECT_TRUE(!beyond || std::abs(beyond->rows) <= static_cast<double>(kLongReach));
}

}  // namespace
}  // namespace capstan::tools
