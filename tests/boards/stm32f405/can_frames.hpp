// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/boards/stm32f405/can_protocol.hpp"

namespace capstan::stm32f405 {

inline constexpr std::uint8_t kTestNode = 5;

/// CRC-16 with 0x1021 from 0xFFFF, by long division of the message with 16 zeros behind it.
inline auto divided_crc(const std::vector<std::uint8_t>& bytes) -> std::uint16_t {
  std::vector<int> bits;
  for (const std::uint8_t byte : bytes) {
    for (int i = 7; i >= 0; --i) {
      bits.push_back(byte >> i & 1);
    }
  }
  bits.resize(bits.size() + 16);
  for (std::size_t i = 0; i < 16; ++i) {
    bits[i] ^= 1;  // the start value
  }
  for (std::size_t i = 0; i + 16 < bits.size(); ++i) {
    if (bits[i] != 0) {
      for (const int tap : {0, 4, 11, 16}) {  // x^16 + x^12 + x^5 + 1
        bits[i + static_cast<std::size_t>(tap)] ^= 1;
      }
    }
  }
  unsigned crc = 0;
  for (std::size_t i = bits.size() - 16; i < bits.size(); ++i) {
    crc = crc << 1U | static_cast<unsigned>(bits[i]);
  }
  return static_cast<std::uint16_t>(crc);
}

/// A setpoint as a sender makes it, byte by byte.
inline auto setpoint(std::size_t axis, std::uint8_t sequence, double angle_rad) -> stm32f4::CanFrame {
  const auto id = static_cast<std::uint16_t>(0x200 + 0x100 * axis + kTestNode);
  const auto raw = static_cast<std::uint32_t>(Q24::from_double(angle_rad).raw());
  stm32f4::CanFrame frame{.id = id,
                          .size = 8,
                          .data = {sequence, 1, static_cast<std::uint8_t>(raw), static_cast<std::uint8_t>(raw >> 8U),
                                   static_cast<std::uint8_t>(raw >> 16U), static_cast<std::uint8_t>(raw >> 24U)}};
  std::vector<std::uint8_t> covered = {static_cast<std::uint8_t>(id), static_cast<std::uint8_t>(id >> 8U)};
  covered.insert(covered.end(), frame.data.begin(), frame.data.begin() + 6);
  const std::uint16_t crc = divided_crc(covered);
  frame.data[6] = static_cast<std::uint8_t>(crc);
  frame.data[7] = static_cast<std::uint8_t>(crc >> 8U);
  return frame;
}

}  // namespace capstan::stm32f405
