// SPDX-License-Identifier: Apache-2.0
// Trajectory::rt_follow: a stream of references within the limits passes as it is, any other one is brought within
// them.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdlib>

#include "capstan/firmware/control/trajectory.hpp"

namespace capstan {
namespace {

// Of kDefaultAxis: 2 rad/s and 10 rad/s2 between -2 and 2 rad, in 2^-24 rad a cycle, rounded up.
constexpr std::int64_t kFastest = 33'555;
constexpr std::int64_t kMostBent = 168;
// A second difference of three rounded positions, and of a rounded stream that is taken as it is.
constexpr std::int64_t kRounding = 6;

struct Stream {
  explicit Stream(double start = 0.0) {
    trajectory.rt_reset(Q24::from_double(start));
    last = raw(start);
  }
  static auto raw(double angle) -> std::int64_t { return Q24::from_double(angle).raw(); }
  auto step() -> double {
    const Q24 now = trajectory.rt_follow(limits);
    const std::int64_t moved = now.raw() - last;
    most_speed = std::max(most_speed, std::abs(moved));
    most_bend = std::max(most_bend, std::abs(moved - speed));
    lowest = std::min<std::int64_t>(lowest, now.raw());
    highest = std::max<std::int64_t>(highest, now.raw());
    speed = moved;
    last = now.raw();
    return now.to_double();
  }
  auto send(double angle, int interval = 1) -> double {
    trajectory.rt_stream(Q24::from_double(angle), interval, Q24::from_raw(static_cast<std::int32_t>(last)));
    return step();
  }
  [[nodiscard]] auto kept() const -> bool {
    return most_speed <= kFastest && most_bend <= kMostBent + kRounding && lowest >= limits.joint_min_rad.raw() &&
           highest <= limits.joint_max_rad.raw();
  }
  LimitConfig limits;
  Trajectory trajectory;
  std::int64_t last = 0;
  std::int64_t speed = 0;
  std::int64_t most_speed = 0;
  std::int64_t most_bend = 0;
  std::int64_t lowest = 0;
  std::int64_t highest = 0;
};

TEST(Stream, WithinTheLimitsPassesToTheLastBit) {
  Stream stream;
  for (int i = 0; i < 4000; ++i) {  // 1.6 rad/s at most, and 9 rad/s2
    const double angle = 0.28 * (1.0 - std::cos(5.65e-3 * i));
    ASSERT_EQ(stream.send(angle), Q24::from_double(angle).to_double()) << i;
    ASSERT_TRUE(stream.trajectory.on_stream());
  }
}

TEST(Stream, OfStepsGetsThereWithinSpeedAndAcceleration) {
  Stream stream;
  for (int i = 0; i < 4000; ++i) {
    const double angle = 0.05 * std::round(0.3 * std::sin(3.14e-3 * i) / 0.05);
    const double now = stream.send(angle);
    ASSERT_NEAR(now, angle, 0.1) << i;
  }
  EXPECT_TRUE(stream.kept());
  for (int i = 0; i < 300; ++i) {
    static_cast<void>(stream.send(-0.5));
  }
  EXPECT_NE(stream.last, Stream::raw(-0.5)) << "0.5 rad take 0.45 s at 10 rad/s2";
  for (int i = 0; i < 300; ++i) {
    static_cast<void>(stream.send(-0.5));
  }
  EXPECT_EQ(stream.last, Stream::raw(-0.5));
  EXPECT_TRUE(stream.kept());
}

TEST(Stream, ThatIsAlreadyRunningIsCaughtUpWithAndThenPassesAsItIs) {
  Stream stream;
  int late = 0;
  for (int i = 0; i < 1000; ++i) {
    static_cast<void>(stream.send(1e-3 * i));
    late += stream.trajectory.on_stream() ? 0 : 1;
  }
  EXPECT_TRUE(stream.kept());
  EXPECT_TRUE(stream.trajectory.on_stream());
  EXPECT_EQ(stream.last, Stream::raw(0.999));
  // 0.1 s to its speed, 0.05 rad behind; to make up for them at 10 rad/s2 takes 2 sqrt(0.05 / 10) s more.
  EXPECT_NEAR(late, 241, 10);
}

TEST(Stream, InSparseStepsIsFollowedEvenlyOneIntervalLater) {
  Stream stream;
  double now = 0.0;
  for (int i = 0; i < 1500; ++i) {  // every 10 ms, at 0.5 rad/s
    const double before = now;
    now = i % 10 == 0 ? stream.send(0.5e-3 * i, 10) : stream.step();
    if (i > 600) {
      ASSERT_NEAR(now - before, 0.5e-3, 1e-6) << i;
      ASSERT_NEAR(now, 0.5e-3 * (i - 9), 1e-6) << i;
    }
  }
  EXPECT_TRUE(stream.kept());
}

TEST(Stream, ThatEndsAtFullSpeedStandsWithoutTurningRoundFar) {
  Stream stream;
  for (int i = 0; i < 1000; ++i) {
    static_cast<void>(stream.send(1e-3 * i));
  }
  double most = 0.0;
  for (int i = 0; i < 500; ++i) {
    most = std::max(most, stream.send(0.999));
  }
  EXPECT_EQ(stream.last, Stream::raw(0.999));
  EXPECT_LE(most, 0.999 + 0.0511) << "v^2 / 2a";
  EXPECT_TRUE(stream.kept());
}

TEST(Stream, ThatRunsIntoTheEndOfTheRangeBrakesBeforeIt) {
  for (const double side : {1.0, -1.0}) {
    Stream stream;
    for (int i = 0; i < 1500; ++i) {
      static_cast<void>(stream.send(side * std::min(2.0, 1.9e-3 * i)));
    }
    EXPECT_TRUE(stream.kept());
    EXPECT_EQ(stream.last, Stream::raw(2.0 * side));
  }
}

TEST(Stream, AStopInAnyPlaceStaysWithinTheRange) {
  for (int cycles = 100; cycles < 1400; cycles += 50) {
    Stream stream;
    for (int i = 0; i < cycles; ++i) {
      static_cast<void>(stream.send(std::min(2.0, 1.9e-3 * i)));
    }
    stream.trajectory.rt_stop(stream.limits.joint_acceleration_rad_s2);
    Q24 at;
    for (int i = 0; i < 1000 && !stream.trajectory.finished(); ++i) {
      at = stream.trajectory.rt_step(stream.limits.joint_acceleration_rad_s2);
    }
    EXPECT_LE(at, Q24::from_double(2.0)) << cycles;
  }
}

RC_GTEST_PROP(Stream, WhateverComesTheReferenceKeepsSpeedAccelerationAndRange, ()) {
  Stream stream;
  const int parts = *rc::gen::inRange(1, 8);
  for (int part = 0; part < parts; ++part) {
    const auto kind = *rc::gen::inRange(0, 4);
    const double reach = 0.001 * *rc::gen::inRange(1, 2001);
    const double hz = 0.1 * *rc::gen::inRange(1, 300);
    const int interval = *rc::gen::inRange(1, 100);
    const auto seed = *rc::gen::inRange<std::uint32_t>(1, 1'000'000);
    std::uint32_t noise = seed;
    for (int i = 0; i < 700; ++i) {
      noise = noise * 1664525U + 1013904223U;
      const double random = reach * (static_cast<double>(noise >> 8U) / 8388608.0 - 1.0);
      const double sine = reach * std::sin(6.2832e-3 * hz * i);
      const double square = sine > 0.0 ? reach : -reach;
      const double wild = kind == 0 ? random : kind == 1 ? sine : kind == 2 ? square : std::min(2.0, 1e-3 * reach * i);
      if (i % interval == 0) {
        static_cast<void>(stream.send(wild, interval));
      } else {
        static_cast<void>(stream.step());
      }
      RC_ASSERT(stream.kept());
    }
  }
}

}  // namespace
}  // namespace capstan
