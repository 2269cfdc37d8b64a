// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402_sim/object_dictionary.hpp"

#include <algorithm>

namespace capstan::drive_sim {
namespace {

constexpr std::uint32_t kNoObject = 0x06020000;
constexpr std::uint32_t kNoSubindex = 0x06090011;
constexpr std::uint32_t kReadOnly = 0x06010002;
constexpr std::uint32_t kWrongLength = 0x06070010;
constexpr std::uint32_t kNotMappable = 0x06040041;
constexpr std::uint32_t kMappedTooLong = 0x06040042;
constexpr std::uint32_t kOutOfRange = 0x06090030;
constexpr std::uint32_t kNotNow = 0x08000022;
constexpr std::uint32_t kNotValid = 0x80000000;
constexpr std::uint8_t kMostMapped = 8;
constexpr std::uint32_t kMostBits = 64;

}  // namespace

ObjectDictionary::ObjectDictionary() {
  const auto add = [this](std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes, bool writable,
                          std::uint32_t value) {
    entries_[{index, subindex}] = {bytes, writable, value, {}};
  };
  add(0x1000, 0, 4, false, 0x00020192);
  add(0x1001, 0, 1, false, 0);
  add(0x1018, 0, 1, false, 2);
  add(0x1018, 1, 4, false, 0);
  add(0x1018, 2, 4, false, 402);
  add(0x1016, 0, 1, false, 1);
  add(0x1016, 1, 4, true, 0);
  add(0x1017, 0, 2, true, 0);
  for (std::uint16_t i = 0; i < 4; ++i) {
    for (const auto& [communication, mapping] : {std::pair{0x1400, 0x1600}, {0x1800, 0x1A00}}) {
      const auto com = static_cast<std::uint16_t>(communication + i);
      const auto map = static_cast<std::uint16_t>(mapping + i);
      add(com, 0, 1, false, 2);
      add(com, 1, 4, true, kNotValid);
      add(com, 2, 1, true, 255);
      for (std::uint8_t sub = 0; sub <= kMostMapped; ++sub) {
        add(map, sub, sub == 0 ? 1 : 4, true, 0);
      }
    }
  }
  add(0x6007, 0, 2, true, 0);
  add(0x6040, 0, 2, true, 0);
  add(0x6041, 0, 2, false, 0);
  add(0x605A, 0, 2, true, 2);
  add(0x605E, 0, 2, true, 2);
  add(0x6060, 0, 1, true, 0);
  add(0x6061, 0, 1, false, 0);
  add(0x6064, 0, 4, false, 0);
  add(0x6071, 0, 2, true, 0);
  add(0x6072, 0, 2, true, 3000);
  add(0x6075, 0, 4, true, 1500);
  add(0x6077, 0, 2, false, 0);
  add(0x607E, 0, 1, true, 0);
  add(0x60B2, 0, 2, true, 0);
  add(0x60C2, 1, 1, true, 1);
  add(0x60C2, 2, 1, true, 0xFD);
  add(0x6502, 0, 4, false, 0x200);
}

auto ObjectDictionary::find(std::uint16_t index, std::uint8_t subindex) const -> const Entry* {
  const auto found = entries_.find({index, subindex});
  return found == entries_.end() ? nullptr : &found->second;
}

auto ObjectDictionary::get(std::uint16_t index, std::uint8_t subindex) const -> std::uint32_t {
  return entries_.at({index, subindex}).value;
}

void ObjectDictionary::set(std::uint16_t index, std::uint32_t value, std::uint8_t subindex) {
  entries_.at({index, subindex}).value = value;
}

void ObjectDictionary::remove(std::uint16_t index) {
  std::erase_if(entries_, [index](const auto& entry) { return entry.first.first == index; });
}

void ObjectDictionary::set_most_mapped(std::uint8_t objects) {
  most_mapped_ = objects;
  std::erase_if(entries_, [objects](const auto& entry) {
    const std::uint16_t list = entry.first.first & 0xFF00U;
    return (list == 0x1600 || list == 0x1A00) && entry.first.second > objects;
  });
}

// CiA 301 7.5.2.35: bits 0 to 29 change only while the PDO is not valid, and some identifiers (7.3.5) are not for PDOs.
auto ObjectDictionary::refused_by_id_rules(std::uint16_t index, std::uint8_t subindex, std::uint32_t value) const
    -> bool {
  constexpr std::uint32_t kFixed = 0x3FFFFFFF;
  const std::uint16_t list = index & 0xFF00U;
  if (subindex != 1 || (list != 0x1400 && list != 0x1800)) {
    return false;
  }
  const std::uint32_t id = value & 0x7FFU;
  const auto within = [id](std::uint32_t first, std::uint32_t last) { return id >= first && id <= last; };
  const bool restricted = within(0x000, 0x07F) || within(0x101, 0x180) || within(0x581, 0x5FF) ||
                          within(0x601, 0x67F) || within(0x6E0, 0x6FF) || within(0x701, 0x7FF);
  const std::uint32_t present = get(index, 1);
  return restricted || ((present & kNotValid) == 0 && (value & kFixed) != (present & kFixed));
}

auto ObjectDictionary::is_within_range(const Entry& entry, std::uint16_t index, std::uint32_t value) const -> bool {
  const std::uint32_t time_ms = value & 0xFFFFU;
  const bool too_short = index == 0x1016 && time_ms != 0 && time_ms < least_heartbeat_ms_;
  return !too_short &&
         (entry.allowed.empty() || std::find(entry.allowed.begin(), entry.allowed.end(), value) != entry.allowed.end());
}

// CiA 301 7.5.2.36: a mapping changes only while the PDO is not valid and nothing is mapped.
auto ObjectDictionary::refused_by_pdo_rules(std::uint16_t index, std::uint8_t subindex, std::uint32_t value) const
    -> std::optional<std::uint32_t> {
  const bool mapping = (index & 0xFF00U) == 0x1600 || (index & 0xFF00U) == 0x1A00;
  if (!mapping) {
    return std::nullopt;
  }
  const auto communication = static_cast<std::uint16_t>(index - 0x200);
  if ((get(communication, 1) & kNotValid) == 0 || (subindex != 0 && get(index, 0) != 0)) {
    return kNotNow;
  }
  if (subindex != 0) {
    const auto mapped = static_cast<std::uint16_t>(value >> 16U);
    const Entry* const object = find(mapped, static_cast<std::uint8_t>(value >> 8U));
    const bool dummy = mapped >= 1 && mapped <= 7;
    return dummy || (object != nullptr && object->bytes * 8U == (value & 0xFFU)) ? std::nullopt
                                                                                 : std::optional(kNotMappable);
  }
  std::uint32_t bits = 0;
  for (std::uint8_t i = 1; i <= most_mapped_ && i <= value; ++i) {
    bits += get(index, i) & 0xFFU;
  }
  if (value > most_mapped_) {
    return kOutOfRange;
  }
  return bits > kMostBits ? std::optional(kMappedTooLong) : std::nullopt;
}

auto ObjectDictionary::write(std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes, std::uint32_t value)
    -> std::optional<std::uint32_t> {
  const auto found = entries_.find({index, subindex});
  if (found == entries_.end()) {
    return find(index, 0) != nullptr || find(index, 1) != nullptr ? kNoSubindex : kNoObject;
  }
  Entry& entry = found->second;
  if (!entry.writable) {
    return kReadOnly;
  }
  if (entry.bytes != bytes) {
    return kWrongLength;
  }
  if (refused_by_id_rules(index, subindex, value) || !is_within_range(entry, index, value)) {
    return kOutOfRange;
  }
  if (const auto refused = refused_by_pdo_rules(index, subindex, value)) {
    return refused;
  }
  if (index == 0x6060) {
    const bool known = value == 0 || value == 10;
    if (!known) {
      return kOutOfRange;
    }
    if (mode_follows_ && find(0x6061, 0) != nullptr) {
      set(0x6061, value);
    }
  }
  entry.value = value;
  return std::nullopt;
}

}  // namespace capstan::drive_sim
