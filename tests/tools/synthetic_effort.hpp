// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools::test {

/// What an axis asks for beyond inertia and viscous drag. Those up to kWarmUp are in the catalogue, the others are in
/// no list.
enum class EffortTruth {
  kNone,
  kCoulomb,
  kAsymmetry,  ///< with Coulomb's friction, as no axis has one without the other
  kStribeck,   ///< the same
  kSlack,      ///< dry friction behind a spring with a slack
  kBristle,    ///< dry friction behind a bristle
  kOffset,
  kGravity,
  kRipple,
  kDelay,
  kWarmUp,
  kQuadraticDrag,
  kHardSpring,
  kStickySpot,
  kRelaxation,
};
auto truth_name(EffortTruth truth) -> std::string;

struct EffortRequest {
  EffortTruth truth = EffortTruth::kNone;
  double strength = 1.0;  ///< of the effect, 1: clearly visible
  double rate_hz = 100.0;
  double cycle_s = 12.0;
  int cycles = 4;
  double noise_nm = 0.004;
  std::uint64_t seed = 1;
};

/// A log of a driven axis made up for tests: its motion is a formula with exact rates, its states are stepped finely,
/// and it shares no code with the laws.
auto synthetic_effort_log(const EffortRequest& request) -> AxisLog;

}  // namespace capstan::tools::test
