// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>

#include "capstan/firmware/parameters/storage.hpp"

namespace capstan {

/// Two banks of 16 KB that are gone with the page, with the manners of flash: erasing sets every bit, writing can only
/// clear bits.
class MemoryBanks final : public Banks {
 public:
  static constexpr std::size_t kBankBytes = std::size_t{16} * 1024;
  MemoryBanks() {
    cells_[0].fill(0xFF);
    cells_[1].fill(0xFF);
  }

 private:
  static auto inside(int bank, std::size_t offset, std::size_t size) -> bool {
    return bank >= 0 && bank < kBanks && offset <= kBankBytes && size <= kBankBytes - offset;
  }
  auto cells(int bank, std::size_t offset, std::size_t size) -> std::span<std::uint8_t> {
    return std::span(cells_[static_cast<std::size_t>(bank)]).subspan(offset, size);
  }
  auto do_erase(int bank) -> bool override {
    if (!inside(bank, 0, kBankBytes)) {
      return false;
    }
    cells_[static_cast<std::size_t>(bank)].fill(0xFF);
    return true;
  }
  auto do_write(int bank, std::size_t offset, std::span<const std::uint8_t> bytes) -> bool override {
    if (!inside(bank, offset, bytes.size())) {
      return false;
    }
    const auto target = cells(bank, offset, bytes.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      target[i] = static_cast<std::uint8_t>(target[i] & bytes[i]);
    }
    return true;
  }
  auto do_read(int bank, std::size_t offset, std::span<std::uint8_t> bytes) -> bool override {
    if (!inside(bank, offset, bytes.size())) {
      return false;
    }
    const auto source = cells(bank, offset, bytes.size());
    std::copy(source.begin(), source.end(), bytes.begin());
    return true;
  }

  std::array<std::array<std::uint8_t, kBankBytes>, kBanks> cells_;
};

}  // namespace capstan
