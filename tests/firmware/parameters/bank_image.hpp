// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tests/firmware/support.hpp"

namespace capstan::test {

/// The format of a stored set, written a second time, so that a change of it is noticed: sets must still load after an
/// update.
class BankImage {
 public:
  explicit BankImage(std::uint32_t sequence, std::uint32_t format = 1) : sequence_(sequence), format_(format) {}
  void add_byte(std::uint8_t byte) { payload_.push_back(byte); }
  void add_hash(std::uint32_t hash, std::int32_t raw) {
    put(payload_, hash);
    put(payload_, static_cast<std::uint32_t>(raw));
  }
  void add(std::uint8_t axis, const std::string& name, std::int32_t raw) {
    std::uint32_t hash = 2166136261U;
    for (const char c : std::string(1, static_cast<char>(axis)) + name) {
      hash = (hash ^ static_cast<std::uint8_t>(c)) * 16777619U;
    }
    add_hash(hash, raw);
  }
  void write(FlashBanks& banks, std::size_t bank) const {
    std::vector<std::uint8_t> bytes;
    for (const std::uint32_t word : {0x31545343U, format_, sequence_, static_cast<std::uint32_t>(payload_.size())}) {
      put(bytes, word);
    }
    std::vector<std::uint8_t> summed = bytes;
    summed.insert(summed.end(), payload_.begin(), payload_.end());
    put(bytes, crc32(summed));
    bytes.insert(bytes.end(), payload_.begin(), payload_.end());
    std::copy(bytes.begin(), bytes.end(), banks.memory[bank].begin());
  }
  static auto crc32(const std::vector<std::uint8_t>& bytes) -> std::uint32_t {
    std::uint32_t crc = 0xFFFFFFFFU;
    for (const std::uint8_t byte : bytes) {
      for (int bit = 0; bit < 8; ++bit) {
        const bool out = (((crc >> 0) ^ (static_cast<std::uint32_t>(byte) >> bit)) & 1U) != 0;
        crc = (crc >> 1) ^ (out ? 0xEDB88320U : 0U);
      }
    }
    return ~crc;
  }

 private:
  static void put(std::vector<std::uint8_t>& bytes, std::uint32_t word) {
    for (int i = 0; i < 4; ++i) {
      bytes.push_back(static_cast<std::uint8_t>(word >> (8 * i)));
    }
  }
  std::uint32_t sequence_;
  std::uint32_t format_;
  std::vector<std::uint8_t> payload_;
};

}  // namespace capstan::test
