// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

#include "capstan/model/fixed.hpp"

namespace capstan::tools {

/// A number as it is typed at a board's prompt, with eight decimals, which tell what a board has from its neighbours.
/// It is rounded here and there: where that would make another number of it than replay runs, the board's own is typed.
/// What no board holds stays, to be refused.
inline auto board_number(double value) -> std::string {
  constexpr double kMost = 128.0;
  const auto text_of = [](double number) {
    char text[40];
    std::snprintf(text, sizeof(text), "%.8f", number);
    return std::string(text);
  };
  const std::string text = text_of(value);
  if (std::abs(value) >= kMost) {
    return text;
  }
  const Q24 board = Q24::from_double(value);
  return Q24::from_double(std::stod(text)) == board ? text : text_of(board.to_double());
}

}  // namespace capstan::tools
