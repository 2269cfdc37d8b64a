// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/config.hpp"
#include "firmware/maintenance.hpp"

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

enum class LoadResult : std::uint8_t {
  kLoaded,
  kEmpty,       ///< never saved: defaults, and nothing is wrong
  kUnfinished,  ///< power went while the very first set was saved: defaults, and nothing but that save is lost
  kUnreadable,  ///< the memory itself did not answer
  kCorrupt,     ///< something is there and no bank holds a whole and consistent set
  kRefused,     ///< nothing was tried, because torque is on or the last change is still under way
};

/// Parameters and the digest of the maintenance key in two banks. A save goes to the bank that does not hold the newest
/// set and becomes valid with its last word, the header; a cut at any byte leaves the old set. Entries carry a hash of
/// the parameter's name, so sets from other versions load as far as names agree.
class ParameterStorage {
 public:
  explicit ParameterStorage(Banks& banks) : banks_(banks) {}
  auto save(std::span<const AxisConfig> axes, const KeyDigest& key = {}) -> bool;
  /// Entries that are unknown or outside today's range are left at the values `axes` came with. After anything but
  /// kLoaded what is in `axes` is not to be used. Never kRefused. `key`: where the key goes; nullptr: nowhere.
  auto load(std::span<AxisConfig> axes, KeyDigest* key = nullptr) -> LoadResult;

 private:
  Banks& banks_;
};

}  // namespace capstan
