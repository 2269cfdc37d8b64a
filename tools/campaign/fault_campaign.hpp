// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "capstan/tools/campaign/rig.hpp"

namespace capstan::tools {

enum class Outcome : std::uint8_t {
  kFaulted,     ///< detected, torque off within two cycles, latched
  kBlocked,     ///< detected at rest, and arming was refused
  kTolerated,   ///< no fault, and the true joint went no further than the limits of a hazard
  kMechanical,  ///< beyond those limits, but so is the joint whose torque is cut at the onset, and further than that
                ///< one by no more than limits.fault_travel
  kUnsafe,      ///< none of these
};

/// One fault in one situation: the worst over the phases of the motion.
struct CampaignRow {
  Joint joint{};
  Situation situation{};
  Trouble trouble;
  Outcome outcome = Outcome::kUnsafe;
  int cases = 0;
  int unsafe = 0;
  int unavoidable = 0;  ///< of the unsafe: with the torque cut at the onset the joint goes beyond a limit too
  int mechanical = 0;
  int worst_phase = 0;
  Hazard hazard;                 ///< largest of each over the phases
  double severity = 0.0;         ///< largest over the phases
  double unavoidable_rad = 0.0;  ///< where a limit was passed: travel with the torque cut at the onset
  Fault fault = Fault::kNone;    ///< in the worst phase
  State end = State::kDisarmed;
  int detected_ms = -1;  ///< longest
  int off_after_cycles = -1;
};

/// How much of the campaign: the short one is part of the checks.
enum class Extent : std::uint8_t { kShort, kLong };

struct Campaign {
  std::vector<CampaignRow> single;
  std::vector<CampaignRow> pairs;  ///< two faults, 50 ms apart
};

/// Every input in every mode in every situation: the firmware in closed loop with the simulated joint, beside a twin
/// without the fault. On `threads` threads; the result does not depend on their number.
[[nodiscard]] auto run_fault_campaign(Extent extent, int threads = 2) -> Campaign;
/// The same machine without any fault, judged against itself: what the numbers are to be compared with.
[[nodiscard]] auto run_without_fault(Joint joint, Situation situation) -> CampaignRow;

[[nodiscard]] auto hazard_limits(const AxisConfig& config) -> HazardLimits;
[[nodiscard]] auto name(Outcome outcome) -> const char*;
[[nodiscard]] auto name(const Trouble& trouble) -> std::string;

}  // namespace capstan::tools
