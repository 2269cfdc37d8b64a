// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// From the linker script, whole words: the pieces that the seal stands over, and the seal (image.hpp).
extern "C" {
// NOLINTBEGIN(readability-identifier-naming): the linker's names.
extern const std::uint32_t capstan_sector0_begin[];
extern const std::uint32_t capstan_seal[];
extern const std::uint32_t capstan_seal_end[];
extern const std::uint32_t capstan_sector0_end[];
extern const std::uint32_t capstan_code_begin[];
extern const std::uint32_t capstan_image_end[];
// NOLINTEND(readability-identifier-naming)

/// Returns if flash agrees with the seal. Otherwise it never does: outputs stay as the reset left them, off, and the
/// console says kDamagedImage once a second. First thing after reset: needs a stack and nothing else, no variables.
void capstan_check_image();
}
