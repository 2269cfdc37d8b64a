// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>

namespace capstan::drive_sim {

/// A drive's objects of up to four bytes. Written without regard to the firmware's side, from CiA 301 and 402.
class ObjectDictionary {
 public:
  struct Entry {
    std::uint8_t bytes = 4;
    bool writable = true;
    std::uint32_t value = 0;
  };

  /// What a drive leaves its factory with: no heartbeat, no reaction to a lost master, nothing mapped.
  ObjectDictionary();

  [[nodiscard]] auto find(std::uint16_t index, std::uint8_t subindex) const -> const Entry*;
  /// For the drive itself. @pre the object exists
  [[nodiscard]] auto get(std::uint16_t index, std::uint8_t subindex = 0) const -> std::uint32_t;
  void set(std::uint16_t index, std::uint32_t value, std::uint8_t subindex = 0);
  /// By SDO. @returns the abort code, if it is refused
  auto write(std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes, std::uint32_t value)
      -> std::optional<std::uint32_t>;

 private:
  auto refused_by_pdo_rules(std::uint16_t index, std::uint8_t subindex, std::uint32_t value) const
      -> std::optional<std::uint32_t>;
  std::map<std::pair<std::uint16_t, std::uint8_t>, Entry> entries_;
};

}  // namespace capstan::drive_sim
