// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "capstan/hal/framing/cobs.hpp"
#include "capstan/hal/framing/crc16.hpp"
#include "capstan/hal/joint_io.hpp"

/// The two frames between a board without a joint of its own and the simulated plant that stands in for one. All
/// numbers are little endian and fixed point, so that what arrives is what was sent, to the bit.
///
///   sensed: 'S' version axes flags | sequence u32 | per axis: encoder i32, current Q24 i32, qualities u8 | crc16
///   drive:  'D' version axes flags | sequence u32 | per axis: current Q24 i32, enabled u8               | crc16
///
/// The flags of a drive frame say what the plant does with it (DriveKind); those of a sensed frame hold the emergency
/// stop. Lock-step: the plant advances by exactly one cycle for each kStep, then answers with the sensed frame that
/// carries the drive frame's sequence number.
namespace capstan::plant_link {

inline constexpr std::uint8_t kVersion = 1;
inline constexpr std::uint8_t kSensedTag = 'S';
inline constexpr std::uint8_t kDriveTag = 'D';
inline constexpr std::uint8_t kSensedEstop = 1U << 0;

enum class DriveKind : std::uint8_t {
  kStep = 0,     ///< take the set values, advance one cycle, answer
  kQuery = 1,    ///< answer with what the sensors hold now, advance nothing
  kRelease = 2,  ///< bridges off at once; no advance, no answer
};

template <std::size_t Axes>
struct SensedFrame {
  std::uint32_t sequence = 0;  ///< of the drive frame this answers
  bool estop = false;
  std::array<AxisSensed, Axes> axis{};
};

template <std::size_t Axes>
struct DriveFrame {
  std::uint32_t sequence = 0;
  DriveKind kind = DriveKind::kStep;
  Drive<Axes> drive{};
};

inline constexpr std::size_t kHeaderSize = 8;
inline constexpr std::size_t kCrcSize = 2;
inline constexpr std::size_t kSensedAxisSize = 9;
inline constexpr std::size_t kDriveAxisSize = 5;
template <std::size_t Axes>
inline constexpr std::size_t kSensedSize = kHeaderSize + Axes* kSensedAxisSize + kCrcSize;
template <std::size_t Axes>
inline constexpr std::size_t kDriveSize = kHeaderSize + Axes* kDriveAxisSize + kCrcSize;

/// A frame ready for the line: stuffed, with its end mark.
template <std::size_t PacketSize>
struct Wire {
  std::array<std::uint8_t, cobs_max_size(PacketSize) + 1> bytes{};
  std::size_t size = 0;
  [[nodiscard]] constexpr auto view() const& -> std::span<const std::uint8_t> { return {bytes.data(), size}; }
  auto view() const&& -> std::span<const std::uint8_t> = delete;  // it would outlive the bytes
};

namespace detail {

template <std::size_t Size>
class PacketWriter {
 public:
  constexpr void u8(std::uint8_t value) { packet_[at_++] = value; }
  constexpr void u32(std::uint32_t value) {
    for (int byte = 0; byte < 4; ++byte) {
      u8(static_cast<std::uint8_t>((value >> (8 * byte)) & 0xFFU));
    }
  }
  constexpr void i32(std::int32_t value) { u32(static_cast<std::uint32_t>(value)); }
  [[nodiscard]] constexpr auto finish() -> Wire<Size> {
    const std::uint16_t crc = crc16(std::span(packet_).first(at_));
    u8(static_cast<std::uint8_t>(crc & 0xFFU));
    u8(static_cast<std::uint8_t>(crc >> 8U));
    Wire<Size> wire;
    wire.size = cobs_encode(packet_, std::span(wire.bytes).first(wire.bytes.size() - 1));
    wire.bytes[wire.size++] = kFrameEnd;
    return wire;
  }

 private:
  std::array<std::uint8_t, Size> packet_{};
  std::size_t at_ = 0;
};

class PacketReader {
 public:
  constexpr explicit PacketReader(std::span<const std::uint8_t> packet) : packet_(packet) {}
  constexpr auto u8() -> std::uint8_t { return packet_[at_++]; }
  constexpr auto u32() -> std::uint32_t {
    std::uint32_t value = 0;
    for (int byte = 0; byte < 4; ++byte) {
      value |= static_cast<std::uint32_t>(u8()) << (8 * byte);
    }
    return value;
  }
  constexpr auto i32() -> std::int32_t { return static_cast<std::int32_t>(u32()); }

 private:
  std::span<const std::uint8_t> packet_;
  std::size_t at_ = 0;
};

/// Length, tag, version, number of axes and checksum as they must be.
[[nodiscard]] constexpr auto header_ok(std::span<const std::uint8_t> packet, std::uint8_t tag, std::size_t axes,
                                       std::size_t size) -> bool {
  if (packet.size() != size || packet[0] != tag || packet[1] != kVersion || packet[2] != axes) {
    return false;
  }
  const std::uint16_t crc = crc16(packet.first(size - kCrcSize));
  return packet[size - 2] == (crc & 0xFFU) && packet[size - 1] == (crc >> 8U);
}

/// A quality outside the enumeration is as bad as a damaged value.
[[nodiscard]] constexpr auto quality_of(std::uint32_t bits) -> Quality {
  return bits <= static_cast<std::uint32_t>(Quality::kOk) ? static_cast<Quality>(bits) : Quality::kInvalid;
}

}  // namespace detail

template <std::size_t Axes>
[[nodiscard]] constexpr auto encode(const SensedFrame<Axes>& frame) -> Wire<kSensedSize<Axes>> {
  detail::PacketWriter<kSensedSize<Axes>> out;
  out.u8(kSensedTag);
  out.u8(kVersion);
  out.u8(static_cast<std::uint8_t>(Axes));
  out.u8(frame.estop ? kSensedEstop : 0);
  out.u32(frame.sequence);
  for (const AxisSensed& axis : frame.axis) {
    out.i32(axis.encoder_counts);
    out.i32(axis.current_a.raw());
    out.u8(
        static_cast<std::uint8_t>(static_cast<unsigned>(axis.encoder) | (static_cast<unsigned>(axis.current) << 4U)));
  }
  return out.finish();
}

template <std::size_t Axes>
[[nodiscard]] constexpr auto encode(const DriveFrame<Axes>& frame) -> Wire<kDriveSize<Axes>> {
  detail::PacketWriter<kDriveSize<Axes>> out;
  out.u8(kDriveTag);
  out.u8(kVersion);
  out.u8(static_cast<std::uint8_t>(Axes));
  out.u8(static_cast<std::uint8_t>(frame.kind));
  out.u32(frame.sequence);
  for (const AxisDrive& axis : frame.drive.axis) {
    out.i32(axis.current_a.raw());
    out.u8(axis.enabled ? 1 : 0);
  }
  return out.finish();
}

/// False: not a whole, undamaged frame of this kind; `frame` is unchanged.
template <std::size_t Axes>
[[nodiscard]] constexpr auto decode(std::span<const std::uint8_t> packet, SensedFrame<Axes>& frame) -> bool {
  if (!detail::header_ok(packet, kSensedTag, Axes, kSensedSize<Axes>)) {
    return false;
  }
  detail::PacketReader in(packet.subspan(3));
  frame.estop = (in.u8() & kSensedEstop) != 0;
  frame.sequence = in.u32();
  for (AxisSensed& axis : frame.axis) {
    axis.encoder_counts = in.i32();
    axis.current_a = Q24::from_raw(in.i32());
    const std::uint32_t qualities = in.u8();
    axis.encoder = detail::quality_of(qualities & 0xFU);
    axis.current = detail::quality_of(qualities >> 4U);
  }
  return true;
}

/// An `enabled` that is neither 0 nor 1 counts as 0: the bridge stays off unless it was plainly asked for.
template <std::size_t Axes>
[[nodiscard]] constexpr auto decode(std::span<const std::uint8_t> packet, DriveFrame<Axes>& frame) -> bool {
  if (!detail::header_ok(packet, kDriveTag, Axes, kDriveSize<Axes>)) {
    return false;
  }
  detail::PacketReader in(packet.subspan(3));
  const std::uint8_t kind = in.u8();
  if (kind > static_cast<std::uint8_t>(DriveKind::kRelease)) {
    return false;
  }
  frame.kind = static_cast<DriveKind>(kind);
  frame.sequence = in.u32();
  for (AxisDrive& axis : frame.drive.axis) {
    axis.current_a = Q24::from_raw(in.i32());
    axis.enabled = in.u8() == 1;
  }
  return true;
}

/// Cuts a stream of bytes into packets. Overlong and damaged frames are dropped whole and counted.
template <std::size_t PacketSize>
class FrameReader {
 public:
  /// Takes one byte; true when it completed a packet, which packet() then gives until the next call.
  [[nodiscard]] constexpr auto take(std::uint8_t byte) noexcept -> bool {
    if (byte != kFrameEnd) {
      if (size_ < frame_.size()) {
        frame_[size_++] = byte;
      } else {
        overlong_ = true;
      }
      return false;
    }
    const bool empty = size_ == 0;  // an end mark on its own resynchronises the other side and is no error
    packet_size_ = overlong_ ? 0 : cobs_decode(std::span(frame_).first(size_), packet_);
    size_ = 0;
    overlong_ = false;
    if (packet_size_ == 0 && !empty) {
      ++damaged_;
    }
    return packet_size_ != 0;
  }
  [[nodiscard]] constexpr auto packet() const noexcept -> std::span<const std::uint8_t> {
    return std::span(packet_).first(packet_size_);
  }
  [[nodiscard]] constexpr auto damaged() const noexcept -> std::uint32_t { return damaged_; }

 private:
  std::array<std::uint8_t, cobs_max_size(PacketSize)> frame_{};
  std::array<std::uint8_t, PacketSize> packet_{};
  std::size_t size_ = 0;
  std::size_t packet_size_ = 0;
  std::uint32_t damaged_ = 0;
  bool overlong_ = false;
};

}  // namespace capstan::plant_link
