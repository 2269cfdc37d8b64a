// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

#include "capstan/model/fixed.hpp"

namespace capstan::tools {

/// A number as it is typed at a board's prompt. First rounded to what the board has, which eight decimals tell from its
/// neighbours: rounded twice, it may become another one than replay runs. What no board holds stays, to be refused.
inline auto board_number(double value) -> std::string {
  constexpr double kMost = 128.0;
  char text[40];
  std::snprintf(text, sizeof(text), "%.8f", std::abs(value) < kMost ? Q24::from_double(value).to_double() : value);
  return text;
}

}  // namespace capstan::tools
