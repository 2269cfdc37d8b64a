// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools::test {

/// What moves the motor.
enum class Motion { kMultisine, kLadder, kSine };

/// What the joint has beyond friction and elasticity. The first five are in the catalogue, the others are in no list.
enum class Truth {
  kNone,
  kViscous,
  kPretension,
  kPlay,
  kDelay,
  kAngleRipple,
  kTorqueRipple,
  kCreep,
  kHardening,
  kPresliding,
  kStickySpot,
  kDrift,
  kCoulomb,
};
auto truth_name(Truth truth) -> std::string;

struct SyntheticRequest {
  Truth truth = Truth::kNone;
  Motion motion = Motion::kLadder;
  double strength = 1.0;  ///< of the effect, 1: clearly visible
  double rate_hz = 200.0;
  double cycle_s = 40.0;
  int cycles = 4;
  double noise_rad = 0.001;   ///< of the joint sensor, standard deviation
  double noise_memory = 0.9;  ///< autocorrelation of half of the noise at 100 Hz; the other half is white
  double counts_per_turn = 40960.0;
  std::uint64_t seed = 1;
};

/// A log of a joint made up for tests, with its own motion, friction, play, delay and noise, and exact knowledge of the
/// direction: it shares no code with the laws, and its direction and rates are those of the formula, not of a filter.
auto synthetic_log(const SyntheticRequest& request) -> AxisLog;

/// The same as text of a log file by the contract.
auto log_text(const AxisLog& log) -> std::string;

}  // namespace capstan::tools::test
