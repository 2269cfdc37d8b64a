// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace capstan::stm32f405 {

/// Where an image lies in flash (stm32f405.ld): vectors and fault handlers in sector 0, then the parameter banks, which
/// belong to no image, then the code.
inline constexpr std::uint32_t kSector0Begin = 0x0800'0000;
inline constexpr std::uint32_t kSector0Bytes = 0x4000;
inline constexpr std::uint32_t kCodeBegin = 0x0800'C000;
inline constexpr std::uint32_t kFlashEnd = 0x0810'0000;
/// Where the seal stands: the CRC-32 of the image's bytes from kSector0Begin to sector0_end without the seal's own
/// four, then from kCodeBegin to code_end. Written after the link (seal_image), compared by `capstan flash` before it
/// writes and by the board at every start; `version` prints it as the image's hash. 0: the image was never sealed.
inline constexpr std::uint32_t kSealAt = 0x0800'01FC;
inline constexpr std::uint32_t kSealBytes = 4;
inline constexpr std::uint32_t kNoSeal = 0;
/// Where the header stands that says which board an image is for.
inline constexpr std::uint32_t kImageHeaderAt = 0x0800'0200;
static_assert(kSealAt + kSealBytes == kImageHeaderAt);
inline constexpr std::string_view kImageMagic = "CAPSTAN1";
/// What a board says over and over whose flash does not agree with its seal; it does nothing else.
inline constexpr std::string_view kDamagedImage =
    "# the image in flash is damaged, so nothing of it runs; flash it again with 'capstan flash stm32f405'";

/// What an image says of itself.
struct ImageHeader {
  std::array<char, 8> magic;
  std::array<char, 24> board;    ///< ends in zeros
  std::array<char, 16> version;  ///< ends in zeros
  const std::uint32_t* sector0_end;
  const std::uint32_t* code_end;
};
// The layout as `capstan flash` reads it from a file, where addresses have 32 bits.
inline constexpr std::size_t kBoardAt = 8;
inline constexpr std::size_t kVersionAt = 32;
inline constexpr std::size_t kSector0EndAt = 48;
inline constexpr std::size_t kCodeEndAt = 52;
inline constexpr std::size_t kImageHeaderBytes = 56;
static_assert(offsetof(ImageHeader, board) == kBoardAt && offsetof(ImageHeader, version) == kVersionAt &&
              offsetof(ImageHeader, sector0_end) == kSector0EndAt);

/// `text` in an array, with zeros behind; does not compile if it does not fit with one of them.
template <std::size_t Size>
consteval auto padded(std::string_view text) -> std::array<char, Size> {
  std::array<char, Size> result{};
  for (std::size_t i = 0; i < text.size(); ++i) {
    result.at(i) = text[i];
  }
  return result;
}

}  // namespace capstan::stm32f405
