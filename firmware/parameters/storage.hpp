// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "capstan/firmware/parameters/config.hpp"
#include "capstan/firmware/parameters/parameters.hpp"
#include "capstan/firmware/safety/maintenance.hpp"

namespace capstan {

/// Two erasable banks of memory that survive power loss. Slow: never called from the cycle.
class Banks {
 public:
  static constexpr int kBanks = 2;
  /// All bytes become 0xFF. False: the hardware refused.
  auto erase(int bank) -> bool { return do_erase(bank); }
  /// Programs erased bytes. False: the hardware refused.
  auto write(int bank, std::size_t offset, std::span<const std::uint8_t> bytes) -> bool {
    return do_write(bank, offset, bytes);
  }
  /// False: nothing to read there.
  auto read(int bank, std::size_t offset, std::span<std::uint8_t> bytes) -> bool {
    return do_read(bank, offset, bytes);
  }

 protected:
  ~Banks() = default;  // never owned through this face: a virtual one would need operator delete

 private:
  virtual auto do_erase(int bank) -> bool = 0;
  virtual auto do_write(int bank, std::size_t offset, std::span<const std::uint8_t> bytes) -> bool = 0;
  virtual auto do_read(int bank, std::size_t offset, std::span<std::uint8_t> bytes) -> bool = 0;
};

/// Bytes of a bank that a set takes at most: header, key, hash and value of every parameter.
constexpr auto stored_bytes(std::size_t axes) -> std::size_t {
  return 64 + axes * kMostParameters * 8;
}
/// What a bank has on every board.
inline constexpr std::size_t kBankLimit = std::size_t{16} * 1024;

enum class LoadResult : std::uint8_t {
  kLoaded,
  kEmpty,       ///< never saved: defaults, and nothing is wrong
  kUnfinished,  ///< power went while the very first set was saved: defaults, and nothing but that save is lost
  kUnreadable,  ///< the memory itself did not answer
  kCorrupt,     ///< something is there and no bank holds a whole and consistent set
  kRefused,     ///< nothing was tried, because torque is on or the last change is still under way
  kForeign,     ///< a whole set in a format that this version does not read: defaults, and the set stays where it is
};

/// What a load made of a set that another version may have stored.
struct LoadReport {
  LoadResult result = LoadResult::kEmpty;
  bool older = false;                            ///< the set saved after it is not whole
  std::uint32_t format = 0;                      ///< of the set, if there is a whole one
  std::uint16_t absent = 0;                      ///< parameters of today that it does not have: defaults
  std::uint16_t out_of_range = 0;                ///< values that today's range does not take: defaults
  std::uint16_t unknown = 0;                     ///< values whose names today's table does not have: left out
  const ParameterInfo* first_default = nullptr;  ///< of those that have defaults now
  [[nodiscard]] auto migrated() const -> bool { return absent + out_of_range + unknown != 0; }
};

/// Parameters and the digest of the maintenance key in two banks. A save goes to the bank that does not hold the newest
/// set and becomes valid with its last word, the header; a cut at any byte leaves the old set. So does memory that has
/// aged, which cannot be told from a cut through the header, and the report says that a newer set is not whole.
/// Entries carry a hash of
/// the parameter's name, so a set of another version loads as far as names agree: what it does not have gets today's
/// default, and the report says so. A new format keeps this header and its CRC, so that what is whole but unreadable
/// can be told from what is broken.
class ParameterStorage {
 public:
  explicit ParameterStorage(Banks& banks) : banks_(banks) {}
  auto save(std::span<const AxisConfig> axes, const KeyDigest& key = {}) -> bool;
  /// What the set does not have, or has outside today's range, is left at the values `axes` came with: defaults. After
  /// anything but kLoaded what is in `axes` is not to be used. Never kRefused. `key`: where the key goes; nullptr:
  /// nowhere.
  auto load(std::span<AxisConfig> axes, KeyDigest* key = nullptr) -> LoadReport;

 private:
  Banks& banks_;
};

}  // namespace capstan
