// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "firmware/supervisor.hpp"

namespace capstan::tools {

/// What the firmware depends on.
enum class Input : std::uint8_t { kEncoder, kCurrent, kAmplifier, kReference, kEmergencyStop, kClock, kSupply };
/// How it goes wrong, from a certain cycle on and for good.
enum class Mode : std::uint8_t { kOff, kStuck, kGarbage, kWrongSign, kSlow, kDelayed, kIntermittent, kNan };
/// What the machine was doing.
enum class Situation : std::uint8_t { kDisarmed, kHolding, kMoving, kFollowing, kExperiment, kFaulted };

enum class Outcome : std::uint8_t {
  kFaulted,    ///< detected, torque off, latched
  kBlocked,    ///< detected at rest, and arming was refused
  kTolerated,  ///< no fault: the joint went on, as near to its reference as the limits ask
  kUnsafe,     ///< none of these
};

struct CampaignRow {
  Input input{};
  Mode mode{};
  Situation situation{};
  const char* impossible = nullptr;  ///< why there is no such case, or nullptr
  Outcome outcome = Outcome::kUnsafe;
  State end = State::kDisarmed;
  Fault fault = Fault::kNone;  ///< what took the torque or blocks it
  int detected_ms = -1;        ///< after the onset; 1: in the first cycle that could see it
  int off_after_cycles = -1;   ///< from the detecting cycle to the first drive without torque; 0: in the same cycle
  double travel_rad = 0.0;     ///< of the true joint, from the onset to the end
  double error_rad = 0.0;      ///< largest distance of the true joint from its reference while there was torque
};

/// Every input in every mode in every situation: the firmware in closed loop with the simulated joint, 5 s after the
/// onset. A disarmed machine is armed and moved after one second, as an operator would.
[[nodiscard]] auto run_fault_campaign() -> std::vector<CampaignRow>;
/// The same machine without any fault: what the numbers are to be compared with.
[[nodiscard]] auto run_without_fault(Situation situation) -> CampaignRow;

[[nodiscard]] auto name(Input input) -> const char*;
[[nodiscard]] auto name(Mode mode) -> const char*;
[[nodiscard]] auto name(Situation situation) -> const char*;
[[nodiscard]] auto name(Outcome outcome) -> const char*;
/// One line for each row, and a summary with the longest detection of each fault.
void print_campaign(std::ostream& out, const std::vector<CampaignRow>& rows);

}  // namespace capstan::tools
