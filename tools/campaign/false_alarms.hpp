// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ostream>
#include <vector>

#include "capstan/firmware/safety/faults.hpp"

namespace capstan::tools {

/// A stop of a joint of which nothing is broken, and what would make it again.
struct Stop {
  std::uint64_t seed = 0;
  double time_s = 0.0;
  Fault fault = Fault::kNone;
  /// Of the true tip in the 100 ms before, a mean over 5 ms, over limits.joint_speed. From HazardLimits::speed_factor
  /// on the joint ran away from what it was asked all the same: its gains let it swing, or a tremor drove it.
  double speed_share = 0.0;
  /// Least distance of the true tip from the reference within limits.following_time before, over
  /// limits.following_error: above 1 something really held it.
  double following_share = 0.0;

  /// Whether the joint was where and as fast as it should be.
  [[nodiscard]] auto is_false() const -> bool;
};

struct FalseAlarms {
  double hours = 0.0;  ///< simulated, under torque
  int plants = 0;
  int not_commissioned = 0;  ///< of them: they did not run
  std::vector<Stop> stops;

  [[nodiscard]] auto false_stops() const -> int;
};

/// Gains of the drawn joints: drawn as well, so that some swing, or as `tune` finds them for the motor's inertia.
enum class Gains { kDrawn, kTuned };

/// Instruments that the joints are drawn about.
enum class Drawn { kForcepsAndFinger, kElbow, kWrist };

/// Healthy joints drawn at random (inertia, friction, stiffness, pretension, gains, load, contact with tissue, tremor
/// of the hand, blows to the tip), each for five minutes of random moves and streams. Every joint is commissioned
/// first: its observer's values come from the shell's own `commission`. On `threads` threads; the result does not
/// depend on their number.
[[nodiscard]] auto run_false_alarms(double hours, std::uint64_t seed, int threads = 2, Gains gains = Gains::kDrawn,
                                    Drawn drawn = Drawn::kForcepsAndFinger) -> FalseAlarms;
void print_false_alarms(std::ostream& out, const FalseAlarms& alarms);

}  // namespace capstan::tools
