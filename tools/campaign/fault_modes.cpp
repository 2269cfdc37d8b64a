// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/campaign/fault_modes.hpp"

namespace capstan::tools {
namespace {

auto of_transmission(Mode mode) -> bool {
  return mode == Mode::kTopBreaks || mode == Mode::kBottomBreaks || mode == Mode::kSlips || mode == Mode::kLoose;
}
auto of_a_number(Mode mode) -> bool {
  return mode == Mode::kDrift || mode == Mode::kHalf || mode == Mode::kDouble || mode == Mode::kCountBack ||
         mode == Mode::kQuantised;
}

}  // namespace

auto why_impossible(OneFault fault) -> const char* {
  const auto [input, mode] = fault;
  if (of_transmission(mode) != (input == Input::kTransmission) ||
      (mode == Mode::kBrownout && input != Input::kSupply)) {
    return "";
  }
  if (input == Input::kEmergencyStop || input == Input::kClock) {
    if (of_a_number(mode) || mode == Mode::kLate) {
      return "";
    }
    if (mode == Mode::kNan) {
      return "a bit or a count is always a number";
    }
  }
  if (mode == Mode::kCountBack && input != Input::kEncoder) {
    return "";
  }
  if (mode == Mode::kNan && (input == Input::kAmplifier || input == Input::kReference)) {
    return "fixed point has no NaN";
  }
  if (input == Input::kEmergencyStop && (mode == Mode::kStuck || mode == Mode::kSlow)) {
    return "a stop that does not open is the hardware's: it cuts the set value without the firmware";
  }
  if (input == Input::kClock && mode == Mode::kOff) {
    return "without edges no cycle runs: the watchdog resets the board within 29.9 ms";
  }
  return nullptr;
}

auto remedy(OneFault fault) -> const char* {
  if (fault.input != Input::kEncoder) {
    return nullptr;
  }
  switch (fault.mode) {
    case Mode::kHalf:
    case Mode::kDrift:
    case Mode::kSlow:
      return "a second position sensor";
    case Mode::kStuck:
    case Mode::kLate:
    case Mode::kDelayed:
    case Mode::kWrongSign:
    case Mode::kCountBack:
      return "a finer encoder";
    default:
      return nullptr;
  }
}

auto takes_part(Input input, Situation situation) -> bool {
  return input != Input::kReference || situation == Situation::kFollowing;
}
auto has_phases(Situation situation) -> bool {
  return situation == Situation::kMoving || situation == Situation::kFast || situation == Situation::kFollowing ||
         situation == Situation::kExperiment;
}
auto under_torque(Situation situation) -> bool {
  return has_phases(situation) || situation == Situation::kHolding;
}

auto name(Input input) -> const char* {
  static constexpr std::array kNames = {"encoder",        "current", "amplifier", "reference",
                                        "emergency stop", "clock",   "supply",    "transmission"};
  return kNames[static_cast<std::size_t>(input)];
}
auto name(Mode mode) -> const char* {
  static constexpr std::array<const char*, kModeCount> kNames = {
      "off",          "stuck",      "garbage",       "wrong sign", "slow",   "delayed",  "late",
      "intermittent", "NaN",        "drift",         "half",       "double", "one back", "quantised",
      "brownout",     "top breaks", "bottom breaks", "slips",      "loose"};
  return kNames[static_cast<std::size_t>(mode)];
}
auto name(Situation situation) -> const char* {
  static constexpr std::array kNames = {"disarmed", "starting", "saving",    "applying",   "holding",
                                        "moving",   "fast",     "following", "experiment", "faulted"};
  return kNames[static_cast<std::size_t>(situation)];
}
auto name(Joint joint) -> const char* {
  static constexpr std::array kNames = {"forceps", "stiff gains", "contact",  "finger",
                                        "elbow",   "wrist pitch", "wrist jaw"};
  return kNames[static_cast<std::size_t>(joint)];
}

}  // namespace capstan::tools
