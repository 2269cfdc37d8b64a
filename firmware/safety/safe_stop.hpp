// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "capstan/firmware/safety/faults.hpp"

namespace capstan {

/// How a joint is stopped. Torque goes off within two cycles in every case; what else is done, where torque off alone
/// would let the joint run or fall, is decided here and nowhere else. Numbers are append-only.
enum class SafeStop : std::uint8_t {
  kTorqueOff,        ///< the transmission's own friction
  kBrake,            ///< mechanical, closed by its spring when its line falls
  kShortedPhases,    ///< the motor as its own brake
  kOpposingCurrent,  ///< against the motion, ruled by the encoder
};

/// What a board has, beside taking torque away.
struct StopMeans {
  bool brake = false;
  bool shorted_phases = false;
  bool opposing_current = false;
};

/// What can still be relied on after a fault.
struct StopRow {
  Fault fault;
  bool drive;  ///< the amplifier obeys and has its supply: it can short the phases
  bool loop;   ///< encoder, current and the cycle's time are right too: current can oppose the motion
};

/// One row a fault, in their order.
inline constexpr std::array<StopRow, kFaultTable.size()> kStopTable = {{
    {Fault::kNone, true, true},           {Fault::kOverrun, true, false},
    {Fault::kSensorMissing, true, false}, {Fault::kSensorInvalid, true, false},
    {Fault::kEncoderJump, true, false},   {Fault::kFollowingError, true, true},
    {Fault::kOverCurrent, false, false},  {Fault::kEstimatorRange, true, true},   // the motor's own angle is right
    {Fault::kLinkLost, true, true},       {Fault::kEmergencyStop, false, false},  // its hardware has cut the supply
    {Fault::kModelInvalid, true, false},                                          // the encoder's sign is a parameter
    {Fault::kDriveFailed, false, false},  {Fault::kBoardClock, true, false},
    {Fault::kEncoderFrozen, true, false}, {Fault::kCurrentMismatch, false, false},
    {Fault::kWindingHot, true, false},  // more current is what it must not have
    {Fault::kStorageFailed, true, false}, {Fault::kSupplyLow, false, false},
    {Fault::kWatchdog, false, false},                                         // nothing is known of before
    {Fault::kEncoderMotion, true, false}, {Fault::kLimitCycle, true, false},  // what swings is the loop
    {Fault::kOverspeed, true, false},                                         // the loop runs away, or the encoder lies
}};

constexpr auto stop_table_is_in_order() -> bool {
  for (std::size_t i = 0; i < kStopTable.size(); ++i) {
    if (kStopTable[i].fault != kFaultTable[i].code || (kStopTable[i].loop && !kStopTable[i].drive)) {
      return false;
    }
  }
  return true;
}
static_assert(stop_table_is_in_order());

/// The best of what the board has that every fault of the set leaves to be relied on.
constexpr auto safe_stop(FaultSet faults, StopMeans means) -> SafeStop {
  bool drive = true;
  bool loop = true;
  for (const StopRow& row : kStopTable) {
    const bool present = (faults & bit(row.fault)) != 0;
    drive = drive && (!present || row.drive);
    loop = loop && (!present || row.loop);
  }
  if (means.brake) {
    return SafeStop::kBrake;  // needs nothing that can have failed
  }
  if (means.shorted_phases && drive) {
    return SafeStop::kShortedPhases;
  }
  return means.opposing_current && loop ? SafeStop::kOpposingCurrent : SafeStop::kTorqueOff;
}

constexpr auto name(SafeStop stop) -> const char* {
  constexpr std::array kNames = {"torque off", "torque off and brake", "shorted phases", "opposing current"};
  return kNames[static_cast<std::size_t>(stop)];
}

}  // namespace capstan
