// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "capstan/hal/stm32f4/can.hpp"

/// Every frame of the motor board as data: the firmware packs and unpacks its frames by this table, and `capstan dbc`
/// writes it down for others. Classical frames with 11-bit identifiers at 1 Mbit/s, little endian. The identifiers are
/// those of CANopen's predefined set, so that one bus can carry both.
namespace capstan::stm32f405 {

inline constexpr std::uint32_t kCanBitRate = 1'000'000;
inline constexpr std::uint8_t kCanLastNode = 127;
inline constexpr std::size_t kCanMostAxes = 4;

/// What a field's number stands for.
enum class CanMeaning : std::uint8_t {
  kNumber,
  kState,         ///< kStateNames
  kFault,         ///< kFaultTable
  kFaultFlags,    ///< the bit of a fault's number in kFaultTable
  kWarningFlags,  ///< the bit of a warning's number in kWarningTable
  kLimitFlags,    ///< Limit
  kSetpointKind,  ///< kFollowAngle
};

/// A number in a frame: whole bytes, or bits within one.
struct CanField {
  const char* name;
  std::uint8_t first_bit;
  std::uint8_t bits;
  const char* comment;
  CanMeaning meaning = CanMeaning::kNumber;
  bool has_sign = false;
  std::uint32_t parts = 1;  ///< of its unit: 1000 where the field counts thousandths
  const char* unit = "";
};

/// A frame of eight bytes; shell frames may end behind any character.
struct CanMessage {
  const char* name;
  std::uint16_t base;  ///< identifier less the node
  bool of_each_axis;   ///< 0x100 further for each axis
  bool from_board;
  std::uint16_t period_ms;  ///< 0: when there is something to say
  std::span<const CanField* const> fields;
  const char* comment;
};

inline constexpr std::uint8_t kFollowAngle = 1;             ///< the one kind of setpoint there is
inline constexpr std::uint32_t kCanAngleParts = 1U << 24U;  // Q24, as everywhere in the firmware
inline constexpr std::size_t kCanFaultBits = 24;

namespace can_setpoint {
inline constexpr CanField kSequence{"sequence", 0, 8, "one more than in the last setpoint of this axis"};
inline constexpr CanField kKind{"kind", 8, 8, "what is set", CanMeaning::kSetpointKind};
inline constexpr CanField kAngle{"angle", 16, 32, "joint angle", CanMeaning::kNumber, true, kCanAngleParts, "rad"};
inline constexpr CanField kChecksum{"checksum", 48, 16,
                                    "CRC-16, polynomial 0x1021 from 0xFFFF, of the identifier as two bytes, low byte "
                                    "first, and of the six bytes before"};
inline constexpr std::array<const CanField*, 4> kFields = {&kSequence, &kKind, &kAngle, &kChecksum};
}  // namespace can_setpoint

namespace can_telemetry {
inline constexpr CanField kAngle{"angle",        0,    32, "estimated joint angle", CanMeaning::kNumber, true,
                                 kCanAngleParts, "rad"};
inline constexpr CanField kCurrent{"current",           32,   16,   "motor current, ends at +-32.767 A",
                                   CanMeaning::kNumber, true, 1000, "A"};
inline constexpr CanField kLimits{"limit", 48, 7, "limits that were met", CanMeaning::kLimitFlags};
inline constexpr CanField kAngleValid{"angle_valid", 55, 1, "0: the angle is not to be used"};
inline constexpr CanField kTime{"time", 56, 8, "cycles since start, modulo 256", CanMeaning::kNumber, false, 1, "ms"};
inline constexpr std::array<const CanField*, 5> kFields = {&kAngle, &kCurrent, &kLimits, &kAngleValid, &kTime};
}  // namespace can_telemetry

namespace can_heartbeat {
inline constexpr CanField kState{"state", 0, 8, "of the supervisor", CanMeaning::kState};
inline constexpr CanField kFirstFault{"first_fault", 8, 8, "what took the torque away", CanMeaning::kFault};
inline constexpr CanField kFaults{"fault", 16, kCanFaultBits, "what is wrong now", CanMeaning::kFaultFlags};
inline constexpr CanField kWarnings{"warning", 40, 8, "of the board or any joint", CanMeaning::kWarningFlags};
inline constexpr CanField kRefused{"refused", 48, 8, "frames that were not used, modulo 256"};
inline constexpr CanField kCounter{"counter", 56, 8, "one more in each heartbeat"};
inline constexpr std::array<const CanField*, 6> kFields = {&kState,    &kFirstFault, &kFaults,
                                                           &kWarnings, &kRefused,    &kCounter};
}  // namespace can_heartbeat

namespace can_shell {
inline constexpr CanField kSequence{"sequence", 0, 8, "one more than in the last frame of this direction"};
inline constexpr CanField kText1{"text1", 8, 8, "character"};
inline constexpr CanField kText2{"text2", 16, 8, "character"};
inline constexpr CanField kText3{"text3", 24, 8, "character"};
inline constexpr CanField kText4{"text4", 32, 8, "character"};
inline constexpr CanField kText5{"text5", 40, 8, "character"};
inline constexpr CanField kText6{"text6", 48, 8, "character"};
inline constexpr CanField kText7{"text7", 56, 8, "character"};
inline constexpr std::array<const CanField*, 8> kFields = {&kSequence, &kText1, &kText2, &kText3,
                                                           &kText4,    &kText5, &kText6, &kText7};
}  // namespace can_shell

inline constexpr CanMessage kCanTelemetry{"telemetry",        0x180, true, true, 10, can_telemetry::kFields,
                                          "what a joint does"};
inline constexpr CanMessage kCanSetpoint{"setpoint",
                                         0x200,
                                         true,
                                         false,
                                         0,
                                         can_setpoint::kFields,
                                         "where a joint shall be; every millisecond, at most 98 ms apart"};
inline constexpr CanMessage kCanShellOut{"shell_out",
                                         0x580,
                                         false,
                                         true,
                                         0,
                                         can_shell::kFields,
                                         "the shell's answer; the frame ends behind its last character"};
inline constexpr CanMessage kCanShellIn{"shell_in",
                                        0x600,
                                        false,
                                        false,
                                        0,
                                        can_shell::kFields,
                                        "a line for the shell; the frame ends behind its last character"};
inline constexpr CanMessage kCanHeartbeat{"heartbeat",       0x700, false, true, 100, can_heartbeat::kFields,
                                          "how the board is"};
inline constexpr std::array<const CanMessage*, 5> kCanMessages = {&kCanTelemetry, &kCanSetpoint, &kCanShellOut,
                                                                  &kCanShellIn, &kCanHeartbeat};

/// A field is whole bytes or within one, and no two share a bit.
constexpr auto fields_are_sound(const CanMessage& message) -> bool {
  std::uint64_t taken = 0;
  for (const CanField* field : message.fields) {
    const bool whole = field->first_bit % 8 == 0 && field->bits % 8 == 0 && field->bits <= 32;
    const bool within = field->first_bit % 8 + field->bits <= 8;
    if ((!whole && !within) || field->first_bit + field->bits > 64) {
      return false;
    }
    const std::uint64_t bits = ((std::uint64_t{1} << field->bits) - 1) << field->first_bit;
    if ((taken & bits) != 0) {
      return false;
    }
    taken |= bits;
  }
  return true;
}
static_assert(fields_are_sound(kCanTelemetry) && fields_are_sound(kCanSetpoint) && fields_are_sound(kCanShellOut) &&
              fields_are_sound(kCanHeartbeat));

[[nodiscard]] constexpr auto identifier(const CanMessage& message, std::uint8_t node, std::size_t axis = 0)
    -> std::uint16_t {
  return static_cast<std::uint16_t>(message.base + 0x100 * axis + node);
}

/// Puts the lower bits of a number into a frame. @pre the field's bits are still zero
template <const CanField& Field>
constexpr void put(stm32f4::CanFrame& frame, std::uint32_t value) {
  constexpr std::size_t kFirst = Field.first_bit / 8;
  if constexpr (Field.bits < 8) {
    const std::uint32_t bits = (value & ((1U << Field.bits) - 1)) << Field.first_bit % 8;
    frame.data[kFirst] = static_cast<std::uint8_t>(frame.data[kFirst] | bits);
  } else {
    for (std::size_t i = 0; i < Field.bits / 8; ++i) {
      frame.data[kFirst + i] = static_cast<std::uint8_t>(value >> 8 * i);
    }
  }
}

/// The field's bits as they are; whoever wants a number with sign converts it to one of its size.
template <const CanField& Field>
[[nodiscard]] constexpr auto take(const stm32f4::CanFrame& frame) -> std::uint32_t {
  constexpr std::size_t kFirst = Field.first_bit / 8;
  if constexpr (Field.bits < 8) {
    return std::uint32_t{frame.data[kFirst]} >> Field.first_bit % 8 & ((1U << Field.bits) - 1);
  } else {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < Field.bits / 8; ++i) {
      value |= std::uint32_t{frame.data[kFirst + i]} << 8 * i;
    }
    return value;
  }
}

}  // namespace capstan::stm32f405
