// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/control/trajectory.hpp"

#include <algorithm>

namespace capstan {
namespace {

constexpr std::int64_t kUnits = std::int64_t{kCycleRateHz} * kCycleRateHz;

auto position_of(Q24 angle_rad) -> std::int64_t {
  return angle_rad.raw() * kUnits;
}
auto speed_of(Q24 speed_rad_s) -> std::int64_t {
  return std::int64_t{speed_rad_s.raw()} * kCycleRateHz;
}
auto step_of(Q24 acceleration_rad_s2) -> std::int64_t {
  return std::max<std::int64_t>(acceleration_rad_s2.raw(), 1);
}

auto angle_of(std::int64_t position) -> Q24 {
  const std::int64_t shifted = position + kUnits / 2;
  const std::int64_t quotient = shifted / kUnits;
  return Q24::from_wide(quotient * kUnits > shifted ? quotient - 1 : quotient);
}

/// What is still travelled while the speed falls by `step` in every cycle: speed - step, speed - 2 step, ... above
/// zero.
auto braking_distance(std::int64_t speed, std::int64_t step) -> std::int64_t {
  constexpr std::int64_t kForever = std::int64_t{1} << 61;
  constexpr std::int64_t kMostCycles = 4'000'000;  // over an hour, and n * speed below still fits
  const std::int64_t n = speed / step;
  return n > kMostCycles ? kForever : n * speed - step * (n * (n + 1) / 2);
}

/// The next speed towards a target `distance` >= 0 ahead: the fastest from which it can still be reached without
/// passing it.
auto next_speed(std::int64_t speed, std::int64_t distance, std::int64_t limit, std::int64_t step) -> std::int64_t {
  if (distance <= std::min(limit, step) && std::abs(distance - speed) <= step) {
    return distance;  // lands on it now and can stand in the next cycle
  }
  const std::int64_t faster = std::clamp(limit, speed - step, speed + step);
  const std::int64_t same = std::min(std::max<std::int64_t>(speed, 0), faster);
  if (faster <= 0 || faster + braking_distance(faster, step) <= distance) {
    return faster;
  }
  // The same question again would cost the same long division.
  if (same != faster && (same <= 0 || same + braking_distance(same, step) <= distance)) {
    return same;
  }
  return speed - step;
}

}  // namespace

auto Trajectory::can_keep(const LimitConfig& limits) -> bool {
  return std::int64_t{limits.joint_jerk_krad_s3.raw()} * kMostCycles >=
         2 * std::int64_t{limits.joint_acceleration_rad_s2.raw()};
}

void Trajectory::rt_configure(const LimitConfig& limits) {
  const std::int64_t step = 2 * std::int64_t{limits.joint_acceleration_rad_s2.raw()};  // in units of a millisecond
  std::uint8_t doublings = 0;
  while ((std::int64_t{limits.joint_jerk_krad_s3.raw()} << doublings) < step && (1 << doublings) < kMostCycles) {
    ++doublings;
  }
  if (doublings != doublings_) {
    doublings_ = doublings;
    rt_reset(angle_of(position_) + ahead_);
  }
}

void Trajectory::rt_reset(Q24 position_rad) {
  position_ = position_of(position_rad);
  target_ = position_;
  speed_ = 0;
  rest_ = position_rad;
  ahead_ = Q24{};
  sum_ = std::int64_t{position_rad.raw()} << doublings_;
  taken_ = to_settle_ = 0;
}

auto Trajectory::rt_mean(Q24 position) -> Q24 {
  if (doublings_ == 0) {
    return position;
  }
  const unsigned length = 1U << doublings_;
  next_ = static_cast<std::uint8_t>((next_ + 1U) & (length - 1));
  const bool all = taken_ == length;
  sum_ += position.raw() - (all ? past_[next_] : rest_).raw();
  past_[next_] = position;
  taken_ = static_cast<std::uint8_t>(all ? taken_ : taken_ + 1);
  return Q24::from_wide((sum_ + (length >> 1U)) >> doublings_);
}

void Trajectory::rt_track(Q24 position_rad) {
  const std::int64_t next = position_of(position_rad);
  if (next == position_) {  // it stands, so what follows begins at rest
    rt_reset(position_rad);
    return;
  }
  speed_ = next - position_;
  speed_limit_ = std::abs(speed_);
  position_ = next;
  target_ = next;
  ahead_ = position_rad - rt_mean(position_rad);
  to_settle_ = static_cast<std::uint8_t>((1U << doublings_) - 1);
}

void Trajectory::rt_start(Q24 target_rad, Q24 speed_rad_s) {
  target_ = position_of(target_rad - ahead_);
  speed_limit_ = speed_of(speed_rad_s);
}

void Trajectory::rt_stop(Q24 acceleration_rad_s2) {
  const std::int64_t distance = braking_distance(std::abs(speed_), step_of(acceleration_rad_s2));
  target_ = speed_ < 0 ? position_ - distance : position_ + distance;
}

auto Trajectory::rt_step(Q24 acceleration_rad_s2) -> Q24 {
  const std::int64_t step = step_of(acceleration_rad_s2);
  const std::int64_t to_go = target_ - position_;
  const std::int64_t sign = to_go < 0 ? -1 : 1;
  speed_ = sign * next_speed(sign * speed_, sign * to_go, speed_limit_, step);
  position_ += speed_;
  to_settle_ = static_cast<std::uint8_t>(speed_ != 0 ? 1U << doublings_ : to_settle_ - (to_settle_ > 0 ? 1U : 0U));
  return rt_mean(angle_of(position_)) + ahead_;
}

}  // namespace capstan
