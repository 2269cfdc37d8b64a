// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace capstan {

/// What is kept of the maintenance key: the first 128 bits of SHA-256 (FIPS 180-4) over "capstan maintenance " and the
/// key. The key itself is stored nowhere. All zero: no key was set.
struct KeyDigest {
  std::array<std::uint32_t, 4> words{};
  [[nodiscard]] constexpr auto is_set() const -> bool { return words != decltype(words){}; }
  friend constexpr auto operator==(const KeyDigest&, const KeyDigest&) -> bool = default;
};
auto digest_of(std::string_view key) -> KeyDigest;

/// SHA-256 of a text.
auto sha256(std::string_view text) -> std::array<std::uint32_t, 8>;

/// Whether safety limits may be written now. For the background only.
class Maintenance {
 public:
  static constexpr std::uint32_t kOpenMs = 10 * 60 * 1000;  ///< then it closes by itself
  static constexpr std::uint32_t kWaitMs = 3'000;           ///< after a wrong key, before the next is looked at
  static constexpr std::size_t kShortestKey = 6;
  enum class Attempt : std::uint8_t { kOpened, kWrong, kTooSoon };

  /// @param stored  the board's key; where none is set, any `key` opens, the empty one too   @param now_ms  wraps
  auto open(std::string_view key, const KeyDigest& stored, std::uint32_t now_ms) -> Attempt;
  void close() { open_ = false; }
  /// Call it at least every 20 days, for the time wraps.
  auto is_open(std::uint32_t now_ms) -> bool;

 private:
  bool open_ = false;
  bool waits_ = false;
  std::uint32_t since_ms_ = 0;
  std::uint32_t wrong_ms_ = 0;
};

}  // namespace capstan
