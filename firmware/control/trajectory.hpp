// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "capstan/firmware/parameters/config.hpp"

namespace capstan {

/// A point-to-point move with limited speed, acceleration and jerk; one call a cycle. The reference ends exactly on the
/// target and never passes it, unless a new target lies closer than can be braked. Limits are those of the parameter
/// table: acceleration and jerk above zero.
///
/// Speed and acceleration: a trapezoid of speed. Jerk: the mean of its last N positions, which keeps the trapezoid's
/// bounds, ends on the same target N cycles later, and turns a step of the acceleration, at most twice the largest one
/// a, into a ramp of N cycles: |jerk| <= 2 a / (N dt), so N is the power of two that is enough. One cycle is no mean.
class Trajectory {
 public:
  /// The longest mean.
  static constexpr std::int32_t kMostCycles = 32;
  /// False: the jerk is lower than the longest mean can keep at this acceleration.
  static auto can_keep(const LimitConfig& limits) -> bool;

  /// New limits of jerk. If they change the mean's length, what moves stands at once: no torque then.
  void rt_configure(const LimitConfig& limits);
  /// Stands still at a position, rad.
  void rt_reset(Q24 position_rad);
  /// A streamed reference has come, rad, `interval` cycles after the last one; in as many cycles rt_follow goes there.
  /// @param from_rad  the reference of the last cycle, where this is the first of a stream
  void rt_stream(Q24 position_rad, std::int32_t interval, Q24 from_rad);
  /// Advances by one cycle along the stream and returns the reference, rad: the stream itself as long as it keeps
  /// limits.joint_speed and joint_acceleration and can still stand before joint_min and joint_max, else what comes
  /// nearest to it within them. A stream is not averaged. A move or a stop after it begins with the speed that it has.
  auto rt_follow(const LimitConfig& limits) -> Q24;
  /// The last rt_follow returned the stream itself.
  [[nodiscard]] auto on_stream() const -> bool { return on_stream_; }
  /// Heads for a target, rad, from wherever it is, at no more than the given speed, rad/s.
  void rt_start(Q24 target_rad, Q24 speed_rad_s);
  /// Brakes and stays where that ends.
  void rt_stop(Q24 acceleration_rad_s2);
  /// Advances by one cycle and returns the reference, rad.
  auto rt_step(Q24 acceleration_rad_s2) -> Q24;
  /// True from the cycle after the one that landed on the target: the landing itself still had speed.
  [[nodiscard]] auto finished() const -> bool { return position_ == target_ && speed_ == 0 && to_settle_ == 0; }

 private:
  /// The next speed that rt_follow may have, where the stream's own, to_go in a cycle, is not within the limits.
  [[nodiscard]] auto rt_pursue(const LimitConfig& limits, std::int64_t to_go, std::int64_t along) const -> std::int64_t;
  /// `speed`, or less of it where the joint's range ends too near.
  [[nodiscard]] auto rt_before_end(const LimitConfig& limits, std::int64_t speed) const -> std::int64_t;
  /// Takes one more position into the mean and returns it.
  auto rt_mean(Q24 position) -> Q24;

  // In units of 2^-24 rad / kCycleRateHz^2. In them a cycle's change of speed, rad/s2, and a cycle's travel, rad/s, are
  // whole numbers, so nothing is rounded on the way and braking ends exactly where it was computed to end.
  std::int64_t position_ = 0;
  std::int64_t target_ = 0;
  std::int64_t speed_ = 0;  // a cycle
  std::int64_t speed_limit_ = 0;

  std::array<Q24, kMostCycles> past_{};
  std::int64_t sum_ = 0;  // of the last 2^doublings_ of them
  Q24 rest_;              // where it stood before the oldest that is there
  Q24 ahead_;             // of the mean: a stream is not averaged, and what follows goes on from where it was
  std::uint8_t doublings_ = 0;
  std::uint8_t next_ = 0;
  std::uint8_t taken_ = 0;      // of past_, since it stood
  std::uint8_t to_settle_ = 0;  // cycles until the mean stands too

  bool streaming_ = false;
  bool on_stream_ = false;
  std::uint8_t stream_cycles_ = 0;  // that are left until stream_end_
  Q24 stream_at_;
  Q24 stream_end_;
};

}  // namespace capstan
