// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace capstan::plant_link {

/// Consistent overhead byte stuffing (Cheshire and Baker, 1999): removes every zero from a packet at the price of one
/// byte per 254, so that a zero marks the end of a frame and a reader that lost bytes is in step again at the next one.
inline constexpr std::uint8_t kFrameEnd = 0;

/// Bytes a packet of `size` needs at most, without the end mark.
[[nodiscard]] constexpr auto cobs_max_size(std::size_t size) -> std::size_t {
  return size + size / 254 + 1;
}

/// Encodes `packet` into `out` and returns the length, or 0 when `out` is too small. No end mark is written.
[[nodiscard]] constexpr auto cobs_encode(std::span<const std::uint8_t> packet, std::span<std::uint8_t> out) noexcept
    -> std::size_t {
  if (out.size() < cobs_max_size(packet.size())) {
    return 0;
  }
  std::size_t code_at = 0;  // where the distance to the next zero will be written
  std::size_t end = 1;
  std::uint8_t distance = 1;
  for (const std::uint8_t byte : packet) {
    if (byte != 0) {
      out[end++] = byte;
      ++distance;
    }
    if (byte == 0 || distance == 0xFF) {
      out[code_at] = distance;
      code_at = end++;
      distance = 1;
    }
  }
  out[code_at] = distance;
  return end;
}

/// Decodes one frame (without its end mark) into `out` and returns the packet's length; 0: the frame is damaged or too
/// long.
[[nodiscard]] constexpr auto cobs_decode(std::span<const std::uint8_t> frame, std::span<std::uint8_t> out) noexcept
    -> std::size_t {
  std::size_t end = 0;
  std::size_t at = 0;
  while (at < frame.size()) {
    const std::uint8_t distance = frame[at];
    if (distance == 0 || at + distance > frame.size() || end + distance - 1 > out.size()) {
      return 0;
    }
    for (std::size_t i = 1; i < distance; ++i) {
      if (frame[at + i] == 0) {
        return 0;
      }
      out[end++] = frame[at + i];
    }
    at += distance;
    if (distance != 0xFF && at < frame.size()) {
      if (end == out.size()) {
        return 0;
      }
      out[end++] = 0;
    }
  }
  return end;
}

}  // namespace capstan::plant_link
