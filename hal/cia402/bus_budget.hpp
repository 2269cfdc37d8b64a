// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "capstan/hal/cia402/pdo_map.hpp"

namespace capstan::cia402 {

struct BitRates {
  std::uint32_t nominal_bit_s = 1'000'000;
  std::uint32_t data_bit_s = 0;  ///< of an FD frame's data; 0: the bus is classical
};

/// Longest time of a frame with 11-bit identifier on the bus, ns, stuff bits and interframe space included.
/// Classical: 55 + 10 n bits (Davis, Burns et al., Real-Time Systems 35, 2007, eq. 1 with g = 34, plus 3 bits of
/// space). FD (ISO 11898-1:2015): 22 bits of arbitration and 12 of end at the nominal rate; at the data rate ESI, DLC
/// and data with a stuff bit after every fourth, then stuff count, CRC and their fixed stuff bits.
constexpr auto longest_frame_ns(std::size_t bytes, bool fd, const BitRates& rates) -> std::uint64_t {
  constexpr std::uint64_t kNsPerSecond = 1'000'000'000;
  if (!fd) {
    return (55 + 10 * bytes) * kNsPerSecond / rates.nominal_bit_s;
  }
  constexpr std::size_t kLongShortCrc = 16;
  const std::size_t data = 5 + 8 * bytes;
  const std::size_t check = bytes > kLongShortCrc ? 4 + 21 + 7 : 4 + 17 + 6;
  return 34 * kNsPerSecond / rates.nominal_bit_s + (data + data / 4 + check) * kNsPerSecond / rates.data_bit_s;
}

/// What one cycle of 1 ms asks of a bus at worst.
struct BusBudget {
  std::size_t frames = 0;
  std::uint64_t cyclic_ns = 0;
  std::uint64_t retransmission_ns = 0;  ///< the longest frame again, after the longest error frame

  static constexpr std::uint64_t kCycleNs = 1'000'000;
  /// The rest is for heartbeats, emergencies and controlwords.
  static constexpr std::uint64_t kMostPercent = 80;

  [[nodiscard]] constexpr auto with_retransmission_ns() const -> std::uint64_t { return cyclic_ns + retransmission_ns; }
  [[nodiscard]] constexpr auto fits() const -> bool {
    return with_retransmission_ns() * 100 <= kMostPercent * kCycleNs;
  }
  constexpr void add(std::size_t bytes, bool fd, const BitRates& rates) {
    constexpr std::uint64_t kErrorFrameBits = 31;  // flags of all stations on top of each other, delimiter, space
    const std::uint64_t time = longest_frame_ns(bytes, fd, rates);
    const std::uint64_t again = time + kErrorFrameBits * 1'000'000'000 / rates.nominal_bit_s;
    ++frames;
    cyclic_ns += time;
    retransmission_ns = again > retransmission_ns ? again : retransmission_ns;
  }
};

/// Of the drives of one bus with these messages: every set value, every status and the SYNC.
constexpr auto bus_budget(PdoLayout layout, std::span<const DriveMaps> drives, const BitRates& rates) -> BusBudget {
  const bool fd = rates.data_bit_s != 0;
  BusBudget budget;
  budget.add(0, false, rates);
  for (std::size_t place = 0; place < drives.size(); ++place) {
    if (layout == PdoLayout::kSeparate || place == 0) {
      budget.add(drives[place].torque.bytes(), fd, rates);
    }
    for (const PdoMap& status : drives[place].status) {
      if (status.count != 0) {
        budget.add(status.bytes(), fd, rates);
      }
    }
  }
  return budget;
}

/// Of `drives` (1 to 4) drives that send their status in one message each.
constexpr auto bus_budget(PdoLayout layout, std::size_t drives, const BitRates& rates) -> BusBudget {
  constexpr std::size_t kMostDrives = 4;
  std::array<DriveMaps, kMostDrives> maps{};
  for (std::size_t place = 0; place < drives; ++place) {
    maps[place] = drive_maps(layout, static_cast<std::uint8_t>(place + 1), place, drives);
  }
  return bus_budget(layout, std::span(maps).first(drives), rates);
}

}  // namespace capstan::cia402
