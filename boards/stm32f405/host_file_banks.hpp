// SPDX-License-Identifier: Apache-2.0
// Parameter banks of the emulated board that outlive the emulator, as flash outlives a power cut.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <string_view>

#include "capstan/boards/stm32f405/banks.hpp"
#include "capstan/firmware/console/text.hpp"
#include "capstan/hal/stm32f4/semihosting.hpp"

namespace capstan::stm32f405 {

/// The banks in RAM and, if the image's command line has the word banks=FILE, a copy of them in that file of the host:
/// read when the board starts, and changed byte by byte as flash would be. The word cut=N ends the emulator, as a power
/// cut would, when N bytes have been erased or programmed. Without banks=FILE what is saved lasts until the emulator
/// ends.
class HostFileBanks final : public Banks {
 public:
  HostFileBanks() noexcept { read_words(); }

 private:
  using File = stm32f4::semihosting::File;
  static constexpr std::uint32_t kPowerCut = 99;  ///< status of the emulator
  static constexpr std::size_t kChunk = 64;

  /// Not inlined: the command line stays on the stack no longer than this takes.
  [[gnu::noinline]] void read_words() noexcept {
    std::array<char, 384> text{};
    std::string_view words(text.data(), stm32f4::semihosting::command_line(text));
    static_cast<void>(next_word(words));  // the image itself
    for (std::string_view word = next_word(words); !word.empty(); word = next_word(words)) {
      constexpr std::string_view kFile = "banks=";
      constexpr std::string_view kCut = "cut=";
      if (word.starts_with(kFile)) {
        word.remove_prefix(kFile.size());
        attach(word);
      } else if (word.starts_with(kCut)) {
        word.remove_prefix(kCut.size());
        static_cast<void>(std::from_chars(word.data(), word.data() + word.size(), left_));
      }
    }
  }

  void attach(std::string_view path) noexcept {
    if (!File(path, File::Mode::kRead).is_open()) {
      File fresh(path, File::Mode::kWrite);
      std::array<std::uint8_t, kChunk> erased{};
      erased.fill(0xFF);
      for (std::size_t at = 0; at < Banks::kBanks * RamBanks::kSize; at += erased.size()) {
        static_cast<void>(fresh.write(erased));
      }
    }
    file_ = new (&storage_) File(path, File::Mode::kUpdate);
    std::array<std::uint8_t, kChunk> bytes{};
    for (std::size_t at = 0; at < Banks::kBanks * RamBanks::kSize; at += bytes.size()) {
      if (file_->read(bytes) == bytes.size()) {
        static_cast<void>(ram_.write(static_cast<int>(at / RamBanks::kSize), at % RamBanks::kSize, bytes));
      }
    }
  }

  auto do_erase(int bank) -> bool override { return ram_.erase(bank) && store(bank, 0, RamBanks::kSize); }
  auto do_write(int bank, std::size_t offset, std::span<const std::uint8_t> bytes) -> bool override {
    return ram_.write(bank, offset, bytes) && store(bank, offset, bytes.size());
  }
  auto do_read(int bank, std::size_t offset, std::span<std::uint8_t> bytes) -> bool override {
    return ram_.read(bank, offset, bytes);
  }

  /// Copies what is in RAM to the file.
  auto store(int bank, std::size_t offset, std::size_t size) -> bool {
    std::array<std::uint8_t, kChunk> bytes{};
    bool done = file_ == nullptr || file_->seek(static_cast<std::size_t>(bank) * RamBanks::kSize + offset);
    for (std::size_t at = 0; file_ != nullptr && done && at < size; at += kChunk) {
      const std::span chunk = std::span(bytes).first(std::min({kChunk, size - at, std::size_t{left_}}));
      done = ram_.read(bank, offset + at, chunk) && file_->write(chunk);
      if (chunk.size() < std::min(kChunk, size - at)) {
        stm32f4::semihosting::exit(kPowerCut);
      }
      left_ -= left_ == kNever ? 0 : static_cast<std::uint32_t>(chunk.size());
    }
    return done;
  }

  static constexpr std::uint32_t kNever = UINT32_MAX;
  RamBanks ram_;
  std::uint32_t left_ = kNever;  ///< bytes until the power is cut
  File* file_ = nullptr;
  alignas(File) std::array<std::byte, sizeof(File)> storage_{};  // never destroyed: the board does not end
};

}  // namespace capstan::stm32f405
