// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace capstan::drive_sim {

/// A drive's objects of up to four bytes. Written without regard to the firmware's side, from CiA 301 and 402.
class ObjectDictionary {
 public:
  struct Entry {
    std::uint8_t bytes = 4;
    bool writable = true;
    std::uint32_t value = 0;
    std::vector<std::uint32_t> allowed{};  ///< that may be written; none: all
  };

  /// What a drive leaves its factory with: no heartbeat, no reaction to a lost master, nothing mapped.
  ObjectDictionary();

  [[nodiscard]] auto find(std::uint16_t index, std::uint8_t subindex) const -> const Entry*;
  /// For the drive itself. @pre the object exists
  [[nodiscard]] auto get(std::uint16_t index, std::uint8_t subindex = 0) const -> std::uint32_t;
  void set(std::uint16_t index, std::uint32_t value, std::uint8_t subindex = 0);
  // What a drive can have otherwise.
  void remove(std::uint16_t index);
  void fix(std::uint16_t index, std::uint8_t subindex = 0) { entries_.at({index, subindex}).writable = false; }
  void allow(std::uint16_t index, std::vector<std::uint32_t> values) {
    entries_.at({index, 0}).allowed = std::move(values);
  }
  void set_least_heartbeat(std::uint32_t time_ms) { least_heartbeat_ms_ = time_ms; }
  /// 1029:01, which a drive need not have.
  void store_error_behaviour(std::uint32_t value, bool for_good) { entries_[{0x1029, 1}] = {1, !for_good, value, {}}; }
  void set_most_mapped(std::uint8_t objects);
  /// The mode display (6061) follows writes to 6060 by itself.
  void set_mode_follows(bool follows) { mode_follows_ = follows; }

  /// By SDO. @returns the abort code, if it is refused
  auto write(std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes, std::uint32_t value)
      -> std::optional<std::uint32_t>;

 private:
  auto refused_by_pdo_rules(std::uint16_t index, std::uint8_t subindex, std::uint32_t value) const
      -> std::optional<std::uint32_t>;
  auto refused_by_id_rules(std::uint16_t index, std::uint8_t subindex, std::uint32_t value) const -> bool;
  [[nodiscard]] auto is_within_range(const Entry& entry, std::uint16_t index, std::uint32_t value) const -> bool;

  std::map<std::pair<std::uint16_t, std::uint8_t>, Entry> entries_;
  std::uint32_t least_heartbeat_ms_ = 0;
  std::uint8_t most_mapped_ = 8;
  bool mode_follows_ = true;
};

}  // namespace capstan::drive_sim
