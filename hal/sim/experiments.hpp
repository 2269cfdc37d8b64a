// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/hal/sim/motion.hpp"

namespace capstan::sim {

/// What the ladders have in common.
struct LadderShape {
  double amplitude_rad = 0.0;
  double offset_rad = 0.0;
  double corner_s = 0.05;
  int cycles = 2;  ///< of each rung
};

/// One sine after the other. Throws std::invalid_argument with "sentence; cure", as all here.
[[nodiscard]] std::vector<Segment> sine_ladder(const LadderShape& shape, const std::vector<double>& frequencies_hz);

/// To and fro at one constant speed after the other.
[[nodiscard]] std::vector<Segment> speed_ladder(const LadderShape& shape, const std::vector<double>& speeds_rad_per_s);

/// First-order reversals: from -amplitude up to one of `levels` equally spaced angles and back, lowest first.
[[nodiscard]] std::vector<Segment> reversal_staircase(const LadderShape& shape, int levels, double speed_rad_per_s);

}  // namespace capstan::sim
