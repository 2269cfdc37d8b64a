// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace capstan::tools::mcap {

/// The container of mcap.dev/spec: a file is magic, records, magic; a record is an opcode, a length of eight bytes and
/// its fields, little endian.
inline constexpr std::string_view kMagic = "\x89MCAP0\r\n";

enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

inline constexpr std::size_t kRecordHeadBytes = 9;

/// Puts fields one after the other.
class FieldWriter {
 public:
  auto u8(std::uint8_t value) -> FieldWriter& { return number(value, 1); }
  auto u16(std::uint16_t value) -> FieldWriter& { return number(value, 2); }
  auto u32(std::uint32_t value) -> FieldWriter& { return number(value, 4); }
  auto u64(std::uint64_t value) -> FieldWriter& { return number(value, 8); }
  auto bytes(std::string_view value) -> FieldWriter& {
    fields_ += value;
    return *this;
  }
  /// Length of four bytes in front, as strings, arrays and maps have.
  auto text(std::string_view value) -> FieldWriter& {
    return u32(static_cast<std::uint32_t>(value.size())).bytes(value);
  }
  [[nodiscard]] auto fields() const -> const std::string& { return fields_; }

 private:
  auto number(std::uint64_t value, int bytes) -> FieldWriter& {
    for (int i = 0; i < bytes; ++i) {
      fields_ += static_cast<char>(static_cast<unsigned char>(value >> (8U * static_cast<unsigned>(i))));
    }
    return *this;
  }
  std::string fields_;
};

/// Takes fields one after the other. What is beyond the end is nothing, and so is everything after that.
class FieldReader {
 public:
  explicit FieldReader(std::string_view fields) : left_(fields) {}

  auto u8() -> std::optional<std::uint8_t> { return number<std::uint8_t>(); }
  auto u16() -> std::optional<std::uint16_t> { return number<std::uint16_t>(); }
  auto u32() -> std::optional<std::uint32_t> { return number<std::uint32_t>(); }
  auto u64() -> std::optional<std::uint64_t> { return number<std::uint64_t>(); }
  auto bytes(std::uint64_t count) -> std::optional<std::string_view> {
    if (count > left_.size()) {
      left_ = {};
      return std::nullopt;
    }
    const auto taken = left_.substr(0, static_cast<std::size_t>(count));
    left_.remove_prefix(taken.size());
    return taken;
  }
  auto text() -> std::optional<std::string_view> {
    const auto size = u32();
    return size ? bytes(*size) : std::nullopt;
  }
  [[nodiscard]] auto left() const -> std::string_view { return left_; }

 private:
  template <typename Number>
  auto number() -> std::optional<Number> {
    const auto taken = bytes(sizeof(Number));
    if (!taken) {
      return std::nullopt;
    }
    std::uint64_t value = 0;
    for (std::size_t i = sizeof(Number); i-- > 0;) {
      value = value << 8U | static_cast<unsigned char>((*taken)[i]);
    }
    return static_cast<Number>(value);
  }
  std::string_view left_;
};

/// CRC-32 as zlib's, continued from `before`.
auto crc32(std::string_view bytes, std::uint32_t before = 0) -> std::uint32_t;

/// The record with its head in front.
auto record(Opcode opcode, const FieldWriter& fields) -> std::string;

}  // namespace capstan::tools::mcap
