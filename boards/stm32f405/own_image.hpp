// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "capstan/boards/stm32f405/image.hpp"
#include "capstan/firmware/parameters/crc32.hpp"

// From the linker script.
extern "C" const std::uint8_t capstan_sector0_end[];
extern "C" const std::uint8_t capstan_image_end[];

namespace capstan::stm32f405 {

static_assert(sizeof(ImageHeader) == kImageHeaderBytes && offsetof(ImageHeader, code_end) == kCodeEndAt);

/// The header of an image for `board`; it belongs into the section ".image".
consteval auto own_header(std::string_view board) -> ImageHeader {
  return {.magic = {'C', 'A', 'P', 'S', 'T', 'A', 'N', '1'},
          .board = padded<24>(board),
          .version = padded<16>(CAPSTAN_VERSION),
          .sector0_end = capstan_sector0_end,
          .code_end = capstan_image_end};
}

/// Hash of what is in flash now. Takes some 20 ms: for the background.
inline auto own_hash() -> std::uint32_t {
  const auto begin_of = [](std::uint32_t address) {
    return reinterpret_cast<const std::uint8_t*>(address);  // NOLINT(performance-no-int-to-ptr): that is where flash is
  };
  Crc32 crc;
  crc.add(std::span(begin_of(kSector0Begin), capstan_sector0_end));
  crc.add(std::span(begin_of(kCodeBegin), capstan_image_end));
  return crc.value();
}

}  // namespace capstan::stm32f405
