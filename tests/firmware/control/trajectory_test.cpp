// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/control/trajectory.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace capstan {
namespace {

constexpr std::int64_t kRate = 1000;

auto limits_of(Q24 acceleration) -> LimitConfig {
  LimitConfig limits;
  limits.joint_acceleration_rad_s2 = acceleration;
  return limits;
}

/// Runs a trajectory and watches its dynamics. Positions are rounded to 2^-24 rad, so a difference of two is off by at
/// most one unit and a second difference by at most two.
class Watched {
 public:
  Watched(Q24 start, Q24 acceleration)
      : limits_(limits_of(acceleration)), last_(start.raw()), lowest_(last_), highest_(last_) {
    trajectory_.rt_reset(start);
  }
  void start(Q24 target, Q24 speed) {
    trajectory_.rt_start(target, speed);
    fastest_allowed_ = std::max(std::abs(speed_), speed.raw() / kRate + 1);
  }
  void stop() { trajectory_.rt_stop(limits_.joint_acceleration_rad_s2); }
  /// False if a limit was broken.
  auto step() -> bool {
    const std::int64_t position = trajectory_.rt_step(limits_.joint_acceleration_rad_s2).raw();
    const std::int64_t speed = position - last_;
    const bool speed_kept = std::abs(speed) <= fastest_allowed_ + 1;
    const bool acceleration_kept =
        std::abs(speed - speed_) <= limits_.joint_acceleration_rad_s2.raw() / (kRate * kRate) + 1 + 2;
    last_ = position;
    speed_ = speed;
    lowest_ = std::min(lowest_, position);
    highest_ = std::max(highest_, position);
    ++cycles_;
    return speed_kept && acceleration_kept;
  }
  auto run_to_end(long patience) -> bool {
    for (long i = 0; i < patience && !finished(); ++i) {
      if (!step()) {
        return false;
      }
    }
    return finished();
  }
  [[nodiscard]] auto finished() const -> bool { return trajectory_.finished(); }
  [[nodiscard]] auto position() const -> std::int64_t { return last_; }
  [[nodiscard]] auto lowest() const -> std::int64_t { return lowest_; }
  [[nodiscard]] auto highest() const -> std::int64_t { return highest_; }
  [[nodiscard]] auto cycles() const -> long { return cycles_; }
  [[nodiscard]] auto speed() const -> std::int64_t { return speed_; }

 private:
  Trajectory trajectory_;
  LimitConfig limits_;
  std::int64_t last_;
  std::int64_t speed_ = 0;
  std::int64_t fastest_allowed_ = 0;
  std::int64_t lowest_;
  std::int64_t highest_;
  long cycles_ = 0;
};

/// Time of the fastest possible move, s.
auto ideal_time(double distance, double speed, double acceleration) -> double {
  return distance >= speed * speed / acceleration ? distance / speed + speed / acceleration
                                                  : 2.0 * std::sqrt(distance / acceleration);
}

TEST(Trajectory, StandsWhereItWasReset) {
  Watched watched(Q24::from_double(0.7), Q24::from_int(10));
  EXPECT_TRUE(watched.finished());
  EXPECT_TRUE(watched.step());
  EXPECT_EQ(watched.position(), Q24::from_double(0.7).raw());
}

TEST(Trajectory, ReachesTheTargetExactlyInTheShortestTime) {
  for (const double target : {1.0, -1.0, 0.3, -1.999, 0.01}) {
    Watched watched(Q24{}, Q24::from_int(10));
    watched.start(Q24::from_double(target), Q24::from_int(2));
    ASSERT_TRUE(watched.run_to_end(10'000)) << target;
    EXPECT_EQ(watched.position(), Q24::from_double(target).raw());
    const double ideal_cycles = 1000.0 * ideal_time(std::fabs(target), 2.0, 10.0);
    EXPECT_LE(static_cast<double>(watched.cycles()), ideal_cycles + 4.0) << target;
    EXPECT_GE(static_cast<double>(watched.cycles()), ideal_cycles - 2.0) << target;
  }
}

TEST(Trajectory, MovesOfAFewUnitsEndToo) {
  for (const std::int32_t raw : {1, -1, 2, -3, 17, -170, 1000, -16777}) {
    for (const double acceleration : {0.01, 10.0, 60.0}) {
      Watched watched(Q24::from_int(1), Q24::from_double(acceleration));
      const Q24 target = Q24::from_int(1) + Q24::from_raw(raw);
      watched.start(target, Q24::from_double(0.001));
      ASSERT_TRUE(watched.run_to_end(5'000)) << raw << " at " << acceleration;
      EXPECT_EQ(watched.position(), target.raw());
    }
  }
}

TEST(Trajectory, AMoveToWhereItStandsIsFinishedAtOnce) {
  Watched watched(Q24::from_double(0.25), Q24::from_int(10));
  watched.start(Q24::from_double(0.25), Q24::from_int(2));
  EXPECT_TRUE(watched.finished());
}

TEST(Trajectory, IsFinishedOnceItStandsOnTheTargetAndNotBefore) {
  Watched watched(Q24{}, Q24::from_int(10));
  watched.start(Q24::from_int(1), Q24::from_int(2));
  int cycles_on_target = 0;
  while (!watched.finished()) {
    ASSERT_TRUE(watched.step());
    cycles_on_target += watched.position() == Q24::from_int(1).raw() ? 1 : 0;
  }
  EXPECT_EQ(cycles_on_target, 2) << "the one that lands and the one that stands";
}

TEST(Trajectory, ANewTargetInTheCycleOfLandingKeepsTheAcceleration) {
  // Every phase of landing: the last step may be anything up to a cycle's change of speed.
  for (int phase = 0; phase < 200; ++phase) {
    Watched watched(Q24{}, Q24::from_double(1.5));
    const Q24 target = Q24::from_double(0.01) + Q24::from_raw(phase);
    watched.start(target, Q24::from_double(0.01));
    while (watched.position() != target.raw()) {
      ASSERT_TRUE(watched.step()) << "phase " << phase;
    }
    watched.start(Q24::from_int(-1), Q24::from_double(0.01));
    for (int i = 0; i < 20; ++i) {
      ASSERT_TRUE(watched.step()) << "phase " << phase << " cycle " << i << " after landing";
    }
  }
}

TEST(Trajectory, MayCrossTheWholeRangeOfQuantities) {
  Watched watched(Q24::from_int(-125), Q24::from_int(60));
  watched.start(Q24::from_int(125), Q24::from_int(100));
  ASSERT_TRUE(watched.run_to_end(10'000));
  EXPECT_EQ(watched.position(), Q24::from_int(125).raw());
  EXPECT_EQ(watched.highest(), Q24::from_int(125).raw());
}

struct Move {
  Q24 start;
  Q24 target;
  Q24 speed;
  Q24 acceleration;
};

/// Limits anywhere in the ranges of the parameter table, and a distance that takes seconds, not hours.
auto any_move() -> Move {
  const auto fraction = [] { return *rc::gen::inRange(0, 1'000'001) * 1e-6; };
  const double speed = std::exp(std::log(0.001) + fraction() * std::log(100.0 / 0.001));
  const double acceleration = std::exp(std::log(0.01) + fraction() * std::log(60.0 / 0.01));
  const double distance = fraction() * std::min({4.0 * speed, 4.0 * acceleration, 100.0});
  const double start = (2.0 * fraction() - 1.0) * 25.0;
  const double target = *rc::gen::arbitrary<bool>() ? start + distance : start - distance;
  return {Q24::from_double(start), Q24::from_double(target), Q24::from_double(speed), Q24::from_double(acceleration)};
}

RC_GTEST_PROP(Trajectory, EveryMoveEndsOnItsTargetInTimeWithinItsLimitsAndWithoutOvershoot, ()) {
  const Move move = any_move();
  Watched watched(move.start, move.acceleration);
  watched.start(move.target, move.speed);
  const double ideal_cycles = 1000.0 * ideal_time(std::fabs((move.target - move.start).to_double()),
                                                  move.speed.to_double(), move.acceleration.to_double());
  RC_ASSERT(watched.run_to_end(static_cast<long>(ideal_cycles) + 10));
  RC_ASSERT(watched.position() == move.target.raw());
  RC_ASSERT(watched.lowest() >= std::min(move.start, move.target).raw());
  RC_ASSERT(watched.highest() <= std::max(move.start, move.target).raw());
}

RC_GTEST_PROP(Trajectory, ANewTargetInFlightKeepsTheLimitsAndIsReached, ()) {
  const Move first = any_move();
  Watched watched(first.start, first.acceleration);
  std::int64_t lowest = first.start.raw();
  std::int64_t highest = lowest;
  Q24 target = first.target;
  for (int leg = 0; leg < 4; ++leg) {
    lowest = std::min<std::int64_t>(lowest, target.raw());
    highest = std::max<std::int64_t>(highest, target.raw());
    watched.start(target, first.speed);
    const int cycles = *rc::gen::inRange(0, 3000);
    for (int i = 0; i < cycles; ++i) {
      RC_ASSERT(watched.step());
    }
    const double reach = std::min({4.0 * first.speed.to_double(), 4.0 * first.acceleration.to_double(), 100.0});
    target = first.start + Q24::from_double((*rc::gen::inRange(-1000, 1001)) * 1e-3 * reach);
  }
  watched.start(target, first.speed);
  RC_ASSERT(watched.run_to_end(60'000));
  RC_ASSERT(watched.position() == target.raw());
  lowest = std::min<std::int64_t>(lowest, target.raw());
  highest = std::max<std::int64_t>(highest, target.raw());
  // Targets lie inside the joint's limits, so a reference between them does too.
  RC_ASSERT(watched.lowest() >= lowest);
  RC_ASSERT(watched.highest() <= highest);
}

TEST(Trajectory, AReversalInFlightBrakesFirstAndThenTurns) {
  Watched watched(Q24{}, Q24::from_int(10));
  watched.start(Q24::from_int(2), Q24::from_int(2));
  for (int i = 0; i < 500; ++i) {
    ASSERT_TRUE(watched.step());
  }
  const std::int64_t turned_at = watched.position();
  watched.start(Q24::from_int(-1), Q24::from_int(2));
  ASSERT_TRUE(watched.run_to_end(10'000));
  EXPECT_EQ(watched.position(), Q24::from_int(-1).raw());
  EXPECT_GT(watched.highest(), turned_at);
  const double braking = 2.0 * 2.0 / (2.0 * 10.0);
  EXPECT_LE(static_cast<double>(watched.highest() - turned_at) / 16777216.0, braking);
}

TEST(Trajectory, ASlowerSpeedForTheRestOfAMoveIsReachedByBraking) {
  Watched watched(Q24{}, Q24::from_int(10));
  watched.start(Q24::from_int(2), Q24::from_int(2));
  for (int i = 0; i < 400; ++i) {
    ASSERT_TRUE(watched.step());
  }
  watched.start(Q24::from_int(2), Q24::from_double(0.5));
  for (int i = 0; i < 160; ++i) {
    ASSERT_TRUE(watched.step());
  }
  EXPECT_NEAR(static_cast<double>(watched.speed()), 0.5 / 1000.0 * 16777216.0, 1.5);
  EXPECT_TRUE(watched.run_to_end(10'000));
}

RC_GTEST_PROP(Trajectory, StopBrakesAtTheLimitAndEndsShortOfTheTarget, ()) {
  const Move move = any_move();
  Watched watched(move.start, move.acceleration);
  watched.start(move.target, move.speed);
  const int cycles = *rc::gen::inRange(0, 2000);
  for (int i = 0; i < cycles; ++i) {
    RC_ASSERT(watched.step());
  }
  const double braking_cycles = 1000.0 * static_cast<double>(std::abs(watched.speed()) + 1) * 1000.0 /
                                static_cast<double>(move.acceleration.raw());
  watched.stop();
  RC_ASSERT(watched.run_to_end(static_cast<long>(braking_cycles) + 3));
  RC_ASSERT(watched.lowest() >= std::min(move.start, move.target).raw());
  RC_ASSERT(watched.highest() <= std::max(move.start, move.target).raw());
  const std::int64_t rest = watched.position();
  RC_ASSERT(watched.step());
  RC_ASSERT(watched.position() == rest);
}

// Jerk. 10 rad/s2 at 2.5 krad/s3: a step from +10 to -10 rad/s2 takes 8 ms, which is a mean of eight positions.
constexpr double kAcceleration = 10.0;
auto soft_limits(double jerk) -> LimitConfig {
  LimitConfig limits = limits_of(Q24::from_double(kAcceleration));
  limits.joint_jerk_krad_s3 = Q24::from_double(jerk);
  return limits;
}

struct Soft {
  explicit Soft(double jerk_krad_s3, double start = 0.0) : last(start), before(start), oldest(start) {
    trajectory.rt_configure(soft_limits(jerk_krad_s3));
    trajectory.rt_reset(Q24::from_double(start));
  }
  void take(double now) {
    most_jerk = std::max(most_jerk, std::fabs(now - 3.0 * last + 3.0 * before - oldest) * 1e9);
    most_acceleration = std::max(most_acceleration, std::fabs(now - 2.0 * last + before) * 1e6);
    most_speed = std::max(most_speed, std::fabs(now - last) * 1e3);
    oldest = before;
    before = last;
    last = now;
  }
  void step() { take(trajectory.rt_step(Q24::from_double(kAcceleration)).to_double()); }
  void run() {
    for (int i = 0; i < 20'000 && !trajectory.finished(); ++i) {
      step();
    }
    EXPECT_TRUE(trajectory.finished());
  }
  Trajectory trajectory;
  double last, before, oldest;
  double most_jerk = 0.0, most_acceleration = 0.0, most_speed = 0.0;
};
// Positions are rounded to 2^-24 rad: four of them are in a third difference.
constexpr double kRoundingOfJerk = 4.0 * 1e9 / 16777216.0;

TEST(TrajectoryJerk, MovesKeepJerkAccelerationAndSpeedAndEndExactlyOnTheTarget) {
  for (const double jerk : {0.7, 1.0, 2.5, 5.0}) {
    for (const double target : {1.0, -0.3, 0.001, 1e-6}) {
      Soft soft(jerk);
      soft.trajectory.rt_start(Q24::from_double(target), Q24::from_double(1.5));
      soft.run();
      EXPECT_EQ(Q24::from_double(soft.last), Q24::from_double(target));
      EXPECT_LE(soft.most_jerk, jerk * 1e3 + kRoundingOfJerk) << jerk << " to " << target;
      EXPECT_LE(soft.most_acceleration, kAcceleration + 0.3);
      EXPECT_LE(soft.most_speed, 1.5 + 1e-3);
    }
  }
}

TEST(TrajectoryJerk, TheUsualSettingIsTheJerkOfOneCycle) {
  Soft soft(120.0);
  soft.trajectory.rt_start(Q24::from_double(0.2), Q24::from_double(10.0));
  soft.run();
  EXPECT_NEAR(soft.most_jerk, 20e3, 600.0) << "from +10 to -10 rad/s2 within 1 ms";
}

TEST(TrajectoryJerk, StopAndNewTargetsOnTheWayKeepItToo) {
  Soft soft(1.0);
  soft.trajectory.rt_start(Q24::from_double(2.0), Q24::from_double(2.0));
  for (int i = 0; i < 350; ++i) {
    soft.step();
  }
  soft.trajectory.rt_start(Q24::from_double(-1.0), Q24::from_double(2.0));
  for (int i = 0; i < 300; ++i) {
    soft.step();
  }
  soft.trajectory.rt_stop(Q24::from_double(kAcceleration));
  soft.run();
  EXPECT_LE(soft.most_jerk, 1e3 + kRoundingOfJerk);
}

TEST(TrajectoryJerk, AfterAStreamTheReferenceGoesOnFromWhereItWasAndEndsOnTheTarget) {
  for (const double speed : {0.8, 0.0}) {
    Soft soft(1.0);
    for (int i = 1; i <= 300; ++i) {
      const double to = std::min(i, 200) * 1e-3;  // it gets to 0.8 rad/s within 0.2 s, stays there or brakes likewise
      const double rest = std::max(i - 200, 0) * 1e-3;
      const double now = 2.0 * to * to + (speed > 0.0 ? 0.8 * rest : 0.8 * rest - 4.0 * rest * rest);
      soft.trajectory.rt_stream(Q24::from_double(now), 1, Q24{});
      soft.take(soft.trajectory.rt_follow(soft_limits(1.0)).to_double());
    }
    for (int i = 0; i < 2; ++i) {  // speed 0: it stands now
      soft.take(soft.trajectory.rt_follow(soft_limits(1.0)).to_double());
    }
    const double at = soft.last;
    soft.trajectory.rt_start(Q24::from_double(0.5), Q24::from_double(1.0));
    soft.step();
    EXPECT_NEAR(soft.last - at, speed * 1e-3, 0.3e-3) << "no jump, and the speed that it had";
    soft.run();
    EXPECT_EQ(Q24::from_double(soft.last), Q24::from_double(0.5));
  }
}

}  // namespace
}  // namespace capstan
