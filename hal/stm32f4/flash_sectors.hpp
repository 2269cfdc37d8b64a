// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "capstan/hal/stm32f4/registers.hpp"

namespace capstan::stm32f4 {

/// Erases and programs sectors of the chip's own flash (RM0090 section 3.6). While it works the core cannot fetch code
/// and stands still, a sector erase up to 0.8 s: outputs off and watchdog lengthened first, and never from the cycle.
template <RegisterCell Cell>
class FlashSectors {
 public:
  explicit FlashSectors(FlashRegisters<Cell>& registers) noexcept : registers_(registers) {}

  /// Erases sector 0 to 11. False: the flash stayed busy or reported an error.
  [[nodiscard]] auto erase(std::uint32_t sector) noexcept -> bool {
    if (!begin()) {
      return false;
    }
    registers_.cr.write(flash::kCrSectorErase | flash::kCrWordSize | (sector << flash::kCrSectorShift));
    set_bits(registers_.cr, flash::kCrStart);
    const bool done = finish();
    drop_cached_data();
    return done;
  }

  /// Programs erased words from `first` on. False: nothing, or only a part, was programmed.
  [[nodiscard]] auto program(std::span<Cell> memory, std::size_t first, std::span<const std::uint32_t> words) noexcept
      -> bool {
    if (first > memory.size() || words.size() > memory.size() - first || !begin()) {
      return false;
    }
    bool done = true;
    for (std::size_t i = 0; done && i < words.size(); ++i) {
      registers_.cr.write(flash::kCrProgram | flash::kCrWordSize);
      memory[first + i].write(words[i]);
      done = wait_idle() && memory[first + i].read() == words[i];
    }
    return finish() && done;
  }

 private:
  /// Unlocks, and clears what an earlier attempt left: a stale error flag would fail every later write.
  [[nodiscard]] auto begin() noexcept -> bool {
    if (!wait_idle()) {
      return false;
    }
    if ((registers_.cr.read() & flash::kCrLock) != 0) {
      registers_.keyr.write(flash::kKey1);
      registers_.keyr.write(flash::kKey2);
    }
    registers_.sr.write(flash::kSrErrors);
    return (registers_.cr.read() & flash::kCrLock) == 0;
  }

  [[nodiscard]] auto wait_idle() noexcept -> bool { return wait_for(registers_.sr, flash::kSrBusy, 0, kPolls); }

  [[nodiscard]] auto finish() noexcept -> bool {
    const bool idle = wait_idle();
    const bool clean = (registers_.sr.read() & flash::kSrErrors) == 0;
    registers_.cr.write(flash::kCrLock);
    return idle && clean;
  }

  /// The data cache knows nothing of the erase; it may only be reset while it is off.
  void drop_cached_data() noexcept {
    clear_bits(registers_.acr, flash::kAcrDataCache);
    set_bits(registers_.acr, flash::kAcrDataCacheReset);
    clear_bits(registers_.acr, flash::kAcrDataCacheReset);
    set_bits(registers_.acr, flash::kAcrDataCache);
  }

  /// At least 1 s at 168 MHz with 8 cycles a poll; longer when the core stands still meanwhile.
  static constexpr std::uint32_t kPolls = 21'000'000;
  FlashRegisters<Cell>& registers_;
};

}  // namespace capstan::stm32f4
