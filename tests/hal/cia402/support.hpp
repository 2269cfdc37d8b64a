// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <initializer_list>

#include "capstan/hal/cia402/bus_master.hpp"

namespace capstan::cia402 {

/// A frame as it stands in the standard or in a trace: identifier and bytes.
inline auto frame(std::uint32_t id, std::initializer_list<int> bytes) -> Frame {
  Frame made{.id = id, .size = static_cast<std::uint8_t>(bytes.size())};
  std::transform(bytes.begin(), bytes.end(), made.data.begin(),
                 [](int byte) { return static_cast<std::uint8_t>(byte); });
  return made;
}

inline auto ms(std::int64_t time) -> Time {
  return std::chrono::milliseconds(time);
}

/// Node 1, 2 A rated.
inline auto setting(std::uint8_t node = 1, std::size_t place = 0, std::size_t drives = 1,
                    PdoLayout layout = PdoLayout::kSeparate) -> DriveSetting {
  return {.node = node, .rated_current_ma = 2000, .maps = drive_maps(layout, node, place, drives)};
}

inline auto amperes(double value, bool enabled = true) -> AxisDrive {
  return {.current_a = Q24::from_double(value), .enabled = enabled};
}

/// Statuswords as a trace of a drive shows them (voltage present, remote): state bits of CiA 402-2 plus 0x0210.
inline constexpr int kSwitchOnDisabled = 0x50;
inline constexpr int kReady = 0x31;
inline constexpr int kSwitchedOn = 0x33;
inline constexpr int kEnabled = 0x37;
inline constexpr int kFaulted = 0x18;

/// TPDO 1 of node 1: this low byte of the statusword, position 0x00010203, torque -100 permille (0xFF9C).
inline auto status(int low_byte, std::uint32_t node = 1) -> Frame {
  return frame(0x180 + node, {low_byte, 0x02, 0x03, 0x02, 0x01, 0x00, 0x9C, 0xFF});
}

}  // namespace capstan::cia402
