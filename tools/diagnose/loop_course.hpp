// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/preparation.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"

namespace capstan::tools {

/// How the loop changed from the first fifth of the logs over the middle one to the last.
struct Course {
  double width = 1.0;  ///< last over first
  double torque = 1.0;
  bool early = false;  ///< most of the change of width came before the middle

  [[nodiscard]] auto narrows() const -> bool { return width < 1.0 - kLoopTold && torque < 1.0 - kLoopTold; }
  [[nodiscard]] auto widens() const -> bool { return width > 1.0 + kLoopTold && torque > 1.0 + kLoopTold; }
};

/// @param loop  a law with a loop, whose width is fitted to each part
auto course_of(const Preparation& p, const LawForm& loop) -> Course;

}  // namespace capstan::tools
