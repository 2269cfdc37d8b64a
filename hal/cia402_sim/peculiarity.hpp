// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "capstan/hal/cia402_sim/object_dictionary.hpp"

namespace capstan::drive_sim {

/// What drives as they are sold have and do beside what CiA 301 and 402 make one expect. One is enough for a drive;
/// where they do not exclude each other a drive can have several.
enum class Peculiarity : std::uint8_t {
  kReversed,         ///< 607E is stored with positions reversed; torque is not
  kReversedForGood,  ///< and can not be written
  kTorqueOffset,     ///< 60B2 is stored with 30 %
  kOffsetForGood,    ///< and can not be written
  kMaxTorque,        ///< 6072 is stored with 5 %
  kNoMaxTorque,      ///< 6072 is 0 from the factory
  kOldPositions,     ///< positions are 20 ms old
  kOldStatus,        ///< statusword and positions are
  kFactoryPdos,      ///< PDOs are valid from the factory, with the identifiers of the predefined connection set
  kNo6007,           ///< no such object; without its master the drive takes its voltage off
  kGoesOn,           ///< no 6007, and without its master the drive goes on
  kNo605A,
  kNo605E,
  kNo60C2,
  kNo6061,
  kNo1016,  ///< nor does it miss its master
  kNo6075,
  kNo607E,
  kConstantOptions,  ///< 6007, 605A, 605E and 60C2 have the wanted values and can not be written
  kConstantPeriod,   ///< 60C2 is 2 ms and can not be written
  kQuickStop2Or6,    ///< 605A
  kFaultReaction2,   ///< 605E
  kHeartbeat100,     ///< 1016 takes no time below 100 ms
  kTwoObjects,       ///< in a PDO at most
  kSegmentedSdo,     ///< answers to reads come in segments
  kSlowSdo,          ///< answers come after 250 ms
  kSlowBoot,         ///< boot-up comes 4 s after reset
  kModeWhenEnabled,  ///< 6061 follows 6060 only when enabled
  kWrongMode,        ///< and is another mode then
  kStays,            ///< 1029:01 is stored with 1: without its master the drive stays operational, and goes on
  kStaysForGood,     ///< and can not be written
};
using Peculiarities = std::set<Peculiarity>;

/// Throws std::runtime_error with "sentence; cure".
auto parse_peculiarity(const std::string& text) -> Peculiarity;
auto peculiarity_names() -> std::string;
auto name(Peculiarity peculiarity) -> const char*;

/// What a drive with these is born with.
auto dictionary_of(const Peculiarities& peculiarities, std::uint8_t node) -> ObjectDictionary;

}  // namespace capstan::drive_sim
