// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace capstan::tools {

/// An image for the stm32f405 board in its two pieces. The parameter banks between them are in neither, so writing both
/// leaves the parameters alone, whatever the file was.
struct FlashImage {
  std::string board;
  std::string version;
  std::uint32_t seal = 0;             ///< CRC-32 that the board will answer to `version` (boards/stm32f405/image.hpp)
  std::vector<std::uint8_t> sector0;  ///< from 0x08000000
  std::vector<std::uint8_t> code;     ///< from 0x0800C000
};

/// Reads ELF, Intel HEX or BIN, told apart by their content. Throws BadInput for a file that is none of them or
/// damaged, by its seal too, and Refusal for one that is no image of Capstan or would write where no image may.
auto read_flash_image(const std::string& path) -> FlashImage;

}  // namespace capstan::tools
