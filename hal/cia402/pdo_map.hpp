// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "capstan/hal/cia402/frame.hpp"

namespace capstan::cia402 {

/// An entry of a drive's object dictionary.
struct Object {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t bytes = 0;
  const char* name = "";

  friend constexpr auto operator==(const Object& a, const Object& b) -> bool {
    return a.index == b.index && a.subindex == b.subindex;
  }
};

namespace object {
inline constexpr Object kControlword{0x6040, 0, 2, "controlword"};
inline constexpr Object kStatusword{0x6041, 0, 2, "statusword"};
inline constexpr Object kModeDisplay{0x6061, 0, 1, "mode of operation display"};
inline constexpr Object kPosition{0x6064, 0, 4, "position actual value"};
inline constexpr Object kTargetTorque{0x6071, 0, 2, "target torque"};
inline constexpr Object kTorque{0x6077, 0, 2, "torque actual value"};
inline constexpr Object kSkip16{0x0003, 0, 2, "16 bits that are another drive's"};  ///< CiA 301's dummy INTEGER16
}  // namespace object

/// Object 6060: cyclic synchronous torque.
inline constexpr std::uint32_t kTorqueMode = 10;

/// Objects that travel together in one frame, one after the other without gaps.
struct PdoMap {
  static constexpr std::size_t kMostObjects = 8;
  static constexpr std::uint8_t kEverySync = 1;
  static constexpr std::uint8_t kAtOnce = 255;

  std::uint32_t id = 0;
  std::uint8_t transmission = kEverySync;
  std::uint8_t count = 0;
  std::array<Object, kMostObjects> objects{};

  constexpr void add(const Object& object) { objects[count++] = object; }
  [[nodiscard]] constexpr auto bytes() const -> std::uint8_t {
    std::uint8_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      sum = static_cast<std::uint8_t>(sum + objects[i].bytes);
    }
    return sum;
  }
  /// Where the object stands in the frame, in bytes; none if it is not mapped.
  [[nodiscard]] constexpr auto offset(const Object& object) const -> std::optional<std::size_t> {
    std::size_t at = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (objects[i] == object) {
        return at;
      }
      at += objects[i].bytes;
    }
    return std::nullopt;
  }
  /// What stands for object `i` in the drive's mapping object: index, subindex, length in bits.
  [[nodiscard]] constexpr auto word(std::size_t i) const -> std::uint32_t {
    return static_cast<std::uint32_t>(objects[i].index) << 16U | static_cast<std::uint32_t>(objects[i].subindex) << 8U |
           objects[i].bytes * 8U;
  }
};

/// How set values reach the drives of one bus.
enum class PdoLayout : std::uint8_t {
  kSeparate,  ///< each drive has an RPDO of its own: controlword and torque
  kPacked,    ///< one RPDO with all torques, of which each drive takes its own; controlwords go when they change
};

/// What a drive sends after SYNC: statusword, position and torque, in this order, in one message or in two.
inline constexpr std::size_t kMostStatusParts = 2;

struct DriveMaps {
  PdoMap torque;                                ///< RPDO 1
  PdoMap controlword;                           ///< RPDO 2, without objects where RPDO 1 carries the controlword
  std::array<PdoMap, kMostStatusParts> status;  ///< TPDO 1 and 2, the second without objects where it is not needed
};

/// @param place      of this drive among the `drives` (1 to 4) of its bus, from 0
/// @param most_sent  objects that the drive takes in one of its own messages, at least 2
constexpr auto drive_maps(PdoLayout layout, std::uint8_t node, std::size_t place, std::size_t drives,
                          std::size_t most_sent = PdoMap::kMostObjects) -> DriveMaps {
  DriveMaps maps;
  if (layout == PdoLayout::kSeparate) {
    maps.torque.id = cob::kRpdo1 + node;
    maps.torque.add(object::kControlword);
    maps.torque.add(object::kTargetTorque);
  } else {
    maps.torque.id = cob::kRpdo1;
    for (std::size_t i = 0; i < drives; ++i) {
      maps.torque.add(i == place ? object::kTargetTorque : object::kSkip16);
    }
    maps.controlword.id = cob::kRpdo2 + node;
    maps.controlword.transmission = PdoMap::kAtOnce;
    maps.controlword.add(object::kControlword);
  }
  maps.status[0].id = cob::kTpdo1 + node;
  maps.status[1].id = cob::kTpdo2 + node;
  std::size_t sent = 0;
  for (const Object& object : {object::kStatusword, object::kPosition, object::kTorque}) {
    maps.status[sent++ / most_sent].add(object);
  }
  return maps;
}

}  // namespace capstan::cia402
