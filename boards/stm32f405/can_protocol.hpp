// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "capstan/boards/stm32f405/can_messages.hpp"
#include "capstan/hal/framing/crc16.hpp"

/// What can go wrong on the motor board's CAN, and the checksum. The frames themselves are in can_messages.hpp.
namespace capstan::stm32f405 {

/// What can be wrong with a frame or the bus. Each has a counter; the console prints those that are not zero.
enum class CanTrouble : std::uint8_t {
  kSetpointLength,
  kSetpointChecksum,
  kSetpointKind,
  kSetpointDuplicate,
  kSetpointLate,
  kSetpointLost,
  kSetpointCrowded,
  kSetpointAlone,
  kShellLength,
  kShellDuplicate,
  kShellLost,
  kShellCrowded,
  kUnexpected,
  kFifoOverrun,
  kRingOverrun,
  kForeign,
  kSendFull,
  kSendLost,
  kErrorPassive,
  kBusOff,
  kAlone,
};
struct CanTroubleInfo {
  const char* name;
  const char* cause;
  const char* cure;
};
inline constexpr std::array<CanTroubleInfo, 21> kCanTroubles = {{
    {"setpoint_length", "a setpoint had not eight bytes and was not used", "correct the sender"},
    {"setpoint_checksum", "a setpoint's checksum was wrong and it was not used",
     "check that sender and board have the same protocol"},
    {"setpoint_kind", "a setpoint was of an unknown kind and was not used", "send kind 1, a joint angle"},
    {"setpoint_duplicate", "a setpoint came twice and the second one was not used",
     "look for a second sender, or one that repeats itself"},
    {"setpoint_late", "a setpoint was older than one that had come and was not used",
     "look for a queue on the way that reorders or holds frames back"},
    {"setpoint_lost", "setpoints are missing between two that came", "take load off the bus, and check its ends"},
    {"setpoint_crowded", "more than one setpoint for an axis came within a cycle and the newest was used",
     "send one a millisecond at most, evenly"},
    {"setpoint_alone", "a first setpoint after 0.1 s of silence was not used, as it may be a stray one",
     "nothing to do at the start of a stream; else send more often"},
    {"shell_length", "a shell frame had less than two bytes or more than eight and was not used", "correct the sender"},
    {"shell_duplicate", "a shell frame came twice and the second one was not used",
     "look for a second sender, or one that repeats itself"},
    {"shell_lost", "shell frames are missing, and the line they belonged to is refused", "send the line again"},
    {"shell_crowded", "shell frames found no room, and the line they belonged to is refused",
     "wait for the answer to a line before the next one"},
    {"unexpected", "a frame with an identifier that is not the board's came through its filters",
     "reboot, and if this comes back replace the board"},
    {"fifo_overrun", "frames came faster than the controller's three places were emptied, and some are lost",
     "spread the frames for this board over the millisecond"},
    {"ring_overrun", "frames came faster than the firmware took them, and some are lost",
     "spread the frames for this board over the millisecond"},
    {"foreign", "a remote or an extended frame came through the filters and was not used",
     "reboot, and if this comes back replace the board"},
    {"send_full", "a frame of telemetry was not sent as those before it were still waiting", "take load off the bus"},
    {"send_lost", "frames were given up after 20 ms as no node acknowledged them",
     "check that another node is there, the bit rate of 1 Mbit/s and both terminators"},
    {"error_passive", "the controller saw so many errors that it became passive",
     "check wiring, terminators and the bit rate of every node"},
    {"bus_off", "the controller saw so many errors that it left the bus for 0.1 s, and torque was taken away",
     "check wiring, terminators and the bit rate of every node, then 'arm'"},
    {"alone", "no node acknowledged a frame for 0.1 s, and torque that was given over the bus was taken away",
     "check that the cable is plugged in and the other node has power, then 'arm'"},
}};
static_assert(kCanTroubles.size() == static_cast<std::size_t>(CanTrouble::kAlone) + 1);

/// Counters since start; each is written by one context only and read by any.
class CanTroubleCounters {
 public:
  void rt_add(CanTrouble trouble, std::uint32_t count = 1) {
    std::atomic<std::uint32_t>& counter = counts_[static_cast<std::size_t>(trouble)];
    counter.store(counter.load(std::memory_order_relaxed) + count, std::memory_order_relaxed);
  }
  [[nodiscard]] auto count(CanTrouble trouble) const -> std::uint32_t {
    return counts_[static_cast<std::size_t>(trouble)].load(std::memory_order_relaxed);
  }

 private:
  std::array<std::atomic<std::uint32_t>, kCanTroubles.size()> counts_{};
};

/// The checksum covers the identifier, so that one axis' setpoint can not pass for another's.
[[nodiscard]] constexpr auto setpoint_checksum(const stm32f4::CanFrame& frame) -> std::uint16_t {
  std::array<std::uint8_t, 8> covered{};
  covered[0] = static_cast<std::uint8_t>(frame.id);
  covered[1] = static_cast<std::uint8_t>(frame.id >> 8U);
  for (std::size_t i = 0; i < 6; ++i) {
    covered[2 + i] = frame.data[i];
  }
  return plant_link::crc16(covered);
}

}  // namespace capstan::stm32f405
