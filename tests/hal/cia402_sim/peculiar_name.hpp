// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>

#include "capstan/hal/cia402_sim/peculiarity.hpp"

namespace capstan::test {

/// For the names of tests.
inline auto test_name(drive_sim::Peculiarity peculiarity) -> std::string {
  std::string text = drive_sim::name(peculiarity);
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
}

}  // namespace capstan::test
