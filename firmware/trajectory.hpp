// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "firmware/config.hpp"

namespace capstan {

/// A point-to-point move of one joint with limited speed and acceleration; one call a cycle. The reference ends exactly
/// on the target and never passes it, unless a new target lies closer than the joint can brake. Limits are those of the
/// parameter table: acceleration above zero.
class Trajectory {
 public:
  /// Stands still at a position, rad.
  void rt_reset(Q24 position_rad);
  /// Goes along with a streamed reference, rad, of this cycle: what follows begins with the speed that it has.
  void rt_track(Q24 position_rad);
  /// Heads for a target, rad, from wherever it is, at no more than the given speed, rad/s.
  void rt_start(Q24 target_rad, Q24 speed_rad_s);
  /// Brakes and stays where that ends.
  void rt_stop(const LimitConfig& limits);
  /// Advances by one cycle and returns the reference, rad.
  auto rt_step(const LimitConfig& limits) -> Q24;
  /// True from the cycle after the one that landed on the target: the landing itself still had speed.
  [[nodiscard]] auto finished() const -> bool { return position_ == target_ && speed_ == 0; }

 private:
  // In units of 2^-24 rad / kCycleRateHz^2. In them a cycle's change of speed, rad/s2, and a cycle's travel, rad/s, are
  // whole numbers, so nothing is rounded on the way and braking ends exactly where it was computed to end.
  std::int64_t position_ = 0;
  std::int64_t target_ = 0;
  std::int64_t speed_ = 0;  // a cycle
  std::int64_t speed_limit_ = 0;
};

}  // namespace capstan
