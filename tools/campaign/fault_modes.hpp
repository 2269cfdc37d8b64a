// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace capstan::tools {

/// What the firmware depends on, and what it drives.
enum class Input : std::uint8_t {
  kEncoder,
  kCurrent,
  kAmplifier,
  kReference,
  kEmergencyStop,
  kClock,
  kSupply,
  kTransmission
};
inline constexpr std::array kInputs = {Input::kEncoder,       Input::kCurrent, Input::kAmplifier, Input::kReference,
                                       Input::kEmergencyStop, Input::kClock,   Input::kSupply,    Input::kTransmission};

/// How it goes wrong, from a certain cycle on and for good.
enum class Mode : std::uint8_t {
  kOff,           ///< gives or takes nothing, and says so where it can
  kStuck,         ///< stays at its last value and looks healthy
  kGarbage,       ///< random over the whole range
  kWrongSign,     ///< reversed; a count about its value at the onset
  kSlow,          ///< follows with kLagS
  kDelayed,       ///< 100 ms old; the first 100 ms show the value of the onset
  kLate,          ///< 20 ms old, likewise
  kIntermittent,  ///< every twentieth value is missing
  kNan,
  kDrift,      ///< a ramp is added
  kHalf,       ///< half of the change since the onset
  kDouble,     ///< twice
  kCountBack,  ///< every second value is one step too low
  kQuantised,  ///< only multiples of a coarse step
  kBrownout,   ///< of the supply: half of the voltage for 300 ms
  kTopBreaks,  ///< of the transmission: a tendon tears
  kBottomBreaks,
  kSlips,  ///< of the transmission: the encoder's pulley slips by 0.1 rad
  kLoose,  ///< of the transmission: nine tenths of the pretension are lost
};
inline constexpr std::size_t kModeCount = 19;

/// What the machine was doing.
enum class Situation : std::uint8_t {
  kDisarmed,    ///< and is armed and moved 100 ms later, as an operator would
  kStarting,    ///< the fault was there before the first cycle; armed and moved likewise
  kSaving,      ///< the fault comes in the cycle of a `save`; armed and moved likewise
  kApplying,    ///< in the cycle in which new parameters come; armed and moved likewise
  kHolding,     ///< and moves 100 ms later
  kMoving,      ///< to and fro at half of the largest speed
  kFast,        ///< at the largest speed
  kFollowing,   ///< a streamed sine
  kExperiment,  ///< a triangle at three speeds, which is how a joint is commissioned
  kFaulted,     ///< another fault is latched
};
inline constexpr std::array kSituations = {
    Situation::kDisarmed, Situation::kStarting, Situation::kSaving,    Situation::kApplying,   Situation::kHolding,
    Situation::kMoving,   Situation::kFast,     Situation::kFollowing, Situation::kExperiment, Situation::kFaulted};

/// The phases of a motion at which a fault may begin.
inline constexpr int kPhases = 20;

/// Simulated joints. The campaign runs on kJoints; healthy ones are drawn about the others too.
enum class Joint : std::uint8_t { kForceps, kStiff, kContact, kFinger, kElbow, kWristPitch, kWristJaw };
inline constexpr std::array kJoints = {Joint::kForceps, Joint::kStiff, Joint::kContact, Joint::kFinger, Joint::kElbow};

struct OneFault {
  Input input{};
  Mode mode{};
};

/// Why there is no such case, or nullptr. `reason` of a mode that this input has no meaning for is "".
[[nodiscard]] auto why_impossible(OneFault fault) -> const char*;
/// What a machine needs beside this firmware where such a fault takes a joint beyond its limits
/// (docs/safety_concept.md, "What no detector finds in time"); nullptr: nothing is known that would do. It makes no
/// case safe.
[[nodiscard]] auto remedy(OneFault fault) -> const char*;
/// This situation has the input: a reference comes only where one is followed.
[[nodiscard]] auto takes_part(Input input, Situation situation) -> bool;
/// It moves: each of its phases is another case.
[[nodiscard]] auto has_phases(Situation situation) -> bool;
/// There is torque before the onset.
[[nodiscard]] auto under_torque(Situation situation) -> bool;

[[nodiscard]] auto name(Input input) -> const char*;
[[nodiscard]] auto name(Mode mode) -> const char*;
[[nodiscard]] auto name(Situation situation) -> const char*;
[[nodiscard]] auto name(Joint joint) -> const char*;

}  // namespace capstan::tools
