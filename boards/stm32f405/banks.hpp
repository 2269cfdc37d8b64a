// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "capstan/firmware/parameters/storage.hpp"
#include "capstan/hal/stm32f4/flash_sectors.hpp"
#include "capstan/hal/stm32f4/watchdog.hpp"

namespace capstan::stm32f405 {

inline constexpr std::size_t kBankBytes = std::size_t{16} * 1024;

/// The two parameter banks in the chip's flash, sectors 1 and 2. Writes go in whole words, so offset and length are
/// multiples of 4. An erase stops the core for up to 0.8 s: the caller sees to it that no torque is on, this sees to
/// the watchdog.
template <stm32f4::RegisterCell Cell>
class FlashBanks final : public Banks {
 public:
  using Memory = std::array<std::span<Cell>, Banks::kBanks>;

  FlashBanks(stm32f4::FlashRegisters<Cell>& registers, stm32f4::Watchdog<Cell>& watchdog, const Memory& memory) noexcept
      : sectors_(registers), watchdog_(watchdog), memory_(memory) {}

 private:
  static constexpr std::size_t kWord = sizeof(std::uint32_t);
  static constexpr std::uint32_t kFirstSector = 1;

  auto do_erase(int bank) -> bool override {
    const bool erased =
        watchdog_.change(stm32f4::kEraseWatchdog) && sectors_.erase(kFirstSector + static_cast<std::uint32_t>(bank));
    return watchdog_.change(stm32f4::kCycleWatchdog) && erased;  // also where the other was not taken over, or is late
  }

  auto do_write(int bank, std::size_t offset, std::span<const std::uint8_t> bytes) -> bool override {
    if (offset % kWord != 0 || bytes.size() % kWord != 0) {
      return false;
    }
    for (std::size_t at = 0; at < bytes.size(); at += kWord) {
      std::array<std::uint32_t, 1> word{};
      std::memcpy(word.data(), bytes.data() + at, kWord);
      if (!sectors_.program(memory_[static_cast<std::size_t>(bank)], (offset + at) / kWord, word)) {
        return false;
      }
    }
    return true;
  }

  auto do_read(int bank, std::size_t offset, std::span<std::uint8_t> bytes) -> bool override {
    const std::span<Cell>& memory = memory_[static_cast<std::size_t>(bank)];
    if (offset > memory.size() * kWord || bytes.size() > memory.size() * kWord - offset) {
      return false;
    }
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const std::uint32_t word = memory[(offset + i) / kWord].read();
      bytes[i] = static_cast<std::uint8_t>(word >> (8 * ((offset + i) % kWord)));
    }
    return true;
  }

  stm32f4::FlashSectors<Cell> sectors_;
  stm32f4::Watchdog<Cell>& watchdog_;
  Memory memory_;
};
static_assert(std::endian::native == std::endian::little, "bytes are packed into words the way the core reads them");

/// Two banks in RAM with the manners of flash, for the emulated board, whose flash controller is not modelled. What is
/// saved lasts until the emulator ends.
class RamBanks final : public Banks {
 public:
  /// Less than the flash banks, for RAM is short: enough for the sets of four axes, 2.6 KB each. A set that does not
  /// fit is refused when it is saved.
  static constexpr std::size_t kSize = std::size_t{12} * 1024;
  RamBanks() noexcept {
    for (auto& bank : memory_) {
      bank.fill(kErased);
    }
  }

 private:
  static constexpr std::uint8_t kErased = 0xFF;

  auto do_erase(int bank) -> bool override {
    memory_[static_cast<std::size_t>(bank)].fill(kErased);
    return true;
  }
  auto do_write(int bank, std::size_t offset, std::span<const std::uint8_t> bytes) -> bool override {
    if (offset > kSize || bytes.size() > kSize - offset) {
      return false;
    }
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      std::uint8_t& cell = memory_[static_cast<std::size_t>(bank)][offset + i];
      cell = static_cast<std::uint8_t>(cell & bytes[i]);  // programming only clears bits
    }
    return true;
  }
  auto do_read(int bank, std::size_t offset, std::span<std::uint8_t> bytes) -> bool override {
    if (offset > kSize || bytes.size() > kSize - offset) {
      return false;
    }
    std::copy_n(memory_[static_cast<std::size_t>(bank)].begin() + static_cast<std::ptrdiff_t>(offset), bytes.size(),
                bytes.begin());
    return true;
  }

  std::array<std::array<std::uint8_t, kSize>, Banks::kBanks> memory_;
};

}  // namespace capstan::stm32f405
