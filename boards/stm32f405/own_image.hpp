// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/boards/stm32f405/image.hpp"
#include "capstan/boards/stm32f405/image_check.hpp"

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

/// The seal of the image that runs, with which its bytes in flash agreed at the start.
inline auto own_seal() -> std::uint32_t {
  return capstan_seal[0];
}

}  // namespace capstan::stm32f405
