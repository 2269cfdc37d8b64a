// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/channel_delay.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <tuple>

#include "capstan/tests/tools/log/small_log.hpp"
#include "capstan/tests/tools/play_operator.hpp"
#include "capstan/tools/log/delay_law.hpp"

namespace capstan::tools {
namespace {

using namespace test;

// By few rows, and by many, as a camera at 1 kHz is.
TEST(ChannelDelay, IsToldOfEachChannel) {
  constexpr double kHalfRow = 0.5;  // as far pulls what the law does not have
  for (const auto& [member, late, name] : {std::tuple(&Log::q1, LateChannel::kMotorAngle, "q1"),
                                           {&Log::tau, LateChannel::kMotorEffort, "tau"},
                                           {&Log::q2, LateChannel::kTarget, "q2"}}) {
    for (const Index rows : {2, 7, 16, 40}) {
      Log log;
      log.*member = held_back(log.*member, rows);
      const auto delay = delay_between({&log.q1, &log.tau, &log.q2, kPeriod});
      ASSERT_TRUE(delay) << name << rows;
      EXPECT_EQ(delay->channel, late) << name << rows;
      EXPECT_NEAR(delay->rows, static_cast<double>(rows), kHalfRow) << name;
      EXPECT_LE(delay->low - kHalfRow, static_cast<double>(rows)) << name;
      EXPECT_GE(delay->high + kHalfRow, static_cast<double>(rows)) << name;
    }
  }
}

// Several strokes late: a wrong delay would be worse than none.
TEST(ChannelDelay, IsNotToldWhereItIsFartherThanAStroke) {
  Log log;
  log.q2 = held_back(log.q2, kRows / 4);
  const auto delay = delay_between({&log.q1, &log.tau, &log.q2, kPeriod});
  EXPECT_FALSE(delay) << delay->rows;
}

TEST(ChannelDelay, OfALateEffortIsInItsInterval) {
  Log log;
  log.tau = held_back(log.tau, 4);
  const auto delay = delay_between({&log.q1, &log.tau, &log.q2, kPeriod});
  ASSERT_TRUE(delay);
  EXPECT_EQ(delay->channel, LateChannel::kMotorEffort);
  EXPECT_LE(delay->low, 4.0);
  EXPECT_GE(delay->high, 4.0);
}

// Whatever its width beside those that every law has; and a delay behind it is one still.
TEST(ChannelDelay, IsNotAGapBehindTheMotor) {
  for (const double half_width : {0.01, 0.021, 0.05, 0.12, 0.2}) {
    Log log;
    const VectorXd through = test::play_of(log.q1, half_width);
    log.q2 = 0.8 * through + 0.2 * (log.q2 - 0.7 * log.q1);  // with this log's noise and torque
    const auto none = delay_between({&log.q1, &log.tau, &log.q2, kPeriod});
    EXPECT_FALSE(none) << half_width << ": " << none->rows;
    log.q2 = held_back(log.q2, 7);
    const auto delay = delay_between({&log.q1, &log.tau, &log.q2, kPeriod});
    ASSERT_TRUE(delay) << half_width;
    EXPECT_EQ(delay->channel, LateChannel::kTarget) << half_width;
    EXPECT_NEAR(delay->rows, 7.0, 2.0) << half_width;  // up to 6 without a gap of the joint's own
  }
}

TEST(ChannelDelay, IsNotToldByAMotionThatHardlyTurns) {
  Log log;
  for (Index i = 0; i < kRows; ++i) {
    log.q1[i] += 3.0 * kPeriod * static_cast<double>(i);
  }
  log.q2 = held_back(0.7 * log.q1, 5);
  EXPECT_FALSE(delay_between({&log.q1, &log.tau, &log.q2, kPeriod}));
}

TEST(ChannelDelay, OfALongLogTakesNoLonger) {
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

// A large and a small stroke each way, 15 times; the same with a stroke that grows each time.
TEST(ShiftFit, AMotionThatIsRepeatedAsAWholeIsCounted) {
  VectorXd repeated(30'000);
  VectorXd growing(repeated.size());
  for (Index i = 0; i < repeated.size(); ++i) {
    const double t = static_cast<double>(i) / 2000.0;
    repeated[i] = std::sin(2.0 * std::numbers::pi * t) + 0.8 * std::sin(4.0 * std::numbers::pi * t);
    growing[i] = (1.0 + 0.1 * t) * repeated[i];
  }
  EXPECT_NEAR(turns_of(repeated).repeats, 15.0, 1.0);
  EXPECT_EQ(turns_of(growing).repeats, 1.0);
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
