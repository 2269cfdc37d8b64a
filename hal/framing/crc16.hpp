// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace capstan::plant_link {

/// CRC-16 with generator x^16 + x^12 + x^5 + 1, start value 0xFFFF, no reflection, no final inversion ("CCITT-FALSE").
/// Bit by bit: a frame has some twenty bytes, which is not worth a table of 512 bytes of flash.
[[nodiscard]] constexpr auto crc16(std::span<const std::uint8_t> bytes) noexcept -> std::uint16_t {
  std::uint32_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= static_cast<std::uint32_t>(byte) << 8U;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0 ? (crc << 1U) ^ 0x1021U : crc << 1U;
    }
    crc &= 0xFFFFU;
  }
  return static_cast<std::uint16_t>(crc);
}

}  // namespace capstan::plant_link
