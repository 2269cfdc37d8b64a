// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ostream>
#include <vector>

#include "capstan/firmware/safety/faults.hpp"

namespace capstan::tools {

/// A stop that nothing was the reason for, and what would make it again.
struct FalseStop {
  std::uint64_t seed = 0;
  double time_s = 0.0;
  Fault fault = Fault::kNone;
};

struct FalseAlarms {
  double hours = 0.0;  ///< simulated, under torque
  int plants = 0;
  std::vector<FalseStop> stops;
};

/// Healthy joints drawn at random (inertia, friction, stiffness, pretension, gains, load, contact with tissue, tremor
/// of the hand, blows to the tip), each for five minutes of random moves and streams. Every joint is commissioned
/// first: its observer's values come from the shell's own `commission`. On `threads` threads; the result does not
/// depend on their number.
[[nodiscard]] auto run_false_alarms(double hours, std::uint64_t seed, int threads = 2) -> FalseAlarms;
void print_false_alarms(std::ostream& out, const FalseAlarms& alarms);

}  // namespace capstan::tools
