// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdlib>

namespace capstan::tools {

/// A number of the surroundings, for longer tables of drawn joints: CAPSTAN_SEED=600 CAPSTAN_PLANTS=40.
inline auto number_from(const char* variable, long usual) -> std::uint64_t {
  const char* text = std::getenv(variable);
  return static_cast<std::uint64_t>(text == nullptr ? usual : std::atol(text));
}

}  // namespace capstan::tools
