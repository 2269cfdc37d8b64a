// SPDX-License-Identifier: Apache-2.0
// Small images for the motor board, made here by the layout in boards/stm32f405/image.hpp and by nothing of the tools.
#pragma once

#include <elf.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>

namespace capstan::tools {

inline constexpr std::size_t kSector0Size = 0x300;
inline constexpr std::size_t kSealAt = 0x1FC;
inline constexpr std::size_t kCodeAt = 0xC000;
inline constexpr std::size_t kCodeSize = 1000;

inline void put_word(std::string& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[at + i] = static_cast<char>(value >> (8 * i));
  }
}

/// As BIN without the gap: the two pieces after each other.
inline auto pieces(const std::string& bin) -> std::string {
  return bin.substr(0, kSector0Size) + bin.substr(kCodeAt);
}

/// CRC-32 by the definition: remainder of the whole message, bit by bit from the highest.
inline auto crc_of(const std::string& bytes) -> std::uint32_t {
  std::uint32_t crc = 0xFFFFFFFF;
  for (const char c : bytes) {
    for (int bit = 0; bit < 8; ++bit) {
      const std::uint32_t in = (static_cast<unsigned char>(c) >> bit) & 1U;
      const std::uint32_t out = (crc >> 31U) ^ in;
      crc = (crc << 1U) ^ (out != 0 ? 0x04C11DB7U : 0U);
    }
  }
  std::uint32_t mirrored = 0;
  for (int bit = 0; bit < 32; ++bit) {
    mirrored |= ((crc >> bit) & 1U) << (31 - bit);
  }
  return ~mirrored;
}

/// What the seal of a BIN has to be: over both pieces, without its own four bytes.
inline auto seal_of(const std::string& bin) -> std::uint32_t {
  return crc_of(pieces(bin).erase(kSealAt, 4));
}

inline auto seal_text(std::uint32_t seal) -> std::string {
  std::array<char, 9> text{};
  std::snprintf(text.data(), text.size(), "%08x", seal);
  return text.data();
}

/// An image as BIN, by the layout in boards/stm32f405/image.hpp.
inline auto bin_image(const std::string& board) -> std::string {
  std::string bytes(kCodeAt + kCodeSize, '\xFF');
  for (std::size_t i = 0; i < kSector0Size; ++i) {
    bytes[i] = static_cast<char>(i * 7);
  }
  for (std::size_t i = 0; i < kCodeSize; ++i) {
    bytes[kCodeAt + i] = static_cast<char>(i * 13 + 1);
  }
  std::string header(56, '\0');
  header.replace(0, 8, "CAPSTAN1");
  header.replace(8, board.size(), board);
  header.replace(32, 5, "1.2.3");
  put_word(header, 48, 0x0800'0000 + kSector0Size);
  put_word(header, 52, 0x0800'0000 + kCodeAt + kCodeSize);
  bytes.replace(0x200, header.size(), header);
  put_word(bytes, kSealAt, seal_of(bytes));
  return bytes;
}

inline auto hex_record(std::uint32_t address, int kind, const std::string& data) -> std::string {
  std::string bytes = {static_cast<char>(data.size()), static_cast<char>(address >> 8U), static_cast<char>(address),
                       static_cast<char>(kind)};
  bytes += data;
  std::uint8_t sum = 0;
  std::string text = ":";
  const auto add = [&text](std::uint8_t byte) {
    text += "0123456789ABCDEF"[byte >> 4U];
    text += "0123456789ABCDEF"[byte & 15U];
  };
  for (const char byte : bytes) {
    sum = static_cast<std::uint8_t>(sum + static_cast<std::uint8_t>(byte));
    add(static_cast<std::uint8_t>(byte));
  }
  add(static_cast<std::uint8_t>(-sum));
  return text + "\r\n";
}

inline auto hex_image(const std::string& bin) -> std::string {
  std::string text = hex_record(0, 4, {"\x08\x00", 2});
  for (std::size_t at = 0; at < bin.size(); at += 16) {
    if (at < kSector0Size || at >= kCodeAt) {
      text += hex_record(static_cast<std::uint32_t>(at), 0, bin.substr(at, 16));
    }
  }
  return text + hex_record(0, 5, {"\x08\x00\x00\x01", 4}) + hex_record(0, 1, "");
}

inline auto elf_image(const std::string& bin) -> std::string {
  Elf32_Ehdr head{};
  std::memcpy(head.e_ident, ELFMAG, SELFMAG);
  head.e_ident[EI_CLASS] = ELFCLASS32;
  head.e_ident[EI_DATA] = ELFDATA2LSB;
  head.e_machine = EM_ARM;
  head.e_phoff = sizeof head;
  head.e_phentsize = sizeof(Elf32_Phdr);
  head.e_phnum = 2;
  std::array<Elf32_Phdr, 2> parts{};
  const std::size_t data_at = sizeof head + sizeof parts;
  parts[0].p_type = parts[1].p_type = PT_LOAD;
  parts[0].p_offset = static_cast<Elf32_Off>(data_at);
  parts[0].p_vaddr = parts[0].p_paddr = 0x0800'0000;
  parts[0].p_filesz = kSector0Size;
  parts[1].p_offset = static_cast<Elf32_Off>(data_at + kSector0Size);
  parts[1].p_vaddr = 0x2000'0000;  // where it runs is not where it lies
  parts[1].p_paddr = 0x0800'0000 + kCodeAt;
  parts[1].p_filesz = kCodeSize;
  return std::string(reinterpret_cast<const char*>(&head), sizeof head) +
         std::string(reinterpret_cast<const char*>(parts.data()), sizeof parts) + pieces(bin);
}

}  // namespace capstan::tools
