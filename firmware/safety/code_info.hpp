// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace capstan {

/// What an operator reads about a numbered code: a row of the table of faults, of warnings or of tendon states.
template <typename Code>
struct CodeInfo {
  Code code;
  const char* name;
  const char* cause;
  const char* cure;
};

/// Whether a code's number is its row, as everything assumes that indexes the table by it.
template <typename Code, std::size_t Rows>
constexpr auto in_order(const std::array<CodeInfo<Code>, Rows>& table) -> bool {
  for (std::size_t i = 0; i < Rows; ++i) {
    if (static_cast<std::size_t>(table[i].code) != i) {
      return false;
    }
  }
  return true;
}

}  // namespace capstan
