// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/flash/image_file.hpp"

#include <elf.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <map>
#include <optional>
#include <span>
#include <sstream>
#include <string_view>

#include "capstan/boards/stm32f405/image.hpp"
#include "capstan/firmware/parameters/crc32.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using namespace stm32f405;

/// What a file puts where: flash as it would be afterwards, and where it would be written at all.
class Flash {
 public:
  explicit Flash(std::string path) : path_(std::move(path)) {}

  void put(std::uint64_t address, std::string_view bytes) {
    if (address < kSector0Begin || address + bytes.size() > kFlashEnd) {
      throw Refusal(path_ + ": it has bytes outside the board's flash; choose an image built for this board");
    }
    for (const char byte : bytes) {
      bytes_[static_cast<std::uint32_t>(address++)] = static_cast<std::uint8_t>(byte);
    }
  }
  /// Bytes from `begin` to `end`; what the file leaves open is as erased.
  [[nodiscard]] auto piece(std::uint32_t begin, std::uint32_t end) const -> std::vector<std::uint8_t> {
    std::vector<std::uint8_t> result(end - begin, 0xFF);
    for (auto it = bytes_.lower_bound(begin); it != bytes_.end() && it->first < end; ++it) {
      result[it->first - begin] = it->second;
    }
    return result;
  }
  [[nodiscard]] auto path() const -> const std::string& { return path_; }
  [[nodiscard]] auto end() const -> std::uint32_t { return bytes_.empty() ? 0 : bytes_.rbegin()->first + 1; }

 private:
  std::string path_;
  std::map<std::uint32_t, std::uint8_t> bytes_;
};

void read_elf(std::string_view file, Flash& flash) {
  Elf32_Ehdr head{};
  const auto damaged = [&flash] { return BadInput(flash.path() + ": the ELF file is damaged; rebuild it"); };
  if (file.size() < sizeof head) {
    throw damaged();
  }
  std::memcpy(&head, file.data(), sizeof head);
  if (head.e_ident[EI_CLASS] != ELFCLASS32 || head.e_ident[EI_DATA] != ELFDATA2LSB || head.e_machine != EM_ARM) {
    throw Refusal(flash.path() + ": it is a program for another processor; choose an image built for this board");
  }
  for (std::uint64_t i = 0; i < head.e_phnum; ++i) {
    Elf32_Phdr part{};
    const std::uint64_t at = head.e_phoff + i * sizeof part;
    if (head.e_phentsize != sizeof part || at + sizeof part > file.size()) {
      throw damaged();
    }
    std::memcpy(&part, file.data() + at, sizeof part);
    if (std::uint64_t{part.p_offset} + part.p_filesz > file.size()) {
      throw damaged();
    }
    if (part.p_type == PT_LOAD && part.p_filesz > 0) {
      flash.put(part.p_paddr, file.substr(part.p_offset, part.p_filesz));
    }
  }
}

auto hex_bytes(std::string_view digits) -> std::optional<std::string> {
  const auto value = [](char c) {
    return std::string_view("0123456789ABCDEF").find(static_cast<char>(std::toupper(c)));
  };
  std::string bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    const std::size_t high = value(digits[i]);
    const std::size_t low = value(digits[i + 1]);
    if (high > 15 || low > 15) {
      return {};
    }
    bytes.push_back(static_cast<char>(high * 16 + low));
  }
  return digits.size() % 2 == 0 ? std::optional(bytes) : std::nullopt;
}

/// Records of Intel HEX: length, address, kind, data, checksum; kinds 0 data, 1 end, 2 and 4 upper address.
void read_hex(std::string_view file, Flash& flash) {
  std::istringstream lines{std::string(file)};
  std::string line;
  std::uint64_t base = 0;
  std::size_t number = 0;
  const auto byte = [](const std::string& text, std::size_t i) { return static_cast<std::uint8_t>(text.at(i)); };
  while (std::getline(lines, line)) {
    ++number;
    const auto record = hex_bytes(trimmed(line).substr(std::min<std::size_t>(1, trimmed(line).size())));
    std::uint8_t sum = 0;
    for (const char c : record.value_or("")) {
      sum = static_cast<std::uint8_t>(sum + static_cast<std::uint8_t>(c));
    }
    if (!line.starts_with(':') || !record || record->size() < 5 || record->size() != byte(*record, 0) + 5U ||
        sum != 0) {
      throw BadInput(place(flash.path(), number) + "the HEX record is damaged; copy the file again or rebuild it");
    }
    const std::string_view data = std::string_view(*record).substr(4, byte(*record, 0));
    const std::uint32_t address = byte(*record, 1) * 256U + byte(*record, 2);
    const std::uint8_t kind = byte(*record, 3);
    if (kind == 0) {
      flash.put(base + address, data);
    } else if (kind == 1) {
      return;
    } else if ((kind == 2 || kind == 4) && data.size() == 2) {
      base = std::uint64_t{byte(*record, 4) * 256U + byte(*record, 5)} << (kind == 4 ? 16 : 4);
    }
  }
  throw BadInput(flash.path() + ": the HEX file has no end, so a part of it is missing; copy it again");
}

auto word_at(std::span<const std::uint8_t> bytes, std::size_t at) -> std::uint32_t {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.subspan(at).data(), sizeof value);
  return value;
}

auto text_at(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t size) -> std::string {
  const auto field = bytes.subspan(at, size);
  return {field.begin(), std::find(field.begin(), field.end(), std::uint8_t{0})};
}

/// The CRC-32 that an image's seal has to be (boards/stm32f405/image.hpp).
auto crc_of(const FlashImage& image) -> std::uint32_t {
  constexpr std::size_t kSealIndex = kSealAt - kSector0Begin;
  const std::span<const std::uint8_t> sector0 = image.sector0;
  Crc32 crc;
  crc.add(sector0.first(kSealIndex));
  crc.add(sector0.subspan(kSealIndex + kSealBytes));
  crc.add(image.code);
  return crc.value();
}

void check_seal(const std::string& path, const FlashImage& image) {
  if (image.seal == kNoSeal) {
    throw BadInput(path +
                   ": the image has no seal to check it by, as older ones have not; rebuild it with "
                   "'cmake --workflow --preset stm32f405'");
  }
  if (image.seal != crc_of(image)) {
    throw BadInput(path +
                   ": the image is damaged, its bytes do not agree with its seal; copy the file again or rebuild it");
  }
}

auto image_in(const Flash& flash) -> FlashImage {
  const std::vector<std::uint8_t> header = flash.piece(kImageHeaderAt, kImageHeaderAt + kImageHeaderBytes);
  if (!std::equal(kImageMagic.begin(), kImageMagic.end(), header.begin())) {
    throw Refusal(flash.path() +
                  ": it is no image of Capstan for this board; build one with "
                  "'cmake --workflow --preset stm32f405'");
  }
  const std::uint32_t sector0_end = word_at(header, kSector0EndAt);
  const std::uint32_t code_end = word_at(header, kCodeEndAt);
  if (sector0_end < kImageHeaderAt + kImageHeaderBytes || sector0_end > kSector0Begin + kSector0Bytes ||
      code_end <= kCodeBegin || code_end > kFlashEnd || flash.end() != code_end) {
    throw BadInput(flash.path() + ": the image is not as long as its header says; copy the file again or rebuild it");
  }
  const auto banks = flash.piece(kSector0Begin + kSector0Bytes, kCodeBegin);
  if (std::any_of(banks.begin(), banks.end(), [](std::uint8_t byte) { return byte != 0xFF; })) {
    throw Refusal(flash.path() + ": it would write over the parameter banks, which no image may; rebuild it");
  }
  FlashImage image{.board = text_at(header, kBoardAt, kVersionAt - kBoardAt),
                   .version = text_at(header, kVersionAt, kSector0EndAt - kVersionAt),
                   .seal = word_at(flash.piece(kSealAt, kSealAt + kSealBytes), 0),
                   .sector0 = flash.piece(kSector0Begin, sector0_end),
                   .code = flash.piece(kCodeBegin, code_end)};
  check_seal(flash.path(), image);
  return image;
}

}  // namespace

auto read_flash_image(const std::string& path) -> FlashImage {
  const std::string file = read_text_file(path);
  Flash flash(path);
  if (file.starts_with(ELFMAG)) {
    read_elf(file, flash);
  } else if (file.starts_with(':')) {
    read_hex(file, flash);
  } else {
    flash.put(kSector0Begin, file);
  }
  return image_in(flash);
}

}  // namespace capstan::tools
