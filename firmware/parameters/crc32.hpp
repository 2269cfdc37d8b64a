// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace capstan {

/// One byte of a CRC-32 (reflected 0x04C11DB7, as gzip and Ethernet have it): what `remainder` becomes by it.
constexpr auto crc32_step(std::uint32_t remainder, std::uint8_t byte) -> std::uint32_t {
  remainder ^= byte;
  for (int bit = 0; bit < 8; ++bit) {
    remainder = (remainder >> 1) ^ ((remainder & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return remainder;
}

/// CRC-32, bit by bit: small, and nobody who uses it is in a hurry. Who is has a table of crc32_step(0, byte).
class Crc32 {
 public:
  constexpr void add(std::uint8_t byte) { crc_ = crc32_step(crc_, byte); }
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
