// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "capstan/hal/framing/cobs.hpp"
#include "capstan/hal/framing/crc16.hpp"

/// Binary telemetry between the shell's text: packets are COBS-stuffed and stand between two zeros, which no text has.
/// All numbers are little endian.
///
///   schema: 'M' version every_ms u16 | channels u8 | per channel: type u8, column of the log, 0 | crc16
///   data:   'T' version schema u16   | tick u32, ms since start | per channel: i32             | crc16
///
/// A channel is a Q24 (type 0: value / 2^24, in the unit that its column names) or an integer (type 1). `schema` is the
/// CRC-16 of the schema packet that the data belong to; the schema is sent first and then every second, so who comes
/// late is soon told. The tick tells which frames were lost.
namespace capstan::telemetry {

inline constexpr std::uint8_t kVersion = 1;
inline constexpr std::uint8_t kSchemaTag = 'M';
inline constexpr std::uint8_t kDataTag = 'T';
inline constexpr std::size_t kHeaderBytes = 4;
inline constexpr std::size_t kMostPacketBytes = 320;
inline constexpr std::size_t kMostWireBytes = plant_link::cobs_max_size(kMostPacketBytes) + 2;

/// Puts a packet together and closes it with its CRC.
class PacketWriter {
 public:
  constexpr void u8(std::uint8_t value) {
    if (size_ < bytes_.size()) {
      bytes_[size_++] = value;
    }
  }
  constexpr void u16(std::uint16_t value) {
    u8(static_cast<std::uint8_t>(value & 0xFFU));
    u8(static_cast<std::uint8_t>(value >> 8U));
  }
  constexpr void u32(std::uint32_t value) {
    u16(static_cast<std::uint16_t>(value & 0xFFFFU));
    u16(static_cast<std::uint16_t>(value >> 16U));
  }
  constexpr void text(std::string_view text) {
    for (const char c : text) {
      u8(static_cast<std::uint8_t>(c));
    }
  }
  /// Returns the CRC.
  constexpr auto close() -> std::uint16_t {
    const std::uint16_t crc = plant_link::crc16(std::span(bytes_).first(size_));
    u16(crc);
    return crc;
  }
  /// Zero, stuffed packet, zero.
  [[nodiscard]] constexpr auto wire(std::array<std::uint8_t, kMostWireBytes>& out) const -> std::size_t {
    out[0] = plant_link::kFrameEnd;
    const std::size_t size = plant_link::cobs_encode(std::span(bytes_).first(size_), std::span(out).subspan(1));
    out[1 + size] = plant_link::kFrameEnd;
    return size + 2;
  }

 private:
  std::array<std::uint8_t, kMostPacketBytes> bytes_{};
  std::size_t size_ = 0;
};

}  // namespace capstan::telemetry
