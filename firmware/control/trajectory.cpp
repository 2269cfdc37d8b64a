// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/control/trajectory.hpp"

#include <algorithm>

namespace capstan {
namespace {

// A stream is followed as it comes up to this many milliseconds between two of its references, which is the delay that
// costs; one that comes more rarely makes a step now and then.
constexpr std::int32_t kMostInterval = 20;

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
/// x with its sign turned where the way goes back; turned again it is what it was.
auto turned(bool back, std::int64_t x) -> std::int64_t {
  return back ? -x : x;
}

/// Nearest angle, without the long division: a product that is too small by less than twelve, and a short division of
/// what is left. Beyond twice the range of an angle it saturates as well.
constexpr auto angle_of(std::int64_t position) -> Q24 {
  static_assert(kUnits == 64 * 15'625);
  constexpr std::int32_t kPerUnit = 1'125'899'906;  // 2^44 / 15625
  const std::int64_t shifted = (position + kUnits / 2) >> 6;
  const auto upper = narrow_saturating<std::int64_t, std::int32_t>(shifted >> 15);
  const std::int64_t least = (wide_product(upper, kPerUnit) >> 29) - 4;
  const std::uint32_t rest = static_cast<std::uint32_t>(shifted) - static_cast<std::uint32_t>(least) * 15'625U;
  return Q24::from_wide(least + rest / 15'625U);
}
constexpr auto is_nearest(std::int64_t raw) -> bool {
  const std::int64_t middle = raw * kUnits;
  return angle_of(middle - kUnits / 2).raw() == raw && angle_of(middle).raw() == raw &&
         angle_of(middle + kUnits / 2 - 1).raw() == raw;
}
static_assert(is_nearest(0) && is_nearest(1) && is_nearest(-1) && is_nearest(12'345'678) && is_nearest(-12'345'679) &&
              is_nearest(Q24::max().raw() - 1) && is_nearest(Q24::lowest().raw() + 1));
static_assert(angle_of(std::int64_t{1} << 61) == Q24::max() && angle_of(-(std::int64_t{1} << 61)) == Q24::lowest());

constexpr std::int64_t kMostBraking = 4'000'000;  // cycles: over an hour, and n * speed below still fits

/// What is still travelled while the speed falls by `step` in every cycle: speed - step, speed - 2 step, ... above
/// zero.
auto braking_distance(std::int64_t speed, std::int64_t step) -> std::int64_t {
  constexpr std::int64_t kForever = std::int64_t{1} << 61;
  const std::int64_t n = speed / step;
  return n > kMostBraking ? kForever : n * speed - step * (n * (n + 1) / 2);
}

/// Whether v + v^2 / 2a <= distance, which is further than braking takes; not told where it is close. Without the
/// division.
auto surely_stops_within(std::int64_t speed, std::int64_t distance, std::int64_t step) -> bool {
  const std::int64_t upper = (speed >> 12) + 1;  // and so its square is no smaller than that of the speed
  const std::int64_t left = (distance - speed) >> 23;
  constexpr std::int64_t kMost = Q24::max().raw();
  return left > 0 && upper <= kMost && speed <= step * kMostBraking &&
         wide_product(static_cast<std::int32_t>(upper), static_cast<std::int32_t>(upper)) <=
             wide_product(static_cast<std::int32_t>(std::min(left, kMost)),
                          static_cast<std::int32_t>(std::min(step, kMost)));
}

/// The next speed towards a target `distance` >= 0 ahead: the fastest from which it can still be reached without
/// passing it.
auto next_speed(std::int64_t speed, std::int64_t distance, std::int64_t limit, std::int64_t step) -> std::int64_t {
  if (distance <= std::min(limit, step) && std::abs(distance - speed) <= step) {
    return distance;  // lands on it now and can stand in the next cycle
  }
  const std::int64_t faster = std::clamp(limit, speed - step, speed + step);
  const std::int64_t same = std::min(std::max<std::int64_t>(speed, 0), faster);
  if (faster <= 0 || surely_stops_within(faster, distance, step) ||
      faster + braking_distance(faster, step) <= distance) {
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
  streaming_ = false;
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

void Trajectory::rt_stream(Q24 position_rad, std::int32_t interval, Q24 from_rad) {
  if (!streaming_) {
    streaming_ = true;
    position_ = position_of(from_rad);
    stream_at_ = from_rad;
  }
  stream_end_ = position_rad;
  stream_cycles_ = static_cast<std::uint8_t>(std::clamp<std::int32_t>(interval, 1, kMostInterval));
}

auto Trajectory::rt_pursue(const LimitConfig& limits, std::int64_t to_go, std::int64_t along) const -> std::int64_t {
  const std::int64_t limit = speed_of(limits.joint_speed_rad_s);
  const std::int64_t step = step_of(limits.joint_acceleration_rad_s2);
  // Beside the stream, which runs on meanwhile.
  const std::int64_t stream = std::clamp(along, -limit, limit);
  const std::int64_t distance = to_go - stream;
  const bool back = distance < 0;
  const std::int64_t beside = next_speed(turned(back, speed_ - stream), std::abs(distance), 2 * limit, step);
  const std::int64_t speed = stream + turned(back, beside);
  return std::clamp(std::clamp(speed, -limit, limit), speed_ - step, speed_ + step);
}

auto Trajectory::rt_before_end(const LimitConfig& limits, std::int64_t speed) const -> std::int64_t {
  const bool back = speed < 0;
  const Q24 end = back ? limits.joint_min_rad : limits.joint_max_rad;
  const std::int64_t distance = std::max<std::int64_t>(turned(back, position_of(end) - position_), 0);
  // Far from it no division is needed: v^2 < 2 a d for the largest v.
  const std::int64_t raw =
      (distance - std::min(distance, 2 * std::abs(speed))) >> 20;  // of 2^-24 rad, and a little less
  if (wide_product(limits.joint_speed_rad_s.raw(), limits.joint_speed_rad_s.raw()) / 2 <
      raw * limits.joint_acceleration_rad_s2.raw()) {
    return speed;
  }
  const std::int64_t step = step_of(limits.joint_acceleration_rad_s2);
  const std::int64_t now = turned(back, speed_);
  const std::int64_t most = next_speed(now, distance, speed_of(limits.joint_speed_rad_s), step);
  return turned(back, std::min(std::abs(speed), std::max(most, now - step)));
}

auto Trajectory::rt_follow(const LimitConfig& limits) -> Q24 {
  // A stream is rounded, twice in a second difference.
  constexpr std::int64_t kRounding = 4 * kUnits;
  const Q24 before = stream_at_;
  if (stream_cycles_ > 0) {
    stream_at_ += stream_cycles_ == 1 ? stream_end_ - stream_at_
                                      : Q24::from_raw((stream_end_ - stream_at_).raw() / stream_cycles_);
    --stream_cycles_;
  }
  const std::int64_t to_go = position_of(stream_at_) - position_;
  const bool possible = std::abs(to_go) <= speed_of(limits.joint_speed_rad_s) &&
                        std::abs(to_go - speed_) <= step_of(limits.joint_acceleration_rad_s2) + kRounding;
  const std::int64_t along = position_of(stream_at_) - position_of(before);
  speed_ = rt_before_end(limits, possible ? to_go : rt_pursue(limits, to_go, along));
  on_stream_ = speed_ == to_go;
  position_ += speed_;
  target_ = position_;
  const Q24 reference = angle_of(position_);
  ahead_ = reference - rt_mean(reference);
  to_settle_ = static_cast<std::uint8_t>((1U << doublings_) - 1);
  if (speed_ == 0) {  // it stands, so what follows begins at rest
    rest_ = reference;
    ahead_ = Q24{};
    sum_ = std::int64_t{reference.raw()} << doublings_;
    taken_ = to_settle_ = 0;
  }
  return reference;
}

void Trajectory::rt_start(Q24 target_rad, Q24 speed_rad_s) {
  streaming_ = false;
  target_ = position_of(target_rad - ahead_);
  speed_limit_ = speed_of(speed_rad_s);
}

void Trajectory::rt_stop(Q24 acceleration_rad_s2) {
  streaming_ = false;
  const std::int64_t distance = braking_distance(std::abs(speed_), step_of(acceleration_rad_s2));
  target_ = speed_ < 0 ? position_ - distance : position_ + distance;
}

auto Trajectory::rt_step(Q24 acceleration_rad_s2) -> Q24 {
  const std::int64_t step = step_of(acceleration_rad_s2);
  const std::int64_t to_go = target_ - position_;
  const bool back = to_go < 0;
  speed_ = turned(back, next_speed(turned(back, speed_), std::abs(to_go), speed_limit_, step));
  position_ += speed_;
  to_settle_ = static_cast<std::uint8_t>(speed_ != 0 ? 1U << doublings_ : to_settle_ - (to_settle_ > 0 ? 1U : 0U));
  return rt_mean(angle_of(position_)) + ahead_;
}

}  // namespace capstan
