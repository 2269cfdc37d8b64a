// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/parameters/storage.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

#include "capstan/firmware/loop/expect.hpp"
#include "capstan/firmware/parameters/crc32.hpp"
#include "capstan/firmware/parameters/name_hash.hpp"
#include "capstan/firmware/parameters/parameters.hpp"

namespace capstan {
namespace {

constexpr std::uint32_t kMagic = 0x31545343;  // "CST1"
constexpr std::uint32_t kFormatVersion = 1;
constexpr std::size_t kHeaderBytes = 20;  // magic, version, sequence, length, crc of all that and of the payload
constexpr std::size_t kEntryBytes = 8;    // hash of the name, raw value
constexpr std::uint32_t kLongestPayload = kBankLimit - kHeaderBytes;

struct Header {
  std::uint32_t format = kFormatVersion;
  std::uint32_t sequence = 0;
  std::uint32_t length = 0;
  std::uint32_t crc = 0;
};

void put(std::span<std::uint8_t> bytes, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

auto take(std::span<const std::uint8_t> bytes) -> std::uint32_t {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  }
  return value;
}

auto hash_of(std::size_t axis, const ParameterInfo& parameter) -> std::uint32_t {
  return name_hash(axis, parameter.group, parameter.name);
}

/// Of the key's words, which belong to no joint.
auto hash_of_key(std::size_t word) -> std::uint32_t {
  constexpr std::size_t kMachine = 0xFF;
  constexpr std::array<std::string_view, 4> kNames = {"key0", "key1", "key2", "key3"};
  return name_hash(kMachine, "maintenance", kNames[word]);
}

/// Calls each(entry bytes) for every parameter of every axis, in order, and for the key's words if there is one.
template <typename Each>
auto for_each_entry(std::span<const AxisConfig> axes, const KeyDigest& key, Each&& each) -> bool {
  const auto pass = [&each](std::uint32_t hash, std::uint32_t value) {
    std::array<std::uint8_t, kEntryBytes> entry{};
    put(std::span(entry).first(4), hash);
    put(std::span(entry).last(4), value);
    return each(std::span<const std::uint8_t>(entry));
  };
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    for (const ParameterInfo& parameter : parameters()) {
      if (!pass(hash_of(axis, parameter), static_cast<std::uint32_t>(raw_value(axes[axis], parameter)))) {
        return false;
      }
    }
  }
  for (std::size_t i = 0; key.is_set() && i < key.words.size(); ++i) {
    if (!pass(hash_of_key(i), key.words[i])) {
      return false;
    }
  }
  return true;
}

auto header_bytes(const Header& header) -> std::array<std::uint8_t, kHeaderBytes> {
  std::array<std::uint8_t, kHeaderBytes> bytes{};
  const std::span all(bytes);
  put(all.subspan(0, 4), kMagic);
  put(all.subspan(4, 4), header.format);
  put(all.subspan(8, 4), header.sequence);
  put(all.subspan(12, 4), header.length);
  put(all.subspan(16, 4), header.crc);
  return bytes;
}

enum class BankState : std::uint8_t { kEmpty, kUnsealed, kBroken, kUnreadable, kValid };

/// True if writing `wanted`, byte by byte into erased memory, may have been cut when it looked like `stored`: whole
/// bytes, one in which not every bit is cleared yet, erased ones. The header is written last and ends in its CRC, so a
/// set whose CRC looks like that was never whole. Strict, because memory that has aged shows single bits set again.
/// @pre they differ
auto was_cut(std::span<const std::uint8_t> stored, std::uint32_t wanted) -> bool {
  std::array<std::uint8_t, 4> whole{};
  put(whole, wanted);
  const auto [cut, target] = std::mismatch(stored.begin(), stored.end(), whole.begin());
  CAPSTAN_EXPECT(cut != stored.end());
  return (*cut & *target) == *target &&
         std::all_of(std::next(cut), stored.end(), [](std::uint8_t byte) { return byte == 0xFF; });
}

auto inspect(Banks& banks, int bank, Header& header) -> BankState {
  std::array<std::uint8_t, kHeaderBytes> bytes{};
  if (!banks.read(bank, 0, bytes)) {
    return BankState::kUnreadable;
  }
  bool erased = true;
  for (const std::uint8_t byte : bytes) {
    erased = erased && byte == 0xFF;
  }
  if (erased) {
    return BankState::kEmpty;
  }
  const std::span<const std::uint8_t> all(bytes);
  header = {take(all.subspan(4, 4)), take(all.subspan(8, 4)), take(all.subspan(12, 4)), take(all.subspan(16, 4))};
  constexpr std::uint32_t kErased = 0xFFFFFFFFU;
  if (header.crc == kErased && (take(all.first(4)) & kMagic) == kMagic) {
    return BankState::kUnsealed;
  }
  if (take(all.first(4)) != kMagic || header.length > kLongestPayload) {
    return BankState::kBroken;
  }
  Crc32 crc;
  crc.add(all.first(16));
  std::array<std::uint8_t, kEntryBytes> entry{};
  for (std::uint32_t at = 0; at < header.length; at += kEntryBytes) {
    const auto part = std::span(entry).first(std::min<std::size_t>(kEntryBytes, header.length - at));
    if (!banks.read(bank, kHeaderBytes + at, part)) {
      return BankState::kBroken;
    }
    crc.add(part);
  }
  if (crc.value() == header.crc) {
    return BankState::kValid;
  }
  const bool cut = header.sequence == 1 && was_cut(all.subspan(16, 4), crc.value());
  return cut ? BankState::kUnsealed : BankState::kBroken;
}

struct Newest {
  int bank = -1;  ///< -1: none holds a whole set
  Header header;
  BankState beside = BankState::kEmpty;  ///< of a bank that is not valid: the worse one of two
  Header beside_header;                  ///< of that bank
};

/// Looks for the newest whole set. Sequence numbers are compared with wrap.
auto newest(Banks& banks) -> Newest {
  Newest found;
  for (int bank = 0; bank < Banks::kBanks; ++bank) {
    Header candidate;
    const BankState state = inspect(banks, bank, candidate);
    if (state != BankState::kValid && state >= found.beside) {
      found.beside = state;
      found.beside_header = candidate;
    }
    if (state == BankState::kValid &&
        (found.bank < 0 || static_cast<std::int32_t>(candidate.sequence - found.header.sequence) > 0)) {
      found.bank = bank;
      found.header = candidate;
    }
  }
  return found;
}

auto restore_key(KeyDigest& key, std::uint32_t hash, std::uint32_t value) -> bool {
  for (std::size_t i = 0; i < key.words.size(); ++i) {
    if (hash_of_key(i) == hash) {
      key.words[i] = value;
      return true;
    }
  }
  return false;
}

/// Puts entries back where their names say, and keeps count of what does not agree.
class Restorer {
 public:
  Restorer(std::span<AxisConfig> axes, LoadReport& report) : axes_(axes), report_(report) {}

  /// False: today's table has no such name.
  auto take(std::uint32_t hash, std::int32_t raw) -> bool {
    const std::size_t count = parameters().size();
    const std::size_t all = axes_.size() * count;
    for (std::size_t tried = 0; tried < all; ++tried) {
      const std::size_t i = (likely_ + tried) % all;
      const ParameterInfo& parameter = parameters()[i % count];
      if (hash_of(i / count, parameter) != hash) {
        continue;
      }
      likely_ = i + 1;
      seen_[i / 32] |= 1U << (i % 32);
      if (raw >= parameter.minimum && raw <= parameter.maximum) {
        // What 'set' refuses now was stored once.
        raw = parameter.type == ParameterType::kWhole ? nearest_whole(Q24::from_raw(raw)).raw() : raw;
        set_raw_value(axes_[i / count], parameter, raw);
      } else {
        refuse(parameter);
      }
      return true;
    }
    return false;
  }
  /// After the last entry.
  void finish() {
    for (std::size_t i = 0; i < axes_.size() * parameters().size(); ++i) {
      if ((seen_[i / 32] >> (i % 32) & 1U) == 0) {
        ++report_.absent;
        note(parameters()[i % parameters().size()]);
      }
    }
    for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
      while (const ParameterInfo* joint = impossible_joint(axes_[axis], axis, axes_.size())) {
        set_raw_value(axes_[axis], *joint, raw_value(kDefaultAxis, *joint));
        refuse(*joint);
      }
    }
  }

 private:
  static constexpr std::size_t kMostAxes = 4;
  void refuse(const ParameterInfo& parameter) {
    ++report_.out_of_range;
    note(parameter);
  }
  void note(const ParameterInfo& parameter) {
    report_.first_default = report_.first_default == nullptr ? &parameter : report_.first_default;
  }
  std::span<AxisConfig> axes_;
  LoadReport& report_;
  std::size_t likely_ =
      0;  // the one that comes next if the set is of this version, so that only others are searched for
  std::array<std::uint32_t, kMostAxes * kMostParameters / 32> seen_{};
};

}  // namespace

auto ParameterStorage::save(std::span<const AxisConfig> axes, const KeyDigest& key) -> bool {
  const Newest old = newest(banks_);
  const int bank = old.bank == 0 ? 1 : 0;
  Header header;
  header.sequence = old.header.sequence + 1;
  const std::size_t entries = axes.size() * parameters().size() + (key.is_set() ? key.words.size() : 0);
  header.length = static_cast<std::uint32_t>(entries * kEntryBytes);
  if (header.length > kLongestPayload || !banks_.erase(bank)) {
    return false;
  }
  Crc32 crc;
  const auto unsealed = header_bytes(header);
  crc.add(std::span(unsealed).first(16));
  std::size_t at = kHeaderBytes;
  const bool written = for_each_entry(axes, key, [&](std::span<const std::uint8_t> entry) {
    crc.add(entry);
    const bool ok = banks_.write(bank, at, entry);
    at += entry.size();
    return ok;
  });
  header.crc = crc.value();
  Header check;
  return written && banks_.write(bank, 0, header_bytes(header)) && inspect(banks_, bank, check) == BankState::kValid;
}

auto ParameterStorage::load(std::span<AxisConfig> axes, KeyDigest* key) -> LoadReport {
  const Newest found = newest(banks_);
  if (found.bank < 0) {
    return {.result = found.beside == BankState::kUnreadable ? LoadResult::kUnreadable
                      : found.beside == BankState::kBroken   ? LoadResult::kCorrupt
                      : found.beside == BankState::kUnsealed ? LoadResult::kUnfinished
                                                             : LoadResult::kEmpty};
  }
  const Header& header = found.header;
  // Banks take turns, so the broken one is the older one only if it says so.
  const bool older = found.beside != BankState::kEmpty && found.beside_header.sequence + 1 != header.sequence;
  LoadReport report{.result = LoadResult::kForeign, .older = older, .format = header.format};
  if (header.format != kFormatVersion || header.length % kEntryBytes != 0) {
    return report;
  }
  report.result = LoadResult::kCorrupt;  // until all of it turns out to be sound
  KeyDigest stored_key;
  Restorer restorer(axes, report);
  std::array<std::uint8_t, kEntryBytes> entry{};
  for (std::uint32_t at = 0; at < header.length; at += kEntryBytes) {
    if (!banks_.read(found.bank, kHeaderBytes + at, entry)) {
      return report;
    }
    const std::span<const std::uint8_t> all(entry);
    const std::uint32_t hash = take(all.first(4));
    const std::uint32_t value = take(all.last(4));
    const bool known = restorer.take(hash, static_cast<std::int32_t>(value)) || restore_key(stored_key, hash, value);
    report.unknown = static_cast<std::uint16_t>(report.unknown + (known ? 0 : 1));
  }
  restorer.finish();
  for (const AxisConfig& axis : axes) {
    if (check(axis) != nullptr) {
      return report;  // values of several versions that do not go together
    }
  }
  if (key != nullptr) {
    *key = stored_key;
  }
  report.result = LoadResult::kLoaded;
  return report;
}

}  // namespace capstan
