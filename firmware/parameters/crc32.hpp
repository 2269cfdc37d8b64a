// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace capstan {

/// CRC-32 (reflected 0x04C11DB7, as gzip and Ethernet have it), bit by bit: small, and nobody who uses it is in a
/// hurry.
class Crc32 {
 public:
  constexpr void add(std::uint8_t byte) {
    crc_ ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      crc_ = (crc_ >> 1) ^ ((crc_ & 1U) != 0 ? 0xEDB88320U : 0U);
    }
  }
  constexpr void add(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) {
      add(byte);
    }
  }
  [[nodiscard]] constexpr auto value() const -> std::uint32_t { return ~crc_; }

 private:
  std::uint32_t crc_ = 0xFFFFFFFFU;
};

}  // namespace capstan
