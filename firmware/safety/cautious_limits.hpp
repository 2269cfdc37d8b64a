// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "capstan/firmware/parameters/config.hpp"

namespace capstan {

/// What a joint keeps to whose motor observer is not commissioned, so that nothing finds a sensor that lies: a quarter
/// of the speed, and a thirtieth of the peak current as the largest change in a cycle. Not less current: what breaks a
/// joint's friction away may be nearly all of it.
constexpr auto cautious_limits(LimitConfig limits) -> LimitConfig {
  constexpr Q24 kQuarter = Q24::from_double(0.25);
  constexpr Q24 kThirtieth = Q24::from_double(1.0 / 30.0);
  limits.joint_speed_rad_s = limits.joint_speed_rad_s * kQuarter;
  limits.current_rate_a_per_cycle = std::min(limits.current_rate_a_per_cycle, limits.current_a * kThirtieth);
  return limits;
}

}  // namespace capstan
