// SPDX-License-Identifier: Apache-2.0
#include "firmware/trajectory.hpp"

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
auto step_of(const LimitConfig& limits) -> std::int64_t {
  return std::max<std::int64_t>(limits.joint_acceleration_rad_s2.raw(), 1);
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
  for (const std::int64_t candidate : {faster, same}) {
    if (candidate <= 0 || candidate + braking_distance(candidate, step) <= distance) {
      return candidate;
    }
  }
  return speed - step;
}

}  // namespace

void Trajectory::rt_reset(Q24 position_rad) {
  position_ = position_of(position_rad);
  target_ = position_;
  speed_ = 0;
}

void Trajectory::rt_track(Q24 position_rad) {
  const std::int64_t next = position_of(position_rad);
  speed_ = next - position_;
  speed_limit_ = std::abs(speed_);
  position_ = next;
  target_ = next;
}

void Trajectory::rt_start(Q24 target_rad, Q24 speed_rad_s) {
  target_ = position_of(target_rad);
  speed_limit_ = speed_of(speed_rad_s);
}

void Trajectory::rt_stop(const LimitConfig& limits) {
  const std::int64_t distance = braking_distance(std::abs(speed_), step_of(limits));
  target_ = speed_ < 0 ? position_ - distance : position_ + distance;
}

auto Trajectory::rt_step(const LimitConfig& limits) -> Q24 {
  const std::int64_t step = step_of(limits);
  const std::int64_t to_go = target_ - position_;
  const std::int64_t sign = to_go < 0 ? -1 : 1;
  speed_ = sign * next_speed(sign * speed_, sign * to_go, speed_limit_, step);
  position_ += speed_;
  return angle_of(position_);
}

}  // namespace capstan
