// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace capstan::cia402 {

/// States of a drive (CiA 402-2, finite state automaton).
enum class DriveState : std::uint8_t {
  kNotReady,
  kSwitchOnDisabled,
  kReadyToSwitchOn,
  kSwitchedOn,
  kOperationEnabled,
  kQuickStopActive,
  kFaultReaction,
  kFault,
  kUnknown,  ///< a statusword that stands for none of them
};

inline constexpr std::array<const char*, 9> kDriveStateNames = {"not ready to switch on",
                                                                "switch on disabled",
                                                                "ready to switch on",
                                                                "switched on",
                                                                "operation enabled",
                                                                "quick stop active",
                                                                "fault reaction",
                                                                "fault",
                                                                "in a state that the standard does not define"};
constexpr auto name(DriveState state) -> const char* {
  return kDriveStateNames[static_cast<std::size_t>(state)];
}

/// From the statusword, object 6041.
constexpr auto drive_state(std::uint16_t statusword) -> DriveState {
  switch (statusword & 0x6FU) {  // states in which bit 5, quick stop, counts
    case 0x21:
      return DriveState::kReadyToSwitchOn;
    case 0x23:
      return DriveState::kSwitchedOn;
    case 0x27:
      return DriveState::kOperationEnabled;
    case 0x07:
      return DriveState::kQuickStopActive;
    default:
      break;
  }
  switch (statusword & 0x4FU) {  // and in which it does not
    case 0x00:
      return DriveState::kNotReady;
    case 0x40:
      return DriveState::kSwitchOnDisabled;
    case 0x0F:
      return DriveState::kFaultReaction;
    case 0x08:
      return DriveState::kFault;
    default:
      return DriveState::kUnknown;
  }
}

/// Controlwords, object 6040.
namespace controlword {
inline constexpr std::uint16_t kDisableVoltage = 0x00;
inline constexpr std::uint16_t kShutdown = 0x06;
inline constexpr std::uint16_t kSwitchOn = 0x07;
inline constexpr std::uint16_t kEnableOperation = 0x0F;
inline constexpr std::uint16_t kFaultReset = 0x80;  ///< on its rising edge
}  // namespace controlword

/// The next step on the way to torque. From a state that does not lead there: voltage off.
constexpr auto towards_torque(DriveState state) -> std::uint16_t {
  switch (state) {
    case DriveState::kSwitchOnDisabled:
      return controlword::kShutdown;
    case DriveState::kReadyToSwitchOn:
      return controlword::kSwitchOn;
    case DriveState::kSwitchedOn:
    case DriveState::kOperationEnabled:
      return controlword::kEnableOperation;
    default:
      return controlword::kDisableVoltage;
  }
}

}  // namespace capstan::cia402
