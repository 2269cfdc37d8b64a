// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace capstan::cia402 {

/// A moment or a time on a clock that is never set, such as CLOCK_MONOTONIC.
using Time = std::chrono::nanoseconds;

/// One CAN frame, classical (up to 8 bytes) or FD (up to 64).
struct Frame {
  static constexpr std::size_t kMostBytes = 64;
  std::uint32_t id = 0;
  std::uint8_t size = 0;
  bool extended = false;  ///< 29-bit identifier
  bool remote = false;    ///< asks for data instead of carrying it
  bool fd = false;        ///< FD frame; its data go at the bus's second bit rate
  std::array<std::uint8_t, kMostBytes> data{};

  friend auto operator==(const Frame& a, const Frame& b) -> bool = default;
};

/// Little-endian, as CANopen has all numbers. @pre at + count <= 64, count <= 4
constexpr auto get_bytes(const Frame& frame, std::size_t at, std::size_t count) -> std::uint32_t {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    value |= static_cast<std::uint32_t>(frame.data[at + i]) << (8 * i);
  }
  return value;
}

constexpr void put_bytes(Frame& frame, std::size_t at, std::size_t count, std::uint32_t value) {
  for (std::size_t i = 0; i < count; ++i) {
    frame.data[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

/// Identifiers of CiA 301's predefined connection set; those of one node are base + node.
namespace cob {
inline constexpr std::uint32_t kNmt = 0x000;
inline constexpr std::uint32_t kSync = 0x080;
inline constexpr std::uint32_t kEmergency = 0x080;
inline constexpr std::uint32_t kTpdo1 = 0x180;
inline constexpr std::uint32_t kRpdo1 = 0x200;  ///< with node 0, which no drive has: the RPDO that all drives share
inline constexpr std::uint32_t kTpdo2 = 0x280;
inline constexpr std::uint32_t kRpdo2 = 0x300;
inline constexpr std::uint32_t kSdoAnswer = 0x580;
inline constexpr std::uint32_t kSdoRequest = 0x600;
inline constexpr std::uint32_t kHeartbeat = 0x700;
}  // namespace cob

inline constexpr std::uint8_t kMasterNode = 127;
inline constexpr std::uint8_t kLastNode = 126;  ///< of a drive
/// Drives and firmware tell each other this often that they are there, and give up after the second.
inline constexpr std::chrono::milliseconds kHeartbeatPeriod{40};
inline constexpr std::chrono::milliseconds kHeartbeatTimeout{90};

/// CiA 301 network management.
enum class NmtCommand : std::uint8_t {
  kStart = 1,
  kStop = 2,
  kPreOperational = 128,
  kResetNode = 129,
  kResetCommunication = 130
};
enum class NmtState : std::uint8_t { kBootUp = 0, kStopped = 4, kOperational = 5, kPreOperational = 127 };

constexpr auto nmt_frame(NmtCommand command, std::uint8_t node) -> Frame {
  Frame frame{.id = cob::kNmt, .size = 2};
  frame.data[0] = static_cast<std::uint8_t>(command);
  frame.data[1] = node;
  return frame;
}

constexpr auto heartbeat_frame(std::uint8_t node, NmtState state) -> Frame {
  Frame frame{.id = cob::kHeartbeat + node, .size = 1};
  frame.data[0] = static_cast<std::uint8_t>(state);
  return frame;
}

}  // namespace capstan::cia402
